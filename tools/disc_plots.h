// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "model/anatomy.h"
#include "tools/disc_report.h"

namespace torso::tools {

// Writes into `folder`, which is made if need be: for each region of the reports the curves as
// <region>_<quantity>.csv (a column of loads, one of displacements for each disc) and
// <region>_pressure.csv, and discs.gp, which draws <region>.png with the published tests of
// `anatomy` in them. Throws Error.
void writeDiscPlots(const std::string& folder, const Anatomy& anatomy,
                    const std::vector<DiscReport>& reports);

}  // namespace torso::tools
