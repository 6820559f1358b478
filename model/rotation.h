// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

namespace torso {

// The least rotation that turns the direction of `from` into that of `to`; neither need be a unit
// vector, neither may be zero. Of opposite directions: half a turn about some axis across them.
// Eigen's FromTwoVectors, which every file that calls it spends seconds to compile.
Eigen::Quaterniond leastRotation(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace torso
