// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "tools/equilibrium.h"

namespace torso::tools {

// Where the torso is held in a frame.
struct HeldFrame {
  std::vector<Eigen::Isometry3d> poses;  // Equilibrium::hold
  Eigen::Vector3d up;
  Eigen::Matrix3Xd lead;  // Equilibrium::lead; empty: none
};

// The way of an Equilibrium's holds from frame to frame.
class Course {
 public:
  // least: steps of descent a frame; more are taken where the holds move fast. unrest: the largest
  // turn by a step [rad] with which a frame is left.
  Course(Equilibrium& torso, int least, double unrest)
      : torso_(torso), last_{torso.restPoses(), {}, {}}, least_(least), unrest_limit_(unrest) {}

  // The torso is in equilibrium at this frame.
  void startAt(const HeldFrame& frame);
  // Brings the torso along as the holds go to the next frame; the first time from rest. Returns
  // false if it lost its footing on the way, for a pose far out of reach, and has come from rest
  // again.
  bool follow(const HeldFrame& frame);
  // Largest turn by the last step [rad].
  double unrest() const { return unrest_; }

 private:
  bool go(const HeldFrame& goal, int steps);

  Equilibrium& torso_;
  HeldFrame last_;
  int least_;
  double unrest_limit_;
  bool started_ = false;
  double unrest_ = 0;
};

}  // namespace torso::tools
