// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <string>
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

// Turns of the held bones (kHeldBones) on the pelvis, frame by frame: the input of a retrofit. Sums
// of the turns from frame to frame, so that a bone that goes round does not jump.
std::vector<std::vector<Eigen::Vector3d>> heldTurns(const HeldMotion& held);

// Second differences over a frame of the turns between bones that those of the held bones explain,
// frame by frame [rad]. Moves of a held bone on the pelvis count as turns of a lever of 0.15 m, a
// clavicle's length and the height of the neck. A joint takes a share of what the bones do that
// move it, in the frame itself or next to it: three times the share that it has on the median over
// takes of all kinds, so that a joint's turn that goes beyond has another cause.
class ExplainedJumps {
 public:
  explicit ExplainedJumps(const HeldMotion& held);
  // joint: a level ("C7/T1"), "head", or a bone or joint of the girdle ("left_scapula").
  const std::vector<double>& of(const std::string& joint) const;
  // Largest second difference of a turn beyond what is explained [rad]. turns: (frames x names).
  double largestBeyond(const std::vector<std::string>& names,
                       const std::vector<std::vector<Eigen::Vector3d>>& turns) const;

 private:
  std::vector<double> trunk_, neck_;
  std::array<std::vector<double>, 2> girdle_;  // left, right
};

}  // namespace torso::tools
