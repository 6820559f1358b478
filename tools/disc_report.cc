// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/disc_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <stdexcept>

#include "model/disc_fit.h"
#include "model/parallel.h"
#include "tools/error.h"

namespace torso::tools {
namespace {

using Quantity = DiscTest::Quantity;

constexpr double kDeg = M_PI / 180;
constexpr int kCurvePoints = 10;
const char kStressReference[] = "L4/L5";

double areaOf(const Disc& disc) { return upperEndplateArea(makeDiscMesh(disc.shape)); }

std::vector<DiscTest> testsOf(const Anatomy& anatomy, Region region) {
  std::vector<DiscTest> tests;
  for (const DiscTest& test : anatomy.disc_tests) {
    if (test.region == region && !test.whole_segment) tests.push_back(test);
  }
  return tests;
}

// The pressure in the nucleus is measured in compression.
bool sameLoading(Quantity quantity, Quantity other) {
  const auto loading = [](Quantity q) {
    return q == Quantity::kPressure ? Quantity::kCompression : q;
  };
  return loading(quantity) == loading(other);
}

DiscLoading loadUp(const DiscBench& bench, const std::vector<DiscTest>& tests,
                   const DiscTest& fit) {
  double top = 0;
  for (const DiscTest& test : tests) {
    if (sameLoading(test.quantity, fit.quantity) && test.load <= 2 * fit.load) {
      top = std::max(top, test.load);
    }
  }
  return {fit.quantity, fit.preload,
          loadDisc(bench, discProtocol(fit.region, fit.quantity), top, fit.preload, kCurvePoints)};
}

DiscReport benchDisc(const Disc& disc, const DiscMesh& mesh, const std::vector<DiscTest>& tests,
                     bool all_tests, bool curves, double preload) {
  DiscReport report;
  report.disc = disc;
  report.preload = preload;
  report.area = upperEndplateArea(mesh);
  const DiscBench bench(mesh, disc.material);
  for (const DiscTest& test : tests) {
    const bool stands_in = std::none_of(tests.begin(), tests.end(), [&](const DiscTest& other) {
      return other.fit && other.quantity == test.quantity;
    });
    if (!test.fit && !stands_in && !all_tests) continue;
    DiscOutcome outcome = {test, std::nullopt};
    try {
      outcome.ours = simulateDiscTest(bench, disc.retardation_time, test);
    } catch (const DiscGaveWay&) {
    }
    report.outcomes.push_back(outcome);
  }
  for (const DiscTest& test : tests) {
    if (curves && test.fit && test.quantity <= Quantity::kAxialTorsion) {
      report.loadings.push_back(loadUp(bench, tests, test));
    }
  }
  report.stiffness = stiffnessMatrix(bench);
  DiscBench loaded = bench;
  loaded.setLoad(-preload * Vector6d::Unit(2));
  report.stiffness_preloaded = stiffnessMatrix(loaded);
  return report;
}

}  // namespace

DiscUnits discUnits(Quantity quantity) {
  if (quantity <= Quantity::kLateralShear) return {"N/mm", "N", "mm", 1e3, 1e-3};
  if (quantity <= Quantity::kAxialTorsion) return {"Nm/deg", "Nm", "deg", 1 / kDeg, kDeg};
  if (quantity == Quantity::kPressure) return {"MPa", "N", "mm", 1e6, 1e-3};
  return {"-", "N", "mm", 1, 1e-3};
}

std::vector<Disc> chooseDiscs(const Anatomy& anatomy, const std::string& level) {
  if (level.empty()) return anatomy.discs;
  return {anatomy.disc(level)};
}

std::vector<DiscReport> benchDiscs(const Anatomy& anatomy, const Skeleton& skeleton,
                                   const std::vector<Disc>& discs, bool all_tests, bool curves,
                                   double preload, int threads,
                                   const std::function<void(double)>& progress) {
  double stress = 0;
  for (const Disc& disc : anatomy.discs) {
    if (disc.name == kStressReference) stress = preload / areaOf(disc);
  }
  std::vector<DiscReport> reports(discs.size());
  std::mutex mutex;
  double done = 0;
  forEach(static_cast<int>(discs.size()), threads, [&](int i) {
    try {
      reports[i] = benchDisc(discs[i], fittedDiscMesh(anatomy, skeleton, discs[i]),
                             testsOf(anatomy, discs[i].region), all_tests, curves,
                             stress * areaOf(discs[i]));
    } catch (const DiscGaveWay& e) {
      throw Error(discs[i].name + ": " + e.what());
    }
    const std::lock_guard<std::mutex> lock(mutex);
    if (progress) progress(++done / static_cast<double>(discs.size()));
  });
  return reports;
}

}  // namespace torso::tools
