// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Geometry>
#include <string>
#include <vector>

namespace torso::tools {

// How the bones of a torso stand to each other: per disc the turn of the upper bone against the
// lower one, and per shoulder blade the turn against the rib cage.
class Posture {
 public:
  // m: a model with the plugin's discs; a body name without scapulae or rib cage is fine.
  explicit Posture(const mjModel* m);

  // "L5/S1" .. "C2/C3" (the head against C3), then "left_scapula" and "right_scapula".
  const std::vector<std::string>& names() const { return names_; }
  int levels() const { return levels_; }

  // Turns from the rest pose as rotations in the standing axes of the lower bone (x forward, y
  // left, z up). d: after mj_kinematics.
  std::vector<Eigen::Quaterniond> turns(const mjData* d) const;

 private:
  struct Pair {
    int lower, upper;            // body ids
    Eigen::Quaterniond axes[2];  // standing axes in the frames of the two bodies
  };
  std::vector<std::string> names_;
  std::vector<Pair> pairs_;
  int levels_ = 0;
};

// Rotation vector: lateral bending to the right, flexion, axial rotation to the left [rad].
Eigen::Vector3d rotationVector(const Eigen::Quaterniond& turn);

}  // namespace torso::tools
