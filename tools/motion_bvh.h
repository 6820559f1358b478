// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mujoco/mujoco.h>

#include <string>

#include "tools/motion_file.h"

namespace torso::tools {

// A motion as BVH with a joint for each bone: vertebrae on each other from the pelvis up, the rib
// cage on T7, the rest as in the model. y up, z forward, in centimetres, as other programs expect
// it. BVH's joints only turn: the discs' millimetres stay out, and positions add up from the
// pelvis. m: the model with these joints, motion: of motionOf.
std::string motionBvh(const mjModel* m, const Motion& motion);

}  // namespace torso::tools
