// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "tools/motion_file.h"

namespace torso::tools {

// How the regions of the spine turn along a motion, as rotation vectors from the standing pose in
// the standing axes of the lower bone [rad]: y is flexion.
struct SpineMotion {
  double rate = 0;  // frames per second [Hz]
  // One of each frame: T12 against the pelvis, T1 against T12, C3 against T1.
  std::vector<Eigen::Vector3d> lumbar, thoracic, neck;
};

// motion: of the model's columns. Nothing if the model has no such bones.
std::optional<SpineMotion> spineMotion(const mjModel* m, const Motion& motion);

// Of the power of the neck's angular velocity the share that is above 10 Hz: faster than a head is
// moved on purpose. 0 of fewer than 4 frames.
double neckJitter(const SpineMotion& spine);

// time_s, then the three flexions in degrees: lumbar_flexion_deg, thoracic_, neck_.
std::string spineCsv(const SpineMotion& spine);

}  // namespace torso::tools
