// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "model/anatomy.h"
#include "tools/rom_report.h"

namespace torso::tools {

// Writes into `folder`, which is made if need be: rom.csv (ours beside the published mean and
// range, by level), <region>_<motion>.csv (moment-angle curves), and rom.gp, which draws rom.png
// from them, as Lee et al. 2023 show theirs, and <region>_curves.png. Throws Error.
void writeRomPlots(const std::string& folder, const Anatomy& anatomy, const RomReport& report);

}  // namespace torso::tools
