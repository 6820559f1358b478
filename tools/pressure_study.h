// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Loads of the discs in everyday activities, held by servos and by muscles.

#include <map>
#include <string>
#include <vector>

#include "tools/activity.h"
#include "tools/muscle_moments.h"

namespace torso::tools {

struct DiscLoad {
  std::string disc;
  double nucleus_pressure;  // above that at rest [Pa], as a needle measures
  double surface_pressure;  // normal force on the endplate over its area [Pa], as the paper's
  double compression;       // along the disc's axis [N]
};

// At the cuts of MuscleMoments, from below: flexion moment about the disc [Nm].
struct Loading {
  std::vector<DiscLoad> discs;        // all, from below
  std::vector<double> servo_moments;  // what the servos still do
};

struct ActivityLoads {
  Activity activity;
  Loading servos;                             // without muscles
  Loading muscles;                            // with; no discs if they were not asked for
  std::map<std::string, double> group_force;  // sum of tensions by muscle [N]
  double largest_stress = 0;                  // [Pa]
};

// Puts the body in the posture, lets the servos hold it, and, if asked for, lets muscles take over:
// their tensions are those of least stress (model/muscle_stress.h) that give the moments which
// servos and muscles together gave at rest, again and again until the servos' share at the cuts is
// below 1 Nm or no longer falls. The servos stay, and give what muscles cannot. Throws Error.
ActivityLoads measureActivity(PosedBody& body, const MuscleMoments& moments,
                              const Activity& activity, bool muscles);

}  // namespace torso::tools
