// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/part_map.h"

namespace torso::tools {

// Parts that a map of `torso graft --map` may mention, from the pelvis up, then limbs.
const MapParts& bodyMapParts();

}  // namespace torso::tools
