// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/scapular_muscles.h"

#include <algorithm>

#include "model/csv.h"

namespace torso::tools {

std::vector<ScapularMuscle> readScapularMuscles(const std::string& path) {
  const CsvTable table(path);
  std::vector<ScapularMuscle> muscles;
  for (int i = 0; i < table.rows(); i++) {
    const auto mm = [&](const char* column) { return 1e-3 * table.number(i, column); };
    muscles.push_back({table.text(i, "muscle"),
                       table.word(i, "bone", {"scapula", "clavicle"}) == 1,
                       table.text(i, "landmark"),
                       {mm("x_mm"), mm("y_mm"), mm("z_mm")},
                       table.number(i, "tension_n")});
  }
  return muscles;
}

double tensionAt(const ScapularMuscle& muscle, double elevation) {
  const double share = std::max(0.0, elevation - kSetting) / (kArmRaised - kSetting);
  return muscle.tension * share * share;
}

}  // namespace torso::tools
