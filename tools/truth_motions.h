// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// What the servos do in the motions of retrofit_truth.h.

#include <string>
#include <vector>

namespace torso::tools {

// A group of servos that is led to a share of its range: positive of the upper limit, negative of
// the lower one. Patterns are the start and the end of a servo's name.
struct TruthLead {
  std::string begin, end;
  double share;
  double from = 0.3, to = 1.4;  // [s] the movement there; it comes back in the same time
};

struct TruthMotion {
  std::string name;
  std::vector<TruthLead> leads;
  double pelvis_pitch[2] = {0, 0};  // at rest and at the end of the movement [deg], back is down
  double seconds = 3.4, back = 1.8;
};

// One of truthMotions(), or "random N" for a number N. Throws Error for any other name.
TruthMotion truthMotion(const std::string& name);

}  // namespace torso::tools
