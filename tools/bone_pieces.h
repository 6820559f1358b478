// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "model/tri_mesh.h"

namespace torso::tools {

// A bone, or a part of one, as a file has it.
struct BonePiece {
  std::string where;  // for messages: file, and object if the file holds several
  std::string body;   // "L5" .. "C3", "pelvis", "ribcage", "head", "left_scapula", ...; a limb or
                      // shoulder bone of unknown side has none before it
  std::string side;   // "left", "right" or ""; of a piece of the pelvis, too
  TriMesh mesh;       // closed, faces outwards; in the file's unit
};

// Matrix from file axes to standing axes (x forward, y left, z up) of letters that say where the
// file's x, y and z point: A or P, L or R, S or I. Throws Error.
Eigen::Matrix3d axesMatrix(const std::string& letters);
// The letters of a matrix whose entries are 0, 1 and -1.
std::string axesLetters(const Eigen::Matrix3d& matrix);

// All bones of the mesh files in a folder, named by file and object name or by `map` (JSON:
// {"file.obj": "L3", "file.obj/object": "left_scapula", "spine.obj": ["L5", "L4"], "disc.obj": ""};
// a list names the parts of one object, vertebrae from below), repaired and split. axes: turn all
// meshes by it, if given. Remarks gets a line for what was skipped or repaired. Throws Error.
std::vector<BonePiece> readBonePieces(const std::string& folder, const std::string& map,
                                      const std::optional<Eigen::Matrix3d>& axes,
                                      std::vector<std::string>* remarks);

}  // namespace torso::tools
