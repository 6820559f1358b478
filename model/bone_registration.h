// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// A bone that is no vertebra, laid over the generated one of the same name.

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "model/anatomy.h"
#include "model/tri_mesh.h"

namespace torso {

struct Registration {
  Eigen::Matrix3d rotation;  // reference = scale * rotation * mesh + translation
  double scale;
  Eigen::Vector3d translation;
  double misfit;  // mean distance between the surfaces, over the reference's size
};

// The 24 right-handed turns of the coordinate axes onto each other.
std::vector<Eigen::Matrix3d> axisTurns();

// Similarity that lays `mesh` over `reference`, by iterated closest points from each start; the
// best. starts: rotations that nearly do, not empty.
Registration registerBone(const TriMesh& mesh, const TriMesh& reference,
                          const std::vector<Eigen::Matrix3d>& starts);

// Makes a body of the tables `ratio` times as large about the joint that it hangs on; what hangs on
// it moves along. Names as in body.h without a side: "pelvis", "ribcage", "head", "clavicle", ...
// Throws std::invalid_argument for another.
void resizeBody(const std::string& body, double ratio, Anatomy* anatomy);

// Point about which resizeBody scales.
Eigen::Vector3d bodyAnchor(const Anatomy& anatomy, const std::string& body);

}  // namespace torso
