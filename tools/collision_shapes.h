// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "model/anatomy.h"

namespace torso::tools {

// One capsule of a body's outline, skin included, for contacts (analytic, unlike ellipsoids and
// meshes, whose contacts would cost more than the torso). In the standing body [m].
struct CollisionShape {
  std::string kind;          // default class: "spine", "trunk" or "limb"
  Eigen::Vector3d from, to;  // end points of the axis
  double radius;
};

// Shapes of one body (names as in model/body.h). Flesh thickness is assumed.
std::vector<CollisionShape> collisionShapes(const Anatomy& anatomy, const std::string& body);

}  // namespace torso::tools
