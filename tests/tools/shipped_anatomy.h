// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/anatomy.h"
#include "tools/bone_files.h"

namespace torso::tools {

// The tables, and the bones of the spine as the models have them, read once.
inline const Anatomy& anatomy() {
  static const Anatomy a = Anatomy::load(TORSO_ANATOMY_DIR);
  return a;
}

inline const Skeleton& skeleton() {
  static const Skeleton s = readSkeleton(anatomy(), TORSO_MJCF "/assets", spineBodies(anatomy()));
  return s;
}

}  // namespace torso::tools
