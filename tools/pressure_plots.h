// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tools/pressure_study.h"

namespace torso::tools {

// Writes into `folder`, which is made if need be, pressure.csv and pressure.gp: the pressures of
// the nucleus of one disc, measured, with servos and with muscles, as bars. Throws Error.
void writePressurePlot(const std::string& folder, const std::string& disc,
                       const std::vector<ActivityLoads>& all);

// The body as it stands in its last activity, with its muscles, from the left and a little from
// the front: a PNG file. body: made with bones. Throws Error.
void writePosture(const std::string& path, PosedBody& body);

}  // namespace torso::tools
