// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

namespace torso::tools {

// Pictures of the bones of human.xml and torso_held.xml in `models`, by file name, as PNG: the
// whole skeleton, three vertebrae, the lumbar spine with discs, ligaments and facets, the shoulder
// girdle and the skull. Each shows its views side by side, the bones in the pose of the model.
// Throws Error if a model cannot be loaded, lacks one of the meshes or there is nothing to draw
// with.
std::map<std::string, std::string> drawBones(const std::string& models);

}  // namespace torso::tools
