// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "tools/shoulder_rhythm.h"

namespace torso::tools {

// Writes arm.png, the arm at rest, raised by 30, 60 ... 150 degrees, from behind, from its side and
// from the front, and girdle.png, the girdle at rest and at the end of each motion by its servos,
// from behind, from the side and from above, into `folder`, which exists. human: the whole body,
// whose left shoulder is posed. Throws Error.
void writeShoulderPictures(const std::string& folder, mjModel* human, const ShoulderReport& report);

}  // namespace torso::tools
