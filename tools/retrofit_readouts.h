// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tools/motion_file.h"
#include "tools/retrofit.h"

namespace torso::tools {

// The motion of a result, to be written with motionCsv, motionBinary, motionBvh or motionGlb.
Motion motionOf(const RetrofitModels& models, const RetrofitResult& result);

// A row for each frame: time; how far held bones are off and how far the torso is from equilibrium;
// per level the turn of the upper bone, the disc's pressure and the largest tension of its
// ligaments; the turns of the scapulae on the rib cage; the force of each facet; flags. Units are
// in the names of the columns.
std::string readoutsCsv(const RetrofitModels& models, const RetrofitResult& result);

}  // namespace torso::tools
