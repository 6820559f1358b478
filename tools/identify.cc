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

// A ligament is tightened to within this of what it could be, of its length at rest.
constexpr double kResolution = 0.002;
// While tightening, poses must be reached with this to spare [rad], so that the table's rounding
// costs none.
constexpr double kSpare = 0.5 * kReachTolerance;
// Longest in one pose by far: by this share of its length at rest. Assumed.
constexpr double kIndependent = 0.02;

constexpr int kNumTurns = static_cast<int>(std::size(kTurns));
using Angles = std::array<double, kNumTurns>;

// What the ligaments must let the segment reach: no more than disc and facets do.
std::vector<ExtremePose> extremePoses(const std::vector<LevelReach>& reach) {
  std::vector<ExtremePose> poses;
  for (const LevelReach& r : reach) poses.push_back({r.turn, r.reached});
  return poses;
}

template <typename T>
std::vector<T> ofDisc(const std::vector<T>& all, const std::string& disc) {
  std::vector<T> chosen;
  std::copy_if(all.begin(), all.end(), std::back_inserter(chosen),
               [&](const T& x) { return x.disc == disc; });
  return chosen;
}

// One level on the bench.
class Level {
 public:
  Level(const Anatomy& anatomy, const Skeleton& skeleton, const Disc& disc,
        const RangeOfMotion& targets)
      : anatomy_(anatomy), skeleton_(skeleton), disc_(disc) {
    SegmentBench bench(anatomy, skeleton, disc.name, {false, true});
    ligaments_ = bench.ligaments();
    for (int k = 0; k < kNumTurns; k++) {
      target_[k] = targets[motionOf(kTurns[k])].mean;
      poses_[k] = bench.load(kTurns[k], laboratoryMoment(disc.region), kSteps);
      reach_.push_back(
          {disc.name, kTurns[k], target_[k], std::min(target_[k], poses_[k].back().angle)});
    }
  }

  const std::vector<LevelReach>& reach() const { return reach_; }

  std::vector<LigamentLength> present() const {
    std::vector<LigamentLength> lengths = longest(target_);
    for (LigamentLength& length : lengths) {
      for (const Ligament& ligament : anatomy_.ligaments) {
        if (ligamentPair(ligament) != length.ligament) continue;
        length.max = length.rest * ligament.max_length_ratio.at(disc_.name);
      }
    }
    return lengths;
  }

  // Ligaments give way a little before they hold. So the poses in which they are measured are drawn
  // back until the segment with them turns by its target.
  std::vector<LigamentLength> identify(const std::vector<std::string>& order) const {
    constexpr int kPasses = 4;
    Angles aim = target_;
    std::vector<LigamentLength> lengths = longest(aim);
    SegmentBench bench(anatomy_, skeleton_, disc_.name);
    for (int pass = 1; pass < kPasses; pass++) {
      for (const LigamentLength& l : lengths) bench.setMaxLength(l.ligament, l.max);
      for (int k = 0; k < kNumTurns; k++) {
        const double angle = bench.load(kTurns[k], laboratoryMoment(disc_.region), 1).back().angle;
        aim[k] = std::clamp(aim[k] - (angle - target_[k]), 0.3 * target_[k], target_[k]);
      }
      lengths = longest(aim);
    }
    tighten(order, &lengths);
    return lengths;
  }

 private:
  // Shortens one ligament after the other while all poses can be reached.
  void tighten(const std::vector<std::string>& order, std::vector<LigamentLength>* lengths) const {
    std::vector<ExtremePose> poses = extremePoses(reach_);
    for (ExtremePose& pose : poses) pose.target += kSpare;
    SegmentReach reach(withLengths(anatomy_, *lengths), skeleton_, disc_, poses);
    std::vector<LigamentLength*> turns;
    for (LigamentLength& length : *lengths) turns.push_back(&length);
    const auto rank = [&](const LigamentLength* l) {
      const auto place = std::find(order.begin(), order.end(), l->ligament);
      if (place != order.end()) return static_cast<int>(place - order.begin());
      return static_cast<int>(order.size()) + (independent(*l) ? 0 : 1);
    };
    std::stable_sort(turns.begin(), turns.end(),
                     [&](const auto* a, const auto* b) { return rank(a) < rank(b); });
    for (LigamentLength* length : turns) {
      double holds = length->rest, free = length->max;  // loses a pose, loses none
      for (double next = free - 2 * kResolution * length->rest;
           free - holds > kResolution * length->rest && next > holds; next = (holds + free) / 2) {
        reach.setMaxLength(length->ligament, next);
        (reach.lost(length->turn) ? holds : free) = next;
      }
      length->max = free;
      reach.setMaxLength(length->ligament, free);
    }
  }

