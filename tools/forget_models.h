// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "plugin/mujoco_torso.h"

namespace torso::tools {

// Frees what the plugin keeps of each body it has seen, some 10 MB, whether the model is still
// there or not. No other thread may use a model meanwhile.
inline void forgetModels() {
  torso_uninstall();
  torso_install();
}

}  // namespace torso::tools
