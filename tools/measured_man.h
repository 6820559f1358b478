// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The man whose disc pressures were measured.

#include "model/anatomy.h"

namespace torso::tools {

// Of his disc L4/L5 [m^2]: Wilke et al. 2001, Clin Biomech 16 Suppl 1:S111-S126. His mass [kg]:
// Wilke et al. 1999, Spine 24:755-762.
constexpr double kSubjectsArea = 1800e-6, kSubjectsMass = 70;

// Within the outline of a disc [m^2].
double outlineArea(const DiscShape& disc);

// The tables' body with his mass and with lumbar discs (L5/S1 .. T12/L1) wider and deeper by one
// factor, so that L4/L5 has his area. Heights, material and bones stay, so that the discs stand out
// by 4 mm at the sides; so does the stature of 1.70 m, for his is recalled as 1.68 and as 1.74 m.
// tables: as Anatomy::load gives them.
Anatomy measuredMan(const Anatomy& tables);

}  // namespace torso::tools
