// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/graft_map.h"

namespace torso::tools {

const MapParts& bodyMapParts() {
  static const MapParts parts = {
      {"pelvis", "waist", "chest", "neck", "head", "left_clavicle", "right_clavicle", "left_thigh",
       "right_thigh", "left_upper_arm", "right_upper_arm"},
      {"waist", "neck", "left_clavicle", "right_clavicle"},  // what is between two others
      {"head"}};
  return parts;
}

}  // namespace torso::tools
