// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/identify.h"

#include <algorithm>
#include <atomic>
#include <map>

#include "model/ligament.h"
#include "model/parallel.h"

namespace torso::tools {
namespace {

// Steps of the moment; between two of them lengths are interpolated.
constexpr int kSteps = 20;
// A ligament that no extreme pose stretches keeps this slack. Assumed: it then bears in none.
constexpr double kLeastRatio = 1.01;

Motion motionOf(Turn turn) {
  return turn == Turn::kFlexion       ? kFlexion
         : turn == Turn::kExtension   ? kExtension
         : turn == Turn::kLeftBending ? kLateralBending
                                      : kAxialRotation;
}

// The pose at an angle between two poses, or the last one.
SegmentPose poseAt(const std::vector<SegmentPose>& poses, double angle) {
  for (std::size_t i = 1; i < poses.size(); i++) {
    const SegmentPose &a = poses[i - 1], &b = poses[i];
    if (b.angle < angle) continue;
    const double s = (angle - a.angle) / (b.angle - a.angle);
    SegmentPose pose = a;
    pose.moment += s * (b.moment - a.moment);
    pose.angle = angle;
    for (std::size_t k = 0; k < pose.ligament_lengths.size(); k++) {
      pose.ligament_lengths[k] += s * (b.ligament_lengths[k] - a.ligament_lengths[k]);
    }
    return pose;
  }
  return poses.back();
}

struct Level {
  std::vector<LigamentLength> lengths;
  std::vector<LevelReach> reach;
};

Level identifyLevel(const Anatomy& anatomy, const Disc& disc) {
  SegmentBench bench(anatomy, disc.name, {false, true});
  std::map<std::string, std::string> pairs;
  for (const Ligament& ligament : anatomy.ligaments) pairs[ligament.name] = ligamentPair(ligament);
  std::map<std::string, LigamentLength> found;
  Level level;
  for (const Turn turn : kTurns) {
    const double target = anatomy.range_of_motion.at(disc.name)[motionOf(turn)].mean;
    const auto poses = bench.load(turn, laboratoryMoment(disc.region), kSteps);
    const SegmentPose extreme = poseAt(poses, target);
    level.reach.push_back({disc.name, turn, target, extreme.angle});
    for (std::size_t k = 0; k < bench.ligaments().size(); k++) {
      const std::string& pair = pairs.at(bench.ligaments()[k]);
      const double rest = poses.front().ligament_lengths[k];
      LigamentLength& length =
          found.try_emplace(pair, LigamentLength{disc.name, pair, rest, kLeastRatio * rest, turn})
              .first->second;
      if (extreme.ligament_lengths[k] <= length.max) continue;
      length.max = extreme.ligament_lengths[k];
      length.turn = turn;
    }
  }
  for (const Ligament& ligament : anatomy.ligaments) {
    const auto it = found.find(ligamentPair(ligament));
    if (ligament.side == Side::kRight || it == found.end()) continue;
    level.lengths.push_back(it->second);
  }
  return level;
}

}  // namespace

Identification identifyLigaments(const Anatomy& anatomy, int threads,
                                 const std::function<void(double)>& progress) {
  std::vector<const Disc*> discs;
  for (const Disc& disc : anatomy.discs) {
    if (disc.upper != anatomy.c2.name) discs.push_back(&disc);  // C2/C3 has no ligaments
  }
  const int n = static_cast<int>(discs.size());
  std::vector<Level> levels(n);
  std::atomic<int> done{0};
  forEach(n, threads, [&](int i) {
    levels[i] = identifyLevel(anatomy, *discs[i]);
    progress(static_cast<double>(++done) / n);
  });
  Identification result;
  for (const Level& level : levels) {
    result.lengths.insert(result.lengths.end(), level.lengths.begin(), level.lengths.end());
    result.reach.insert(result.reach.end(), level.reach.begin(), level.reach.end());
  }
  return result;
}

Anatomy withLengths(Anatomy anatomy, const std::vector<LigamentLength>& lengths) {
  for (Ligament& ligament : anatomy.ligaments) {
    for (const LigamentLength& length : lengths) {
      if (ligamentPair(ligament) != length.ligament) continue;
      ligament.max_length_ratio[length.disc] = length.max / length.rest;
    }
  }
  return anatomy;
}

}  // namespace torso::tools
