// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Core>

namespace torso::tools {

// MuJoCo's arrays as Eigen's types: 3 numbers, and 9 numbers row by row.
inline Eigen::Vector3d vector3(const mjtNum* x) { return {x[0], x[1], x[2]}; }
inline Eigen::Matrix3d matrix3(const mjtNum* x) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(x);
}

}  // namespace torso::tools
