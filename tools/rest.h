// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mujoco/mujoco.h>

#include <functional>
#include <string>

namespace torso::tools {

struct Rest {
  double speed;    // no degree of freedom is faster after a tenth of a second [rad/s], [m/s]
  double longest;  // simulated time after which to give up waiting [s]
};

// Steps until the model is at rest. applyLoad is called before each step. Throws Error "<name>:
// ..." if MuJoCo warns.
void stepToRest(const mjModel* m, mjData* d, const Rest& rest, const std::string& name,
                const std::function<void()>& applyLoad);

}  // namespace torso::tools
