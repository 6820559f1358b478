// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// What `torso pressure` prints for people.

#include <vector>

#include "tools/muscle_arms.h"
#include "tools/pressure_study.h"

namespace torso::tools {

// Pressures of the measured disc beside the measurements. all: not empty; with muscles or without.
void printPressures(const std::vector<ActivityLoads>& all);

// What carries the moment about the measured disc, and how its compression and pressure follow,
// beside what the measured pressures stand for. all: with muscles.
void printBalance(const std::vector<ActivityLoads>& all);

// Pressures of the other discs, and the compression of L3/L4 beside Nachemson's. all: with muscles.
void printLevels(const std::vector<ActivityLoads>& all);

void printArms(const std::vector<MuscleArm>& arms);

}  // namespace torso::tools
