// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Closed shells from rings of points: tubes along curves and lofts. All lengths in metres; faces
// look outwards; no shell has an open edge.

#include <Eigen/Core>
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
