// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/rom_report.h"

#include <algorithm>
#include <atomic>

#include "model/parallel.h"

namespace torso::tools {
namespace {

constexpr int kSteps = 10;

}  // namespace

double followerLoad(Region region) { return region == Region::kCervical ? 100 : 400; }

RomReport measureRom(const Anatomy& anatomy, const Skeleton& skeleton,
                     const std::vector<std::string>& names, const SegmentParts& parts,
                     bool follower, int threads, const std::function<void(double)>& progress) {
  std::vector<const Disc*> discs;
  for (const Disc& disc : anatomy.discs) {
    if (names.empty() || std::find(names.begin(), names.end(), disc.name) != names.end()) {
      discs.push_back(&disc);
    }
  }
  const int n = static_cast<int>(discs.size()), turns = static_cast<int>(std::size(kTurns));
  std::vector<LevelCurve> curves(n * turns);
  std::atomic<int> done{0};
  forEach(n, threads, [&](int i) {
    const Disc& disc = *discs[i];
    SegmentBench bench(anatomy, skeleton, disc.name, parts,
                       follower ? followerLoad(disc.region) : 0);
    for (int k = 0; k < turns; k++) {
      curves[i * turns + k] = {disc.name, kTurns[k],
                               bench.load(kTurns[k], laboratoryMoment(disc.region), kSteps)};
    }
    progress(static_cast<double>(++done) / n);
  });
  RomReport report;
  for (int i = 0; i < n; i++) {
    const auto end = [&](Turn turn) {
      return curves[i * turns + static_cast<int>(turn)].poses.back().angle;
    };
    const double flexion = end(Turn::kFlexion), extension = end(Turn::kExtension);
    const double angles[kNumMotions] = {flexion, extension, flexion + extension,
                                        end(Turn::kLeftBending), end(Turn::kLeftRotation)};
    const RangeOfMotion& range = anatomy.range_of_motion.at(discs[i]->name);
    for (int k = 0; k < kNumMotions; k++) {
      report.motions.push_back({discs[i]->name, static_cast<Motion>(k), angles[k], range[k]});
    }
  }
  report.curves = std::move(curves);
  return report;
}

double regionSum(const Anatomy& anatomy, const RomReport& report, Region region, Motion motion) {
  double sum = 0;
  for (const LevelMotion& m : report.motions) {
    for (const Disc& disc : anatomy.discs) {
      if (disc.name == m.disc && disc.region == region && m.motion == motion) sum += m.angle;
    }
  }
  return sum;
}

}  // namespace torso::tools
