// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace torso::tools {

// MJCF of a model with the sections of another file (a task's scene) added to its own: one file
// that includes no others, to be kept in `folder` (file names in it are relative to that). Throws
// Error that names the file at fault.
std::string sceneMjcf(const std::string& model, const std::string& scene,
                      const std::string& folder);

}  // namespace torso::tools
