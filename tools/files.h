// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace torso::tools {

// All bytes of a file. Throws Error that names it.
std::string readFile(const std::string& path);

// Write a whole file: first beside it under a temporary name, then renamed, so that an interrupted
// command never leaves half a file. Throws Error that names the file.
void writeFile(const std::string& path, std::string_view content);

// The same for files that belong together, by path; their folders are made. Either all are new or
// all are as they were, unless the machine stops between two renames: Ctrl-C waits until they are
// done. Throws Error.
void writeFiles(const std::map<std::string, std::string>& files);

// Throws Error if no folder of that path is there or can be made to write into; makes none. Saves a
// long command its work.
void checkFolder(const std::string& path);

// Make a folder and those above it; nothing happens if it is there. Throws Error.
void makeFolder(const std::string& path);

}  // namespace torso::tools
