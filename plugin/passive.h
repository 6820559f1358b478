// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mujoco/mujoco.h>

#include "plugin/instance.h"

namespace torso::plugin {

// Pose of the upper bone's disc frame in the lower one's, and the lower one's in the world, from
// the body frames of the last mj_kinematics.
struct DiscPlacement {
  DiscPose relative, world;
};
DiscPlacement placeDisc(const mjData* d, const DiscEntry& disc);

// Adds the elastic forces of all discs to qfrc_passive and leaves shapes and wrenches in userdata.
// Starts from the shapes at the last evaluation of an earlier time and another pose, so that
// repeated calls at one time give the same bits, and so do the velocity steps of MuJoCo's finite
// differences, which let time run on.
void applyDiscs(const mjModel* m, mjData* d, const Instance& instance);

// Rewrites the constraint rows of the welds (between mj_makeConstraint and mj_referenceConstraint).
void rewriteWelds(const mjModel* m, mjData* d, const Instance& instance);

// Rewrites the rows of ligaments and facets so that their limits hold at the end of the step.
void rewriteLimits(const mjModel* m, mjData* d, const Instance& instance);

}  // namespace torso::plugin
