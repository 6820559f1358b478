// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The muscles that turn the scapula upwards while the arm is raised.

#include <Eigen/Core>
#include <string>
#include <vector>

namespace torso::tools {

struct ScapularMuscle {   // a row of model/anatomy/scapular_muscles.csv; left side
  std::string name;       // "serratus_anterior"
  bool on_clavicle;       // else on the scapula
  std::string landmark;   // its end there
  Eigen::Vector3d other;  // its other end, fixed to the rib cage, standing body [m]
  double tension;         // with the arm raised to kArmRaised [N]
};
// Throws std::runtime_error that names the file and the line.
std::vector<ScapularMuscle> readScapularMuscles(const std::string& path);

constexpr double kArmRaised = 150 * EIGEN_PI / 180;  // [rad]

// Tension of a muscle at an elevation of the humerus from straight down [rad]: with its square.
double tensionAt(const ScapularMuscle& muscle, double elevation);

}  // namespace torso::tools
