// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The surface of solids as a mesh: their distance on a grid, its zero surface, thinned out.

#include "model/blend.h"
#include "model/tri_mesh.h"

namespace torso {

// Of the edges, which thinning leaves rough, by half a voxel or less.
enum class Finish {
  kPlain,    // as they are
  kEven,     // smoothed, which takes as much from their size
  kRounded,  // rounded off beforehand, by about a voxel
};

// The surface of the largest part of a solid, on a grid of nodes `voxel` apart (in the solid's unit
// of length); parts thinner than two voxels are lost. Closed, each edge between two faces; of about
// `max_faces` faces: thinning stops where it would spoil the shape. A symmetric solid is its own
// mirror image (y -> -y), and so will be the mesh.
TriMesh surface(const Blend& solid, double voxel, int max_faces, bool symmetric = false,
                Finish finish = Finish::kPlain);

}  // namespace torso
