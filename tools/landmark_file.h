// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "model/vertebra_landmarks.h"

namespace torso::tools {

// Landmarks by level, in the unit and axes of the mesh files.
//
// JSON: {"L3": {"spinous_tip": [x, y, z],
//               "upper_endplate": {"centre": [x, y, z], "normal": [x, y, z], "width": 42,
//                                  "height": 33}}}
// CSV: level,landmark,x,y,z,normal_x,normal_y,normal_z,width,height; all after z may be empty.
// Names of landmarks: landmarkNames(). Throws Error that names the file and what is wrong in it.
std::map<std::string, GivenLandmarks> readLandmarkFile(const std::string& path);

}  // namespace torso::tools
