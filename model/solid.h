// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Bones as solids: signed distances of simple shapes, united and taken away with fillets, and the
// surface of the result. In any unit of length.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <vector>

#include "model/tri_mesh.h"

namespace torso {

// Distance to the surface, negative inside, right near the surface and of the right order
// elsewhere; and a box about the shape.
struct Shape {
  std::function<double(const Eigen::Vector3d&)> distance;
  Eigen::AlignedBox3d box;
};

// Half axes along the columns of `axes`.
Shape ellipsoidShape(const Eigen::Vector3d& centre, const Eigen::Vector3d& half_axes,
                     const Eigen::Matrix3d& axes = Eigen::Matrix3d::Identity());

// A place on a sweep's curve and the half axes of the section there: `side` across the curve and
// the up direction, `up` across the curve.
struct SweepPoint {
  Eigen::Vector3d centre;
  double side, up;
};

struct SweepStyle {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  // need not be unit
  double squareness = 2;                          // exponent of the section: 2 ellipse, 4 boxy
  int steps = 5;                                  // straight pieces between two points
};

// Elliptic section moved along a smooth curve through at least two points; rounded ends that reach
// beyond it by the half axes.
Shape sweepShape(const std::vector<SweepPoint>& points, const SweepStyle& style = {});

// A sheet that is bent and of varying thickness: over the plane of `frame` (x, y) within a closed
// outline, counter-clockwise. `middle(x, y)` is the height of its middle surface above the plane,
// `half_thickness(x, y, inset)` > 0 where `inset` > 0 is the distance to the outline; both
// smooth.
struct Sheet {
  Eigen::Isometry3d frame;
  std::vector<Eigen::Vector2d> outline;
  std::function<double(double x, double y)> middle;
  std::function<double(double x, double y, double inset)> half_thickness;
  double max_height, max_half_thickness;  // bounds of |middle| and half_thickness, for the box
};
Shape sheetShape(const Sheet& sheet);

Shape mirrored(const Shape& shape);  // y -> -y

// Smooth closed curve through `points`, `steps` points from one to the next (Catmull-Rom).
std::vector<Eigen::Vector2d> smoothOutline(const std::vector<Eigen::Vector2d>& points,
                                           int steps = 6);

class Solid {
 public:
  // Unites with a shape, or takes its inside away; `fillet` rounds the seam, 0 for none.
  void add(const Shape& shape, double fillet);
  void cut(const Shape& shape, double fillet);
  // The same with a shape and its mirror image, y -> -y.
  void addPair(const Shape& left, double fillet);
  void cutPair(const Shape& left, double fillet);

  double distance(const Eigen::Vector3d& p) const;

  // The parts that matter for distances below `reach` in a region.
  Solid near(const Eigen::AlignedBox3d& region, double reach) const;

  // Closed surface, counter-clockwise seen from outside, thinned out to max_faces, roughly. Details
  // smaller than `voxel` are lost. `symmetric`: the solid is, so half of it is mirrored.
  TriMesh surface(double voxel, int max_faces, bool symmetric) const;

 private:
  struct Part {
    std::shared_ptr<const Shape> shape;
    bool cut;
    double fillet;
  };
  std::vector<Part> parts_;
};

}  // namespace torso
