// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "model/anatomy.h"
#include "tools/own_bones.h"

namespace torso::tools {

// Writes torso.xml, human.xml, human_fixed.xml, scene.xml, torso_held.xml and the bone meshes in
// assets/ into `folder`, which is made if it is missing. Each file is written whole or not at all.
// `own` bones, if given, take the place of the generated ones. Throws Error.
void buildModels(const Anatomy& anatomy, const std::string& folder, const OwnBones* own = nullptr);

}  // namespace torso::tools
