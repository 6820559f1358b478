// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace torso::tools {

// What Renderer draws as a rod with round ends [m].
struct Stick {
  Eigen::Vector3d from, to;
};

}  // namespace torso::tools
