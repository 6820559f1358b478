// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// One smooth surface about overlapping shells: the union of their distance fields on a grid, with
// fillets, and its zero surface, thinned out.

#include <Eigen/Geometry>
#include <functional>

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

// Edge collapses by quadric error (Garland and Heckbert 1997, SIGGRAPH) until max_faces are left.
// Vertices on an open edge must lie in the plane y = 0 and stay in it.
TriMesh simplified(const TriMesh& mesh, int max_faces);

// The connected parts of a mesh.
std::vector<TriMesh> connectedParts(const TriMesh& mesh);

}  // namespace torso
