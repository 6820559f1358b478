// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "model/anatomy.h"
#include "tools/bone_pieces.h"

namespace torso::tools {

// A bone so many times as large or small as the tables' is in the wrong unit, or another bone.
constexpr double kLargestRatio = 1.75;

// Of a body that boneMesh makes: its bone without cartilage, in the standing body [m].
TriMesh boneOnly(const Anatomy& anatomy, const std::string& body);

// Lays bones that are no vertebrae over the generated ones, in their own size: pelvis by the S1
// endplate, rib cage by its joints with the spine, skull and limbs by the joint that they hang on.
// The tables take over their size, and what hangs on them moves along (both sides alike). A missing
// one of a pair becomes the mirror image of the other; an imported skull keeps the generated C1 and
// C2. pieces: in metres; axes: from the files' axes to the standing ones, if known. Adds to meshes,
// by body in the standing body, and to remarks. Throws Error that names the file.
void placeBones(const std::vector<BonePiece>& pieces, const std::optional<Eigen::Matrix3d>& axes,
                Anatomy* anatomy, std::map<std::string, TriMesh>* meshes,
                std::vector<std::string>* remarks);

}  // namespace torso::tools
