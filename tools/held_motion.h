// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

namespace torso::tools {

// What a clip determines of the detailed body: world poses of the bones that are held, frame by
// frame. A bone that the clip lacks keeps its rest pose relative to its parent; all of `bodies`
// have a pose in each frame.
struct HeldMotion {
  std::string name;                 // of the clip
  double rate = 0;                  // frames per second [Hz]
  std::vector<std::string> bodies;  // of the detailed body (model/body.h): "pelvis", "head",
                                    // "left_upper_arm", "left_lower_arm", "left_hand",
                                    // "left_thigh", "left_shin", "left_foot", "right_..."
  std::vector<std::array<double, 3>> positions;    // frames x bodies, row-major: origin of the
                                                   // body's frame [m], world (z up, floor at 0)
  std::vector<std::array<double, 4>> quaternions;  // same shape, w first, continuous in time

  // Frame by frame: how far the clip's joints are from the temporary skeleton's after inverse
  // kinematics [m], and its bones [rad], largest over the bones that the clip has; and why a frame
  // is flagged, empty for a good one.
  std::vector<double> position_errors, rotation_errors;
  std::vector<std::vector<std::string>> flags;

  size_t frames() const { return bodies.empty() ? 0 : positions.size() / bodies.size(); }
};

}  // namespace torso::tools
