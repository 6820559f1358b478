// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Feet and the floor, for retarget_targets.cc.

#include "tools/retarget.h"

namespace torso::tools {

// From our standing foot to the clip's joint: its sole is level on the mean of the frames in which
// the clip's foot stands, or else as in `standing`, the same for the pose in which the person
// stands; its toes (`our_toe`, from the ankle, standing axes) point where the clip's do.
Eigen::Matrix3d footTurn(const Clip& world, int foot, int toe, const Eigen::Matrix3d& standing,
                         const Eigen::Vector3d& our_toe);

// Finds when each foot stands (low and slow for a tenth of a second), puts all targets at the
// height at which standing soles are at 0, and keeps the feet from sliding while they stand.
void standOnFloor(const Clip& world, const Roles& roles, const Anatomy& anatomy, Targets& targets);

}  // namespace torso::tools
