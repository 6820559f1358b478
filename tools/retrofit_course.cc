// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/retrofit_course.h"

#include <algorithm>
#include <cmath>

#include "tools/graft_xml.h"
#include "tools/mujoco_support.h"

namespace torso::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Quaterniond;

// From rest to the first frame, and then at most until it is at rest.
constexpr int kApproach = 100, kFirstRest = 300;
constexpr double kAtRest = 1e-4;  // [rad] a step
// Of the holds in a step: one that moves faster gets more steps, up to so many a frame.
constexpr double kStride = 0.005, kTurn = EIGEN_PI / 180;  // [m], [rad]
constexpr int kMostSteps = 60;
// After the holds have come to a frame, for as long as it would be flagged as not at rest.
constexpr int kRest = 40;

Isometry3d blend(const Isometry3d& a, const Isometry3d& b, double s) {
  return isometry(Quaterniond(a.linear()).slerp(s, Quaterniond(b.linear())),
                  (1 - s) * a.translation() + s * b.translation());
}

}  // namespace

void Course::startAt(const HeldFrame& frame) {
  last_ = frame;
  started_ = true;
}

bool Course::follow(const HeldFrame& goal) {
  int steps = least_;
  for (std::size_t i = 0; i < goal.poses.size(); i++) {
    const Isometry3d move = last_.poses[i].inverse() * goal.poses[i];
    steps = std::max(steps, static_cast<int>(move.translation().norm() / kStride));
    steps = std::max(steps, static_cast<int>(Eigen::AngleAxisd(move.linear()).angle() / kTurn));
  }
  if (started_ && go(goal, std::min(steps, kMostSteps))) {
    for (int i = 0; i < kRest && unrest_ > unrest_limit_; i++) unrest_ = torso_.step();
    if (firstWarning(torso_.data()).empty()) return true;
  }
  const bool lost = started_;
  torso_.reset();
  startAt({torso_.restPoses(), goal.up, goal.lead});
  go(goal, kApproach);
  for (int i = 0; i < kFirstRest && unrest_ > kAtRest; i++) unrest_ = torso_.step();
  return !lost;
}

bool Course::go(const HeldFrame& goal, int steps) {
  std::vector<Isometry3d> now = goal.poses;
  for (int s = 1; s <= steps; s++) {
    const double share = static_cast<double>(s) / steps;
    for (std::size_t i = 0; i < now.size(); i++) {
      now[i] = blend(last_.poses[i], goal.poses[i], share);
    }
    torso_.hold(now, (1 - share) * last_.up + share * goal.up);
    torso_.lead((1 - share) * last_.lead + share * goal.lead);
    unrest_ = torso_.step();
  }
  last_ = goal;
  return firstWarning(torso_.data()).empty();
}

}  // namespace torso::tools
