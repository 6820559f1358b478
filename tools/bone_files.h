// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "model/anatomy.h"
#include "model/skeleton.h"

namespace torso::tools {

// The bone files of `torso build`, by name within its assets/ folder: "L4.stl", ... [m], each in
// the frame of its body.
std::map<std::string, std::string> boneFiles(const Anatomy& anatomy, const Skeleton& skeleton);

// "pelvis", "L5" .. "C3", "head".
std::vector<std::string> spineBodies(const Anatomy& anatomy);

// The bones of these bodies from such a folder, which holds them at the tables' size, scaled to the
// anatomy's. Quicker than to make them. Throws Error that names the file.
Skeleton readSkeleton(const Anatomy& anatomy, const std::string& folder,
                      const std::vector<std::string>& bodies);

}  // namespace torso::tools
