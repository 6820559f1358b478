// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Foreign surfaces made into closed ones: soups of triangles joined, small defects mended.

#include <string>

#include "model/tri_mesh.h"

namespace torso {

struct MeshRepair {
  int dropped_faces = 0;  // degenerate, there twice, or sticking out of the surface
  int flipped_faces = 0;  // turned to agree with their neighbours
  int cut_edges = 0;      // of more than two faces, where sheets touch: taken apart
  int filled_holes = 0;
  std::string text() const;  // "2 holes filled, 3 faces dropped"; "" if the mesh was in order
};

// A closed surface, each edge between two faces that agree on its sides, made from one that is
// nearly so: equal vertices are joined (closer than 1e-6 of the mesh's size), a few stray faces
// dropped (up to 2 % of the area), holes filled whose border is no longer than 0.8 of the mesh's
// size (diagonal of its bounding box), each part turned to look outwards. Throws std::runtime_error
// that names the place [units of the mesh] of what cannot be mended so: a larger hole, or an edge
// of more than two faces where the surface branches; and if the whole mesh is inside out.
TriMesh repaired(const TriMesh& mesh, MeshRepair* done);

// Volume enclosed by a closed surface; negative if its faces look inwards.
double signedVolume(const TriMesh& mesh);
Eigen::AlignedBox3d bounds(const TriMesh& mesh);

}  // namespace torso
