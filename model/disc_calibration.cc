// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/disc_calibration.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "model/disc_bench.h"
#include "model/parallel.h"

namespace torso {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Quantity = DiscTest::Quantity;

constexpr double kInsideWeight = 0.25, kOutsideWeight = 20;

using Ends = std::optional<DiscTestEnds>;  // none where a disc gives way

// What a disc gives in a test, or a tenth of the lower bound if it gives way: that a disc finds no
// equilibrium happens where it is far too soft. near, ends: as simulateDiscTest's, or null.
double outcome(const DiscBench& bench, const DiscTest& test, const Ends* near, Ends* ends) {
  if (ends) ends->emplace(DiscTestEnds{bench, bench});
  DiscTestEnds* const where = ends ? &**ends : nullptr;
  if (near && *near) {
    try {
      return std::max(simulateDiscTest(bench, test, &**near, where), test.low / 10);
    } catch (const DiscGaveWay&) {
    }
  }
  try {
    return std::max(simulateDiscTest(bench, test, nullptr, where), test.low / 10);
  } catch (const DiscGaveWay&) {
    if (ends) ends->reset();
    return test.low / 10;
  }
}

class Fit {
 public:
  Fit(const std::vector<DiscMesh>& discs, const std::vector<DiscTest>& tests,
      const DiscMaterial& start, int threads)
      : meshes_(discs), tests_(tests), material_(start), threads_(threads) {}

  DiscMaterial material(const VectorXd& logs) const {
    DiscMaterial m = material_;
    for (int k = 0; k < logs.size(); ++k) m.*fittedConstants()[k].member = std::exp(logs[k]);
    return m;
  }

  // One column of residuals for each point. near: what a point near them all left in `ends`, or
  // null; ends (disc x test): where the tests of the only point ended, or null.
  MatrixXd residuals(const std::vector<VectorXd>& points, const std::vector<Ends>* near,
                     std::vector<Ends>* ends) const {
    const int discs = static_cast<int>(meshes_.size()), tests = static_cast<int>(tests_.size());
    const int constants = static_cast<int>(fittedConstants().size());
    if (ends) ends->resize(discs * tests);
    MatrixXd r = MatrixXd::Zero(2 * discs * tests + constants, points.size());
    forEach(static_cast<int>(points.size()) * discs, threads_, [&](int i) {
      const int p = i / discs, d = i % discs;
      const DiscBench bench(meshes_[d], material(points[p]));
      for (int t = 0; t < tests; ++t) {
        const DiscTest& test = tests_[t];
        const double half_width = std::log(test.high / test.low) / 2;
        const int place = d * tests + t;
        const double ours = outcome(bench, test, near ? &(*near)[place] : nullptr,
                                    ends ? &(*ends)[place] : nullptr);
        const int row = 2 * place;
        r(row, p) = kInsideWeight * std::log(ours / test.value) / half_width;
        const double above = std::max(0.0, std::log(ours / test.high));
        const double below = std::max(0.0, std::log(test.low / ours));
        r(row + 1, p) = kOutsideWeight * (above - below) / half_width;
      }
    });
    for (size_t p = 0; p < points.size(); ++p) {
      for (int k = 0; k < constants; ++k) {
        const double typical = fittedConstants()[k].typical;
        r(2 * discs * tests + k, p) = (points[p][k] - std::log(typical)) / std::log(4);
      }
    }
    return r;
  }

 private:
  std::vector<DiscMesh> meshes_;
  std::vector<DiscTest> tests_;
  DiscMaterial material_;
  int threads_;
};

void clampToBounds(VectorXd* logs) {
  for (int k = 0; k < logs->size(); ++k) {
    const FittedConstant& c = fittedConstants()[k];
    (*logs)[k] = std::clamp((*logs)[k], std::log(c.low), std::log(c.high));
  }
}

// The step of a damped normal equation; constants that it would push through a bound stay.
VectorXd dampedStep(const MatrixXd& J, const VectorXd& r, const VectorXd& logs, double damping) {
  const int n = static_cast<int>(logs.size());
  std::vector<bool> stays(n, false);
  while (true) {
    MatrixXd A = J.transpose() * J;
    A.diagonal() *= 1 + damping;
    VectorXd b = -J.transpose() * r;
    for (int k = 0; k < n; ++k) {
      if (!stays[k]) continue;
      A.row(k).setZero();
      A.col(k).setZero();
      A(k, k) = 1;
      b[k] = 0;
    }
    const VectorXd step = A.ldlt().solve(b);
    bool changed = false;
    for (int k = 0; k < n; ++k) {
      const FittedConstant& c = fittedConstants()[k];
      const bool at_low = logs[k] <= std::log(c.low) && step[k] < 0;
      const bool at_high = logs[k] >= std::log(c.high) && step[k] > 0;
      if (!stays[k] && (at_low || at_high)) changed = stays[k] = true;
    }
    if (!changed) return step;
  }
}

}  // namespace

