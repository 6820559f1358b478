// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "model/anatomy.h"

namespace torso::tools {

// Writes torso.xml, human.xml, human_fixed.xml, scene.xml, torso_held.xml and the bone meshes in
// assets/ into `folder`, which is made if it is missing. Each file is written whole or not at all.
// Throws Error.
void buildModels(const Anatomy& anatomy, const std::string& folder);

}  // namespace torso::tools
