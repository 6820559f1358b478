// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// One smooth surface about overlapping shells or solids: their distance field on a grid, and its
// zero surface, thinned out.

#include <Eigen/Geometry>
#include <functional>

#include "model/solid.h"
#include "model/tri_mesh.h"

namespace torso {

struct FuseOptions {
  double voxel = 1.2e-3;   // distance of the grid's nodes [m]
  double fillet = 3e-3;    // size of the fillets between shells [m], 0 for none
  int max_faces = 1500;    // of the result, roughly: thinning stops where it would spoil the shape
  int smoothing = 1;       // passes that round edges off, by about a voxel each
  bool symmetric = false;  // the shells are mirror symmetric (y -> -y), and so shall be the result
};

// `shells`: closed, faces outwards, each connected; they may overlap. The result is closed, each
// edge between two faces. Shapes thinner than about two voxels are lost. What lies in `cut`, shells
// as well, is taken away.
TriMesh fuse(const TriMesh& shells, const FuseOptions& options, const TriMesh& cut = {});

// The zero surface of a signed distance, negative inside, that lies in `box`; made as that of fuse.
// options.fillet and options.symmetric do not matter.
TriMesh surfaceOf(const std::function<double(const Eigen::Vector3d&)>& distance,
                  const Eigen::AlignedBox3d& box, const FuseOptions& options);

// The surface of a solid (of its largest part), on a grid of nodes `voxel` apart [m]; max_faces and
// symmetric as above. Shapes thinner than two voxels are lost. Thinning leaves edges rough, half a
// millimetre or less; `even` smooths them, and takes as much from their size.
TriMesh surface(const Blend& solid, double voxel, int max_faces, bool symmetric, bool even = false);

// The connected parts of a mesh.
std::vector<TriMesh> connectedParts(const TriMesh& mesh);

}  // namespace torso
