// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace torso::tools {

// Runs a gnuplot script that lies in `folder`, in that folder. Throws Error; returns false if there
// is no gnuplot on this machine.
bool runGnuplot(const std::string& folder, const std::string& script);

}  // namespace torso::tools
