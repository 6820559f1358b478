// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "model/anatomy.h"

namespace torso::tools {

// One convex shape of a body's outline, skin included, for contacts. In the standing body [m].
struct CollisionShape {
  enum class Type { kCapsule, kEllipsoid };
  Type type;
  std::string kind;          // default class: "spine", "trunk" or "limb"
  Eigen::Vector3d from, to;  // capsule: end points; ellipsoid: centre in `from`
  Eigen::Vector3d size;      // capsule: radius in x; ellipsoid: half axes
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // ellipsoid: columns are its axes
};

// Shapes of one body (names as in model/body.h). Flesh thickness is assumed.
std::vector<CollisionShape> collisionShapes(const Anatomy& anatomy, const std::string& body);

}  // namespace torso::tools
