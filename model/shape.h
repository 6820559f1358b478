// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Shapes as signed distances, from which bones are modelled: primitives, unions and cuts with
// fillets, and their surface as a mesh. Lengths in any one unit (the bones' tables: millimetres).

#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "model/loft.h"
#include "model/tri_mesh.h"

namespace torso {

struct Shape {
  // Distance to the surface, negative inside; exact enough near the surface for fillets.
  std::function<double(const Eigen::Vector3d&)> distance;
  Eigen::AlignedBox3d box;  // holds the shape
};

// Half axes along the columns of `axes`; exponent 2 an ellipsoid, more is boxier.
Shape ellipsoidShape(const Eigen::Vector3d& centre, const Eigen::Vector3d& half_axes,
                     const Eigen::Matrix3d& axes = Eigen::Matrix3d::Identity(),
                     double squareness = 2);
Shape ballShape(const Eigen::Vector3d& centre, double radius);
// Ring about `axis` (a unit vector), `thickness` is the radius of its round section.
Shape ringShape(const Eigen::Vector3d& centre, const Eigen::Vector3d& axis, double radius,
                double thickness);
// Cylinder of the given half length about `axis` (a unit vector), its edges rounded.
Shape rollShape(const Eigen::Vector3d& centre, const Eigen::Vector3d& axis, double radius,
                double half_length, double rounding);
// What lies behind a plane; `normal` is a unit vector and looks out. Its box is empty: to cut with.
Shape halfSpace(const Eigen::Vector3d& point, const Eigen::Vector3d& normal);
// As tube() of loft.h; `cap` is the length of the rounded ends over the smaller half axis.
Shape tubeShape(const std::vector<Section>& sections, const Eigen::Vector3d& up,
                double squareness = 2, double cap = 0.7);
// Plate about the Catmull-Rom surface through grid[i][j] (at least 2 x 2), of the thickness of the
// same place, with a rounded edge.
Shape plateShape(const std::vector<std::vector<Eigen::Vector3d>>& grid,
                 const std::vector<std::vector<double>>& thickness);
// Inside of a closed mesh.
Shape meshShape(const TriMesh& mesh);

// x -> X x; X may turn, move and scale alike in all directions.
Shape moved(const Shape& shape, const Eigen::Affine3d& X);
Shape grown(const Shape& shape, double by);  // thicker all around

// Shapes put together in order, each with the size of its fillet.
class Sculpture {
 public:
  Sculpture& add(const Shape& shape, double fillet = 0);
  Sculpture& cut(const Shape& shape, double fillet = 0);   // takes the shape away
  Sculpture& clip(const Shape& shape, double fillet = 0);  // keeps what lies in the shape
  Shape shape() const;

 private:
  enum class Action { kAdd, kCut, kClip };
  struct Step {
    Action action;
    Shape shape;
    double fillet;
  };
  std::vector<Step> steps_;
};

// Each cut back to where it is the nearest, and by half of `gap`: faces that fit each other, as in
// joints.
std::vector<Shape> keptApart(const std::vector<Shape>& shapes, double gap);

// The surface, closed, of about `max_faces` faces, made on a grid of the size `voxel` (details
// below two voxels are lost), then placed by x -> X x.
TriMesh surface(const Shape& shape, double voxel, int max_faces, const Eigen::Affine3d& X);

}  // namespace torso
