// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Loads of the discs in everyday activities, held by servos and by muscles.

#include <map>
#include <string>
#include <vector>

#include "tools/activity.h"
#include "tools/muscle_moments.h"

namespace torso::tools {

// In the nucleus of a disc under no load [Pa], for the ligaments press on it and it swells:
// Nachemson and Evans 1968, J Biomech 1:211-220. Pressures of our discs are above it.
constexpr double kUnloadedPressure = 0.07e6;
// Of the disc L4/L5 of the man whose pressures were measured [m^2]: Wilke et al. 2001, Clin Biomech
// 16 Suppl 1:S111-S126.
constexpr double kSubjectsArea = 1800e-6;

struct DiscLoad {
  std::string disc;
  double nucleus_pressure;  // as a needle measures, that of the unloaded disc included [Pa]
  double surface_pressure;  // normal force on the endplate over its area [Pa], as the paper's
  double compression;       // along the disc's axis [N]
  double area;              // of the endplate [m^2]
  // That of the nucleus if the same force were on a disc of the subject's area [Pa].
  double pressureOnSubjectsArea() const {
    return kUnloadedPressure + (nucleus_pressure - kUnloadedPressure) * area / kSubjectsArea;
  }
};

struct Loading {
  std::vector<DiscLoad> discs;        // all, from below
  std::vector<double> servo_moments;  // flexion, at the cuts of MuscleMoments, from below [Nm]
  const DiscLoad& at(const std::string& disc) const;  // throws Error
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
// below 1 Nm or stands still. The servos stay, and give what muscles cannot. Throws Error.
ActivityLoads measureActivity(PosedBody& body, const MuscleMoments& moments,
                              const Activity& activity, bool muscles);

}  // namespace torso::tools
