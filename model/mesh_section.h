// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Cuts through a closed surface, and what a line or a point meets of it.

#include <cstddef>
#include <limits>
#include <vector>

#include "model/tri_mesh.h"

namespace torso {

// Closed outline of a cut, without the first point at its end. Counter-clockwise (seen against the
// cut's axis) about solid, clockwise about a hollow.
using Outline = std::vector<Eigen::Vector2d>;

// Outlines of the cut with the plane where coordinate `axis` (0 x, 1 y, 2 z) is `value`. The points
// hold the two other coordinates in cyclic order: (y, z), (z, x) or (x, y).
std::vector<Outline> section(const TriMesh& mesh, int axis, double value);

double signedArea(const Outline& outline);
Eigen::Vector2d centroid(const Outline& outline);
bool contains(const Outline& outline, const Eigen::Vector2d& point);

// Distance from `origin` along the unit vector `direction` to the surface; infinity if it is not
// met. Looks at every face: for many rays, MeshTree::castRay.
double rayLength(const TriMesh& mesh, const Eigen::Vector3d& origin,
                 const Eigen::Vector3d& direction);

// A surface as points.
struct SurfacePoint {
  Eigen::Vector3d position, normal;
  double area;
};

// Points no further than about `spacing` from each other, each for its share of the surface.
std::vector<SurfacePoint> surfacePoints(const TriMesh& mesh, double spacing);

// Which of the points, at least one, is nearest to p.
std::size_t nearestIndex(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& p);

}  // namespace torso
