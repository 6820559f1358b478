// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The trunk as common humanoids have it: three ball joints instead of the spine.

#include <string>

#include "model/anatomy.h"

namespace torso::tools {

// Vertebrae whose ribs reach the sternum: the rib cage holds them together.
inline constexpr const char* kSternalLevels[] = {"T1", "T2", "T3", "T4", "T5",
                                                 "T6", "T7", "T8", "T9", "T10"};

// The anatomy with ball joints "lumbar" (pelvis to abdomen), "thoracic" (abdomen to ribcage) and
// "cervical" (ribcage to neck) at the discs L4/L5, T12/L1 and C7/T1 beside its own, and with one
// set of servos each in place of those of the region's levels. A joint stands for the levels of its
// region in series: published ranges add up, stiffness, gain and damping are a level's over the
// number of levels that bend; those between ribs that reach the sternum do not. Its limit is a
// cone of the widest range. Passive stiffness: the discs' own in flexion (disc_tests.csv).
// Bodies "abdomen" and "neck" get frames (bodyFrame) at their joints, but no mass of their own.
// Throws std::runtime_error if the anatomy lacks one of those discs.
Anatomy withSimpleTrunk(const Anatomy& anatomy);

// The body, "pelvis", "abdomen", "ribcage" or "neck", that a vertebra, clavicle or scapula is part
// of; any other body is its own.
std::string simpleTrunkBody(const Anatomy& anatomy, const std::string& body);

}  // namespace torso::tools
