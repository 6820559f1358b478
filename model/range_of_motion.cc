// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/range_of_motion.h"

#include <stdexcept>
#include <vector>

#include "model/csv.h"

namespace torso {

std::map<std::string, RangeOfMotion> readRangeOfMotion(const std::string& path) {
  constexpr double kDegree = EIGEN_PI / 180;
  std::vector<std::string> motions;
  for (int k = 0; k < kNumMotions; k++) motions.push_back(motionName(static_cast<Motion>(k)));
  std::map<std::string, RangeOfMotion> ranges;
  const CsvTable table(path);
  for (int i = 0; i < table.rows(); i++) {
    MotionRange& range = ranges[table.text(i, "disc")][table.word(i, "motion", motions)];
    range = {table.number(i, "mean_deg") * kDegree, table.number(i, "low_deg") * kDegree,
             table.number(i, "high_deg") * kDegree, table.text(i, "sources")};
    if (!(0 <= range.low && range.low <= range.mean && range.mean <= range.high)) {
      throw std::runtime_error(table.where(i) + ": low_deg <= mean_deg <= high_deg must hold");
    }
  }
  return ranges;
}

}  // namespace torso
