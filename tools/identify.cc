// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/identify.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <iterator>

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

constexpr int kNumTurns = static_cast<int>(std::size(kTurns));
using Angles = std::array<double, kNumTurns>;

// One level on the bench.
class Level {
 public:
  Level(const Anatomy& anatomy, const Skeleton& skeleton, const Disc& disc)
      : anatomy_(anatomy), skeleton_(skeleton), disc_(disc) {
    SegmentBench bench(anatomy, skeleton, disc.name, {false, true});
    for (const std::string& name : bench.ligaments()) {
      for (const Ligament& ligament : anatomy.ligaments) {
        if (ligament.name == name) pairs_.push_back(ligamentPair(ligament));
      }
    }
    for (int k = 0; k < kNumTurns; k++) {
      target_[k] = anatomy.range_of_motion.at(disc.name)[motionOf(kTurns[k])].mean;
      poses_[k] = bench.load(kTurns[k], laboratoryMoment(disc.region), kSteps);
      reach_.push_back(
          {disc.name, kTurns[k], target_[k], std::min(target_[k], poses_[k].back().angle)});
    }
  }

  const std::vector<LevelReach>& reach() const { return reach_; }

  // Ligaments give way a little before they hold. So the poses in which they are measured are drawn
  // back until the segment with them turns by its target.
  std::vector<LigamentLength> identify() const {
    constexpr int kPasses = 4;
    Angles aim = target_;
    std::vector<LigamentLength> lengths = longest(aim);
    for (int pass = 1; pass < kPasses; pass++) {
      SegmentBench bench(withLengths(anatomy_, lengths), skeleton_, disc_.name);
      for (int k = 0; k < kNumTurns; k++) {
        const double angle = bench.load(kTurns[k], laboratoryMoment(disc_.region), 1).back().angle;
        aim[k] = std::clamp(aim[k] - (angle - target_[k]), 0.3 * target_[k], target_[k]);
      }
      lengths = longest(aim);
    }
    return lengths;
  }

 private:
  // Each ligament's longest over the poses at these angles.
  std::vector<LigamentLength> longest(const Angles& angles) const {
    std::vector<LigamentLength> lengths;
    for (int k = 0; k < kNumTurns; k++) {
      const SegmentPose extreme = poseAt(poses_[k], angles[k]);
      for (std::size_t i = 0; i < pairs_.size(); i++) {
        auto length = std::find_if(lengths.begin(), lengths.end(), [&](const LigamentLength& l) {
          return l.ligament == pairs_[i];
        });
        if (length == lengths.end()) {
          const double rest = poses_[k].front().ligament_lengths[i];
          lengths.push_back({disc_.name, pairs_[i], rest, kLeastRatio * rest, kTurns[k]});
          length = std::prev(lengths.end());
        }
        if (extreme.ligament_lengths[i] <= length->max) continue;
        length->max = extreme.ligament_lengths[i];
        length->turn = kTurns[k];
      }
    }
    return lengths;
  }

  const Anatomy& anatomy_;
  const Skeleton& skeleton_;
  const Disc& disc_;
  std::vector<std::string> pairs_;  // of the bench's ligaments
  Angles target_;
  std::array<std::vector<SegmentPose>, kNumTurns> poses_;  // without ligaments
  std::vector<LevelReach> reach_;
};

}  // namespace

Identification identifyLigaments(const Anatomy& anatomy, const Skeleton& skeleton,
                                 const std::vector<std::string>& names, int threads,
                                 const std::function<void(double)>& progress) {
  std::vector<const Disc*> discs;
  for (const Disc& disc : anatomy.discs) {
    if (disc.upper == anatomy.c2.name) continue;  // C2/C3 has no ligaments
    if (names.empty() || std::find(names.begin(), names.end(), disc.name) != names.end()) {
      discs.push_back(&disc);
    }
  }
  const int n = static_cast<int>(discs.size());
  std::vector<Identification> levels(n);
  std::atomic<int> done{0};
  forEach(n, threads, [&](int i) {
    const Level level(anatomy, skeleton, *discs[i]);
    levels[i] = {level.identify(), level.reach()};
    progress(static_cast<double>(++done) / n);
  });
  Identification result;
  for (const Identification& level : levels) {
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
