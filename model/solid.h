// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Shapes by their signed distance, and their smooth union and difference, from which bones are
// modelled. Distances [m] are negative inside, right near the surface and otherwise not much too
// great.

#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "model/loft.h"
#include "model/tri_mesh.h"

namespace torso {

struct Solid {
  Eigen::AlignedBox3d box;  // around it
  std::function<double(const Eigen::Vector3d&)> distance;
};

Solid mirrored(const Solid& solid);  // y -> -y

// Half axes along the columns of `axes`; exponent 2 an ellipsoid, more is boxier.
Solid ellipsoidSolid(const Eigen::Vector3d& centre, const Eigen::Vector3d& half_axes,
                     const Eigen::Matrix3d& axes = Eigen::Matrix3d::Identity(),
                     double squareness = 2);

// Round bar along a smooth curve through the centres of at least two sections; of the style, `up`,
// `squareness` and `cap` count. As tube().
Solid rod(const std::vector<Section>& sections, const TubeStyle& style = {});

// Round bar of constant radius between two points.
Solid capsule(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius);

// Elliptic plate of the given width (along x) and height (along y) in z from -depth to 0, with
// edges rounded by `edge` [m].
Solid facePlate(const Eigen::Isometry3d& frame, double width, double height, double depth,
                double edge);

// Plate in the plane y = 0 of `frame`: `outline` in its x and z, counter-clockwise seen from -y
// (x to the right, z up), at least three corners; thickness [m] at a place of the plane; edges
// rounded by `edge`.
Solid outlinePlate(const Eigen::Isometry3d& frame, const std::vector<Eigen::Vector2d>& outline,
                   const std::function<double(const Eigen::Vector2d&)>& thickness, double edge);

// Solids united and carved away, one after the other, each with a fillet [m], 0 for none.
class Blend {
 public:
  void unite(const Solid& solid, double fillet);
  void carve(const Solid& solid, double fillet);
  void unitePair(const Solid& left, double fillet);  // and its mirror image
  void carvePair(const Solid& left, double fillet);

  const Eigen::AlignedBox3d& box() const { return box_; }
  // A lower bound of the distance where it is more than `far`.
  double distance(const Eigen::Vector3d& p, double far) const;

 private:
  struct Step {
    Solid solid;
    double fillet;
    bool carve;
  };
  std::vector<Step> steps_;
  Eigen::AlignedBox3d box_;
  double largest_fillet_ = 0;
};

}  // namespace torso
