// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "model/anatomy.h"

namespace torso::tools {

// MJCF of the skeleton that a clip's motion is first put on, as in Lee et al. 2023: limbs, head and
// shoulder girdle as in the detailed body of `anatomy`, with the same names, frames and ball
// joints; of the trunk only three ball joints, between "pelvis", "abdomen", "ribcage" and "neck",
// at the discs L4/L5, T12/L1 and C7/T1. Rib cage and head also slide along the
// spine by as much as its curves can flatten, which ball joints so far apart would not show. Frames
// are those of model/body.h; the abdomen's and the neck's are at their joints. Kinematics only.
// With `meshes`, an absolute folder of `torso build` at the tables' size, it shows the bones,
// scaled as MjcfOptions has it.
std::string temporarySkeletonMjcf(const Anatomy& anatomy, const std::string& meshes = "",
                                  const std::map<std::string, double>& limb_scale = {});

}  // namespace torso::tools
