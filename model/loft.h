// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Closed shells from which the bones are put together: tubes along curves, ellipsoids, bent plates
// and lofts. All lengths in metres; faces look outwards; no shell has an open edge.

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "model/tri_mesh.h"

namespace torso {

using Ring = std::vector<Eigen::Vector3d>;  // a closed curve, without its first point again

// One cross section of a tube: an ellipse with half axes `side` and `up` [m]. `up_direction` need
// not be unit nor normal to the tube; zero means the tube's own.
struct Section {
  Eigen::Vector3d centre;
  double side, up;
  Eigen::Vector3d up_direction = Eigen::Vector3d::Zero();
};

struct TubeStyle {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  // never along the tube
  int sides = 14;                                 // points around
  int steps = 4;                                  // rings from one section to the next
  double squareness = 2;                          // exponent of the section: 2 ellipse, 4 boxy
  double cap = 0.7;  // length of the rounded ends over the smaller half axis; they reach beyond
                     // the first and the last centre by this length
};

// Through the centres of at least two sections, smoothly.
TriMesh tube(const std::vector<Section>& sections, const TubeStyle& style = {});

// The same rings closed by a fan at both ends. Rings of equal size, counter-clockwise seen from the
// last.
TriMesh loft(const std::vector<Ring>& rings);

// Half axes along the columns of `axes`; exponent 2 an ellipsoid, more is boxier.
TriMesh ellipsoid(const Eigen::Vector3d& centre, const Eigen::Vector3d& half_axes,
                  const Eigen::Matrix3d& axes = Eigen::Matrix3d::Identity(), int sides = 12,
                  double squareness = 2);

// Star-shaped surface about `centre`: radius(direction) > 0 [m]. Vertices at the given longitudes
// (in [0, 2 pi), from x to y) and latitudes (in (-pi/2, pi/2)), both ascending [rad], and at the
// poles.
TriMesh star(const Eigen::Vector3d& centre,
             const std::function<double(const Eigen::Vector3d& direction)>& radius,
             const std::vector<double>& longitudes, const std::vector<double>& latitudes);

// Plate about the surface grid[i][j] (at least 2 x 2, all rows of equal length) with the thickness
// of the same place [m] and a rounded edge.
TriMesh plate(const std::vector<std::vector<Eigen::Vector3d>>& grid,
              const std::vector<std::vector<double>>& thickness);

// Turns a closed profile (x distance from the axis > 0, y along it; counter-clockwise) about an
// axis: a ring, or a bowl.
TriMesh revolve(const std::vector<Eigen::Vector2d>& profile, const Eigen::Vector3d& origin,
                const Eigen::Vector3d& axis, int sides);

// Outline of an endplate of a vertebra, and of a disc: `points` points about the origin at equal
// distances, counter-clockwise from the foremost (x forward, y left) [m]. Convex in front,
// flattened behind, of area 0.82 x width x depth; widest 60 % of the depth from the front. As
// makeDiscMesh.
std::vector<Eigen::Vector2d> endplateOutline(double width, double depth, int points);

// Catmull-Rom curve through at least two points, t in [0, points - 1].
Eigen::Vector3d curveAt(const std::vector<Eigen::Vector3d>& points, double t);

// Enclosed volume [m^3], > 0 if the faces look outwards.
double volume(const TriMesh& mesh);

}  // namespace torso
