// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "model/anatomy.h"

namespace torso::tools {

// Writes torso.xml, human.xml, human_fixed.xml, scene.xml and the bone meshes in assets/ into
// `folder`, which is made if it is missing. Files are written beside their place and then moved, so
// an interrupted build leaves no half-written file. Throws std::runtime_error that names the file.
void buildModels(const Anatomy& anatomy, const std::string& folder);

}  // namespace torso::tools
