// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Activities whose disc pressure was measured, and the postures they are simulated in.

#include <Eigen/Core>
#include <string>
#include <vector>

namespace torso::tools {

enum class Held { kFeet, kSeat, kBed };

// A row of activities.csv, which says what is what. Angles in radians, lengths in metres.
struct Activity {
  std::string name, title;
  Held held;
  Eigen::Vector3d gravity;  // unit
  double thorax_pitch, lumbar_flexion, knee, upper_arm, forearm;
  bool whole_body_leans;  // else the legs do; about the ankles, to balance
  double load;            // [kg]
  bool load_in_hands;
  double load_distance;  // before the sternum, if not in the hands
  double pressure;       // measured in the nucleus of L4/L5 [Pa]
  double l3_load;        // published compression of L3/L4 [N]; 0: none
};

// Throws std::runtime_error that names file, line and column at fault.
std::vector<Activity> readActivities(const std::string& folder);

}  // namespace torso::tools
