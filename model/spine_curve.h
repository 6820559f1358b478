// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The spine of a person as a stack of bodies and discs; part of personalAnatomy.

#include <string>
#include <vector>

#include "model/anatomy.h"
#include "model/person.h"

namespace torso {

// Pointers to the vertebrae, L5 .. C2.
template <typename AnatomyOrConst>
auto levels(AnatomyOrConst& a) {
  std::vector<decltype(&a.c2)> out;
  for (auto& v : a.vertebrae) out.push_back(&v);
  out.push_back(&a.c2);
  return out;
}

// Of the two endplates [m].
inline double meanDepth(const Vertebra& v) {
  return (v.upper_endplate_depth + v.lower_endplate_depth) / 2;
}

// Gives the spine the person's lordosis and kyphosis, where they are told, on that sacral slope
// [rad], and a level gaze, as personalAnatomy says. Changes vertebrae, discs and the sacral slope;
// what goes with the spine stays behind. Throws std::invalid_argument if a disc would have no
// height left at its front or back.
void bendSpine(Anatomy& anatomy, const Person& person, double sacral_slope);

}  // namespace torso
