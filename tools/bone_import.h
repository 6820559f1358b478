// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "model/anatomy.h"
#include "tools/own_bones.h"

namespace torso::tools {

struct ImportOptions {
  std::string folder;     // of mesh files (mesh_file.h)
  std::string map;        // JSON, which file is which bone; "" for none
  std::string landmarks;  // landmark_file.h; "" for none
  std::string unit;       // "mm", "cm", "m"; "" to guess
  std::string axes;    // where x, y and z of the files point: letters of A P, L R, S I; "" to guess
  double stature = 0;  // [m]; 0: after the vertebrae's size
  double mass = 0;     // [kg]; 0: after the stature, at the tables' body mass index
};

struct ImportedTorso {
  Anatomy anatomy;
  OwnBones own;
  std::vector<std::string> imported;  // bodies with meshes of their own
  std::vector<std::string> remarks;   // what was guessed, repaired, assumed: a line each
};

// Makes the tables and bones of a person from meshes of bones. Throws Error that names the file and
// how to mend it; nothing is written.
ImportedTorso importBones(const Anatomy& tables, const ImportOptions& options);

}  // namespace torso::tools
