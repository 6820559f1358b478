// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "model/anatomy.h"
#include "model/disc.h"
#include "model/mesh_checks.h"
#include "model/skeleton.h"

namespace torso {

constexpr double kDiscReach = 2.5e-3;  // how far a face may be from the bone, tables' size [m]

// Moves the faces of a disc of makeDiscMesh onto the bones, each node to a tenth of `reach` [m]
// from the nearest place of the surface, or out of the bone along the disc's axis, if that is
// within `reach`, and what lies between in proportion. Topology and mirror symmetry stay. frame: of
// the disc; lower, upper: bones at rest, mirror symmetric; all in the standing body. Throws
// std::runtime_error if an element would turn inside out.
void fitDiscFaces(const Eigen::Isometry3d& frame, const MeshTree& lower, const MeshTree& upper,
                  double reach, DiscMesh* mesh);

// Mesh of a disc of the anatomy between these bones, as the models have it. The skeleton has the
// bones of both levels.
DiscMesh fittedDiscMesh(const Anatomy& anatomy, const Skeleton& skeleton, const Disc& disc);

}  // namespace torso
