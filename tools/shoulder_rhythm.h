// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The scapulohumeral rhythm: how the scapula follows the arm, ours and published.

#include <string>
#include <utility>
#include <vector>

#include "tools/shoulder_bench.h"

namespace torso::tools {

struct PublishedRhythm {  // a row of model/anatomy/shoulder_rhythm.csv
  std::string quantity;
  double elevation;  // of the humerus [rad]; 0 for the ratio
  double value;      // [rad]; the ratio has no unit
  std::string source, provenance;
};
// Throws std::runtime_error that names the file and the line.
std::vector<PublishedRhythm> readShoulderRhythm(const std::string& path);

struct ShoulderReport {
  ShoulderPose rest;                            // arm at the side
  std::vector<ShoulderPose> raising, lowering;  // elevation rises, falls
  // Degrees of glenohumeral elevation per degree of upward rotation, from kSetting on.
  double raising_ratio, lowering_ratio;
  std::vector<std::pair<GirdleMotion, std::vector<ShoulderPose>>> girdle;
  // Over all poses [m].
  double gliding_distance, clearance, medial_border, inferior_angle;
};

// Raises the arm to 150 degrees in `seconds` and lowers it, then moves the girdle. Throws Error.
ShoulderReport measureShoulder(ShoulderBench& bench, double seconds,
                               const std::vector<ScapularMuscle>& muscles);

// Upward rotation at an elevation, between the poses next to it [rad]; NaN outside of them.
double upwardRotationAt(const std::vector<ShoulderPose>& poses, double elevation);

// Writes shoulder.csv, rhythm.csv (published) and shoulder.gp, which draws shoulder.png, into
// `folder`, which is made if need be. Throws Error.
void writeShoulderPlots(const std::string& folder, const ShoulderReport& report,
                        const std::vector<PublishedRhythm>& published);

}  // namespace torso::tools
