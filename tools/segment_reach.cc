// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/segment_reach.h"

#include <algorithm>
#include <limits>
#include <random>

namespace torso::tools {
namespace {

using Eigen::Vector3d;

constexpr double kSpread = 0.27;  // tangent of 15 deg
constexpr double kLeastShare = 0.8;

}  // namespace

bool PoseReach::feasible() const { return reached >= pose.target - kReachTolerance; }

SegmentReach::SegmentReach(const Anatomy& anatomy, const Skeleton& skeleton, const Disc& disc,
                           const std::vector<ExtremePose>& poses, int actions, std::uint64_t seed)
    : bench_(anatomy, skeleton, disc.name), poses_(poses), longest_(bench_.ligaments().size()) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0, kSpread);
  std::uniform_real_distribution<double> share(kLeastShare, 1);
  const double largest = laboratoryMoment(disc.region);
  for (const ExtremePose& pose : poses) {
    const Vector3d axis = turnAxis(pose.turn);
    actions_.push_back({{axis, largest}});
    for (int i = 1; i < actions; i++) {
      const Vector3d tilt(noise(random), noise(random), noise(random));
      actions_.back().push_back(
          {(axis + tilt - axis.dot(tilt) * axis).normalized(), share(random) * largest});
    }
  }
}

void SegmentReach::setMaxLength(const std::string& pair, double length) {
  bench_.setMaxLength(pair, length);
}

std::vector<PoseReach> SegmentReach::poses() {
  std::vector<PoseReach> reach;
  for (std::size_t i = 0; i < poses_.size(); i++) {
    reach.push_back({poses_[i], furthest(i, std::numeric_limits<double>::infinity())});
  }
  return reach;
}

std::optional<PoseReach> SegmentReach::lost(Turn first) {
  for (const bool is_first : {true, false}) {
    for (std::size_t i = 0; i < poses_.size(); i++) {
      if ((poses_[i].turn == first) != is_first) continue;
      const PoseReach reach = {poses_[i], furthest(i, poses_[i].target - kReachTolerance)};
      if (!reach.feasible()) return reach;
    }
  }
  return std::nullopt;
}

double SegmentReach::longest(const std::string& pair) const {
  double length = 0;
  for (std::size_t i = 0; i < longest_.size(); i++) {
    if (bench_.ligaments()[i] == pair) length = std::max(length, longest_[i]);
  }
  return length;
}

// The furthest that any action turns the segment about the pose's axis; no action follows one that
// turns it `enough`.
double SegmentReach::furthest(std::size_t pose, double enough) {
  double angle = 0;
  for (const Action& action : actions_[pose]) {
    const SegmentPose rest = bench_.load(action.axis, action.moment, 1).back();
    angle = std::max(angle, rest.rotation.dot(turnAxis(poses_[pose].turn)));
    for (std::size_t i = 0; i < longest_.size(); i++) {
      longest_[i] = std::max(longest_[i], rest.ligament_lengths[i]);
    }
    if (angle >= enough) break;
  }
  return angle;
}

}  // namespace torso::tools
