// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/tri_mesh.h"

namespace torso {

// Edge collapses by quadric error (Garland and Heckbert 1997, SIGGRAPH) until max_faces are left.
// Vertices on an open edge must lie in the plane y = 0 and stay in it.
TriMesh simplified(const TriMesh& mesh, int max_faces);

}  // namespace torso
