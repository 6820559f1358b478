// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "model/anatomy.h"
#include "model/skeleton.h"

namespace torso {

// One ligament across one gap: a straight line that goes slack below max_length and holds at it.
struct LigamentSegment {
  std::string name;                          // ligament and gap, "ALL_mid_L4/L5"
  std::string ligament;                      // "ALL_mid"
  std::string lower, upper;                  // levels: "S1", "L5" .. "C3"
  Eigen::Vector3d lower_point, upper_point;  // at rest in the standing body [m]
  double max_length;                         // [m]
};

// The 20 ligaments across the 22 gaps S1-L5 .. C4-C3, gap by gap from below. Their points are
// estimated from the tables, a few millimetres off the bones' surfaces.
std::vector<LigamentSegment> makeLigaments(const Anatomy& anatomy);

// The same on the surfaces of the bones, where the skeleton has both.
std::vector<LigamentSegment> makeLigaments(const Anatomy& anatomy, const Skeleton& skeleton);

}  // namespace torso
