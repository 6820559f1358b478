// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Files of the Visualization Toolkit (ParaView, PyVista, meshio): what goes on inside the discs.

#include <mujoco/mujoco.h>

#include <string>
#include <utility>
#include <vector>

namespace torso::tools {

// All discs of the state d, for which mj_forward was called, as one unstructured grid (XML, .vtu):
// tetrahedra in the world frame [m] with
//   point data  displacement  [m] from the rest shape as it lies on the lower bone, world frame
//   cell data   stress        [Pa] Cauchy, world frame, 9 components
//               pressure      [Pa] -trace / 3 of it
//               von_mises     [Pa]
//               fibre_stretch of the two fibre families, 1 in the nucleus
//               region        0 nucleus, 1 annulus
//               disc          index; a comment at the head of the file has the names
// Throws Error if the plugin refuses.
std::string vtu(const mjModel* m, const mjData* d);

// Collection (.pvd) of such files, each with its time [s], given relative to the collection.
std::string pvd(const std::vector<std::pair<double, std::string>>& files);

}  // namespace torso::tools
