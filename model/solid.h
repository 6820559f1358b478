// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Solids by their signed distance, from which bones are modelled (see blend.h). Lengths in any one
// unit: metres or, in the tables of most bones, millimetres.

#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "model/loft.h"
#include "model/tri_mesh.h"

namespace torso {

struct Solid {
  Eigen::AlignedBox3d box;  // around it
  // Negative inside, right near the surface and otherwise not much too great.
  std::function<double(const Eigen::Vector3d&)> distance;
};

Solid mirrored(const Solid& solid);                         // y -> -y
Solid moved(const Solid& solid, const Eigen::Affine3d& X);  // x -> X x; X may scale, all axes alike
Solid grown(const Solid& solid, double by);                 // thicker all around
// Each solid cut back to where it is the nearest, and by half of `gap`: faces that fit each other,
// as in joints.
std::vector<Solid> keptApart(const std::vector<Solid>& solids, double gap);

// Half axes along the columns of `axes`; exponent 2 an ellipsoid, more is boxier.
Solid ellipsoidSolid(const Eigen::Vector3d& centre, const Eigen::Vector3d& half_axes,
                     const Eigen::Matrix3d& axes = Eigen::Matrix3d::Identity(),
                     double squareness = 2);

Solid ballSolid(const Eigen::Vector3d& centre, double radius);

// Ring about `axis` (unit); its round section has the radius `thickness`.
Solid torus(const Eigen::Vector3d& centre, const Eigen::Vector3d& axis, double radius,
            double thickness);

// About `axis` (unit), its edges rounded by `edge`.
Solid cylinder(const Eigen::Vector3d& centre, const Eigen::Vector3d& axis, double radius,
               double half_length, double edge);

// What lies behind a plane; `normal` (unit) looks out. Unbounded: to carve or clip with.
Solid halfSpace(const Eigen::Vector3d& point, const Eigen::Vector3d& normal);

// Round bar along a smooth curve through the centres of at least two sections; of the style, `up`,
// `squareness` and `cap` count. As tube().
Solid rod(const std::vector<Section>& sections, const TubeStyle& style = {});

// The same as a chain of pieces, each with round ends: fuller where the bar is short for its girth
// or bends sharply. Girths run smoothly from one section to the next, too.
Solid stoutRod(const std::vector<Section>& sections, const Eigen::Vector3d& up,
               double squareness = 2, double cap = 0.7);

// Round bar of constant radius between two points.
Solid capsule(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius);

// Elliptic plate of the given width (along x) and height (along y) in z from -depth to 0, with
// edges rounded by `edge`.
Solid facePlate(const Eigen::Isometry3d& frame, double width, double height, double depth,
                double edge);

// Plate in the plane y = 0 of `frame`: `outline` in its x and z, counter-clockwise seen from -y
// (x to the right, z up), at least three corners; thickness at a place of the plane; edges
// rounded by `edge`.
Solid outlinePlate(const Eigen::Isometry3d& frame, const std::vector<Eigen::Vector2d>& outline,
                   const std::function<double(const Eigen::Vector2d&)>& thickness, double edge);

// Plate about the Catmull-Rom surface through grid[i][j] (at least 2 x 2, all rows of equal
// length), of the thickness of the same place, with a round edge.
Solid bentPlate(const std::vector<std::vector<Eigen::Vector3d>>& grid,
                const std::vector<std::vector<double>>& thickness);

// Inside of a closed mesh. Throws std::invalid_argument as MeshTree does.
Solid meshSolid(const TriMesh& mesh);

}  // namespace torso