  bool independent(const LigamentLength& ligament) const {
    for (int k = 0; k < kNumTurns; k++) {
      if (kTurns[k] == ligament.turn) continue;
      const SegmentPose extreme = poseAt(poses_[k], target_[k]);
      for (std::size_t i = 0; i < ligaments_.size(); i++) {
        if (ligaments_[i] == ligament.ligament &&
            extreme.ligament_lengths[i] > ligament.max - kIndependent * ligament.rest) {
          return false;
        }
      }
    }
    return true;
  }

  // Each ligament's longest over the poses at these angles.
  std::vector<LigamentLength> longest(const Angles& angles) const {
    std::vector<LigamentLength> lengths;
    for (int k = 0; k < kNumTurns; k++) {
      const SegmentPose extreme = poseAt(poses_[k], angles[k]);
      for (std::size_t i = 0; i < ligaments_.size(); i++) {
        auto length = std::find_if(lengths.begin(), lengths.end(), [&](const LigamentLength& l) {
          return l.ligament == ligaments_[i];
        });
        if (length == lengths.end()) {
          const double rest = poses_[k].front().ligament_lengths[i];
          lengths.push_back({disc_.name, ligaments_[i], rest, kLeastRatio * rest, kTurns[k]});
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
  std::vector<std::string> ligaments_;  // of the bench
  Angles target_;
  std::array<std::vector<SegmentPose>, kNumTurns> poses_;  // without ligaments
  std::vector<LevelReach> reach_;
};

template <typename Lengths>
Identification eachLevel(const Anatomy& anatomy, const Skeleton& skeleton,
                         const IdentifyOptions& options,
                         const std::function<void(double)>& progress, const Lengths& lengths) {
  std::vector<const Disc*> discs;
  for (const Disc& disc : anatomy.discs) {
    if (disc.upper == anatomy.c2.name) continue;  // C2/C3 has no ligaments
    const auto& names = options.discs;
    if (names.empty() || std::find(names.begin(), names.end(), disc.name) != names.end()) {
      discs.push_back(&disc);
    }
  }
  const int n = static_cast<int>(discs.size());
  std::vector<Identification> levels(n);
  std::atomic<int> done{0};
  forEach(n, options.threads, [&](int i) {
    const Level level(anatomy, skeleton, *discs[i], options.targets.at(discs[i]->name));
    levels[i] = {lengths(level), level.reach()};
    progress(static_cast<double>(++done) / n);
  });
  Identification result;
  for (const Identification& level : levels) {
    result.lengths.insert(result.lengths.end(), level.lengths.begin(), level.lengths.end());
    result.reach.insert(result.reach.end(), level.reach.begin(), level.reach.end());
  }
  return result;
}

}  // namespace

Identification identifyLigaments(const Anatomy& anatomy, const Skeleton& skeleton,
                                 const IdentifyOptions& options,
                                 const std::function<void(double)>& progress) {
  return eachLevel(anatomy, skeleton, options, progress,
                   [&](const Level& level) { return level.identify(options.order); });
}

Identification presentLengths(const Anatomy& anatomy, const Skeleton& skeleton,
                              const IdentifyOptions& options,
                              const std::function<void(double)>& progress) {
  return eachLevel(anatomy, skeleton, options, progress,
                   [](const Level& level) { return level.present(); });
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

std::vector<LevelFeasibility> checkFeasibility(const Anatomy& anatomy, const Skeleton& skeleton,
                                               const Identification& found,
                                               const FeasibilityOptions& options,
                                               const std::function<void(double)>& progress) {
  const Anatomy identified = withLengths(anatomy, found.lengths);
  std::vector<LevelFeasibility> levels;
  for (const Disc& disc : anatomy.discs) {
    if (!ofDisc(found.lengths, disc.name).empty()) levels.push_back({disc.name, {}, {}});
  }
  const int n = static_cast<int>(levels.size());
  std::atomic<int> done{0};
  forEach(n, options.threads, [&](int i) {
    LevelFeasibility& level = levels[i];
    const auto disc = std::find_if(anatomy.discs.begin(), anatomy.discs.end(),
                                   [&](const Disc& d) { return d.name == level.disc; });
    const auto place = static_cast<std::uint64_t>(disc - anatomy.discs.begin());
    SegmentReach reach(identified, skeleton, *disc, extremePoses(ofDisc(found.reach, disc->name)),
                       options.actions, options.seed * anatomy.discs.size() + place);
    level.poses = reach.poses();
    const auto lengths = ofDisc(found.lengths, disc->name);
    std::vector<double> longest;
    for (const LigamentLength& length : lengths) longest.push_back(reach.longest(length.ligament));
    for (std::size_t k = 0; k < lengths.size(); k++) {
      constexpr double kSlack = 1e-5;  // [m]
      const LigamentLength& length = lengths[k];
      reach.setMaxLength(length.ligament, length.max - options.step * length.rest);
      level.shortenings.push_back(
          {length.ligament, reach.lost(length.turn), longest[k] < length.max - kSlack});
      reach.setMaxLength(length.ligament, length.max);
    }
    progress(static_cast<double>(++done) / n);
  });
  return levels;
}

}  // namespace torso::tools
