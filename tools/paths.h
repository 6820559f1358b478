// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace torso::tools {

// Where the project's files are, for the running executable: in the install tree
// (<prefix>/bin/torso, <prefix>/share/mujoco_torso) or, if there is none, in the source tree that
// the executable was built from.

// Folder of the anatomy tables. Throws Error if it is in neither place, as do the other two.
std::string anatomyFolder();
// Folder of the MJCF models that come with the project.
std::string mjcfFolder();
// Folder of the tasks of `torso optimize`.
std::string tasksFolder();
// The plugin library that this process runs with, as an absolute path. Throws Error.
std::string pluginLibrary();

}  // namespace torso::tools
