// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace torso::tools {

// Write a whole file: first beside it under a temporary name, then renamed, so that an interrupted
// command never leaves half a file. Throws Error that names the file.
void writeFile(const std::string& path, std::string_view content);

// Make a folder and those above it; nothing happens if it is there. Throws Error.
void makeFolder(const std::string& path);

}  // namespace torso::tools
