// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// What people call bones.

#include <optional>
#include <string>
#include <vector>

namespace torso::tools {

// Bodies (model/body.h) that a file or object of this name holds: "lumbar1", "L1_whole", "vert-L1"
// -> {"L1"}; "cerv3" -> {"C3"}; "r_scapula", "scapula_right" -> {"right_scapula"}; "sacrum",
// "l_pelvis" -> {"pelvis"}; "skull" -> {"head"}; "ribcage" -> {"ribcage"}; "L_Shoulder" ->
// {"left_clavicle", "left_scapula"}; "spine", "lumbar" -> {"spine"}: vertebrae in one object. A
// limb or shoulder bone whose side is not told: "scapula". C1 and C2, which belong to the head:
// {"C2"}. Empty if the name says nothing, or is of a disc or a part of a vertebra ("L3_body").
std::vector<std::string> bodiesOfName(const std::string& name);

// "left", "right" or "".
std::string sideOfName(const std::string& name);

}  // namespace torso::tools
