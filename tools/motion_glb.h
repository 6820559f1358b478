// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mujoco/mujoco.h>

#include <string>

#include "tools/motion_file.h"

namespace torso::tools {

// A motion with the model's bones as binary glTF 2.0, y up, in metres: a node for each bone,
// named like its body, with the meshes that the model shows (geom group 1) and its place and turn
// in each frame. m: the model with its meshes, motion: of motionOf. Throws Error if the model has
// no meshes, or if the file would exceed 4 GB.
std::string motionGlb(const mjModel* m, const Motion& motion);

}  // namespace torso::tools