const std::vector<FittedConstant>& fittedConstants() {
  static const std::vector<FittedConstant> constants = {
      {"annulus_modulus_mpa", 1e6, &DiscMaterial::annulus_modulus, 2.5e6, 0.2e6, 10e6},
      {"annulus_poissons_ratio", 1, &DiscMaterial::annulus_poisson, 0.42, 0.35, 0.48},
      {"fibre_modulus_mpa", 1e6, &DiscMaterial::fibre_modulus, 10e6, 1e6, 100e6},
      {"fibre_stiffening", 1, &DiscMaterial::fibre_stiffening, 10, 0.5, 25},
      {"nucleus_modulus_mpa", 1e6, &DiscMaterial::nucleus_modulus, 0.3e6, 0.02e6, 2e6},
  };
  return constants;
}

DiscCalibration calibrateDiscs(const std::vector<DiscMesh>& discs,
                               const std::vector<DiscTest>& tests, const DiscMaterial& start,
                               int threads) {
  if (discs.empty() || tests.empty()) {
    throw std::invalid_argument("disc calibration: there must be a disc and a test");
  }
  std::vector<DiscTest> used;
  for (const DiscTest& test : tests) {
    if (test.region != tests[0].region) {
      throw std::invalid_argument("disc calibration: tests of several regions");
    }
    if (test.quantity != Quantity::kLossFactor && test.quantity != Quantity::kPreloadRatio) {
      used.push_back(test);
    }
  }
  const Fit fit(discs, used, start, threads);
  const int n = static_cast<int>(fittedConstants().size());
  VectorXd logs(n);
  for (int k = 0; k < n; ++k) logs[k] = std::log(start.*fittedConstants()[k].member);
  clampToBounds(&logs);

  constexpr double kDifference = 1e-3;  // of a logarithm
  constexpr double kConverged = 1e-3;   // step of a logarithm
  constexpr double kLargestStep = 0.7;  // of a logarithm
  constexpr int kMaxIterations = 100;
  constexpr double kNear = 0.05;  // of a logarithm: tests may start where the last ended
  std::vector<Ends> ends, ends_next;
  VectorXd r = fit.residuals({logs}, nullptr, &ends).col(0);
  MatrixXd J;
  bool exact = false;  // J, that is: by differences here, not carried along by Broyden's update
  double damping = 1e-2;
  int iteration = 0;
  for (; iteration < kMaxIterations; ++iteration) {
    if (J.size() == 0) {
      std::vector<VectorXd> points(n, logs);
      for (int k = 0; k < n; ++k) points[k][k] += kDifference;
      J = (fit.residuals(points, &ends, nullptr).colwise() - r) / kDifference;
      exact = true;
    }
    VectorXd next = dampedStep(J, r, logs, damping);
    next = logs + next * std::min(1.0, kLargestStep / next.cwiseAbs().maxCoeff());
    clampToBounds(&next);
    const VectorXd step = next - logs;
    if (step.cwiseAbs().maxCoeff() < kConverged) {
      if (exact) break;
      J.resize(0, 0);
      continue;
    }
    const bool near = step.cwiseAbs().maxCoeff() < kNear;
    const VectorXd r_next = fit.residuals({next}, near ? &ends : nullptr, &ends_next).col(0);
    if (r_next.squaredNorm() < r.squaredNorm()) {
      J += (r_next - r - J * step) * step.transpose() / step.squaredNorm();
      exact = false;
      logs = next;
      r = r_next;
      std::swap(ends, ends_next);
      damping = std::max(damping / 10, 1e-6);
    } else if (exact) {
      damping = std::max(10 * damping, 1e-4);
    } else {
      J.resize(0, 0);
    }
  }
  return {fit.material(logs), r.squaredNorm(), iteration};
}

}  // namespace torso
