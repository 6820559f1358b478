// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// How a follower load changes the stiffness and the range of motion of the lumbar spine, beside
// what is published.

#include <array>
#include <string>
#include <vector>

#include "model/anatomy.h"
#include "model/skeleton.h"

namespace torso::tools {

// Ratios to the same without the load: flexion with extension, lateral bending, axial rotation.
struct PreloadEffect {
  double follower;                  // [N]
  std::array<double, 3> stiffness;  // L1 against the sacrum at 1 Nm
  std::array<double, 3> motion;     // at the laboratory's moment
};

// The sacrum to T12 with pure moments, the load on the path on which it turns nothing
// (WholeSpine::stand). Throws Error.
std::vector<PreloadEffect> measurePreload(const Anatomy& anatomy, const Skeleton& skeleton,
                                          const std::vector<double>& followers);

// torso rom --preload: measures, and prints a table or JSON.
void romPreload(bool json);

}  // namespace torso::tools
