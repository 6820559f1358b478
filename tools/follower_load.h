// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Geometry>
#include <vector>

namespace torso::tools {

// The weight of a living trunk on its discs. Muscles along the spine take up the bending moments of
// what lies above, so that it presses each disc along its axis and turns nothing: Patwardhan et al.
// 1999, Spine 24:1003-1009. Each disc bears what of the weight above it points along its axis;
// upside down it is stretched.
class FollowerLoad {
 public:
  // torso: of BodyMjcf::torsoOnHolds; human: the whole body, whose masses count.
  FollowerLoad(const mjModel* torso, const mjModel* human);

  // Sets xfrc_applied of the bones for the pose in d, for which mj_kinematics was called. up: in
  // the model's world, unit.
  void apply(const mjModel* torso, mjData* d, const Eigen::Vector3d& up) const;

 private:
  struct Disc {
    int lower, upper;  // body ids
    int frame;         // site at its centre, z along its axis, on the lower bone
    double weight;     // of what lies above [N]
  };
  std::vector<Disc> discs_;
};

}  // namespace torso::tools
