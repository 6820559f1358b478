// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "model/anatomy.h"

namespace torso {

// A table of the form of range_of_motion.csv, by disc. Throws std::runtime_error that names the
// file, line and column at fault.
std::map<std::string, RangeOfMotion> readRangeOfMotion(const std::string& path);

}  // namespace torso
