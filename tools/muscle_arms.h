// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "model/anatomy.h"
#include "tools/muscle_moments.h"

namespace torso::tools {

// Of the fascicles of one side that pass a disc, weighted by their sections [m].
struct MuscleArm {
  std::string muscle, disc;
  double behind, beside;  // moment arms in extension and in bending to the muscle's side
  double behind_low, behind_high, beside_low, beside_high;  // published, muscle_arms.csv
  bool inside() const {
    return behind >= behind_low && behind <= behind_high && beside >= beside_low &&
           beside <= beside_high;
  }
};

// For each row of muscle_arms.csv in `folder`; of the pose in d. Throws std::runtime_error for a
// faulty table, Error if no fascicle of the muscle passes the disc.
std::vector<MuscleArm> measureArms(const Anatomy& anatomy, const std::string& folder,
                                   const mjModel* m, const mjData* d, const MuscleMoments& moments);

}  // namespace torso::tools
