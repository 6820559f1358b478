// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "model/anatomy.h"

namespace torso {

// Segments of the limbs, from the trunk outwards: "upper_arm", "lower_arm", "hand", "thigh",
// "shin", "foot".
const std::vector<std::string>& limbSegments();

// The same body with other limbs: each segment, of both sides, times its factor > 0 in all
// directions about its joint with the one before, masses with the cube; what hangs on it moves
// along. Segments that are not named stay. Trunk and head stay where they are, so that the feet's
// height changes. Throws std::invalid_argument for a name that is none of limbSegments() or a
// factor that is not positive.
Anatomy withLimbs(const Anatomy& anatomy, const std::map<std::string, double>& factors);

}  // namespace torso
