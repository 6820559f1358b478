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

constexpr double kSetting = 30 * EIGEN_PI / 180;     // end of the setting phase, Inman 1944 [rad]
constexpr double kArmRaised = 150 * EIGEN_PI / 180;  // [rad]

// Tension of a muscle [N] at an elevation of the humerus from straight down [rad]: none in the
// setting phase, then with the square of what is beyond it.
double tensionAt(const ScapularMuscle& muscle, double elevation);

}  // namespace torso::tools
