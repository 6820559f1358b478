// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "tools/held_motion.h"

namespace torso::tools {

// How fast turns change, over the frequencies of their angular velocity.
struct Smoothness {
  double band = 0;          // 99 % of the input's power is below it [Hz]
  double input_share = 0;   // of the input's power that is above the band
  double output_share = 0;  // of the output's
  double gain = 0;          // output's power above the band over the input's there
  double largest_jump = 0;  // of the output: second difference of a turn over one frame [rad]
};

// input, output: (frames x turns), frame by frame, each at least 4 frames long; rate [Hz]. Spectra
// of first differences, seen through a Hann window, summed over all turns and axes.
Smoothness smoothness(const std::vector<std::vector<Eigen::Vector3d>>& input,
                      const std::vector<std::vector<Eigen::Vector3d>>& output, double rate);

// Share of the power that is above a frequency [Hz], of turns as above.
double powerShareAbove(const std::vector<std::vector<Eigen::Vector3d>>& turns, double rate,
                       double frequency);

// Turns of the held bones (kHeldBones) on the pelvis, frame by frame: the input of a retrofit.
std::vector<std::vector<Eigen::Vector3d>> heldTurns(const HeldMotion& held);

}  // namespace torso::tools
