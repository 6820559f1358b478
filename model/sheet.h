// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Flat bones: solids about a bent sheet within an outline.

#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "model/solid.h"

namespace torso {

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
Solid sheetSolid(const Sheet& sheet);

// Smooth closed curve through `points`, `steps` points from one to the next (Catmull-Rom).
std::vector<Eigen::Vector2d> smoothOutline(const std::vector<Eigen::Vector2d>& points,
                                           int steps = 6);

}  // namespace torso
