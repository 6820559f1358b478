// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The shoulder of bodies whose clavicles and scapulae are part of a rigid trunk.

#include "model/anatomy.h"

namespace torso::tools {

// The anatomy with a glenohumeral joint that moves as far as the whole shoulder of a person: its
// servos get the ranges of servos.csv's "shoulder" rows, its limit is a cone of the widest of them,
// and its capsule, which resists from a scapula that has come along, is loose for so much longer as
// that has turned: a third of the way (Inman et al. 1944, J Bone Joint Surg 26:1-30). Gains,
// stiffness and damping stay those of the glenohumeral joint, the weakest of the series. Throws
// std::runtime_error if the tables lack the joint or a row.
Anatomy withWholeShoulder(const Anatomy& anatomy);

}  // namespace torso::tools
