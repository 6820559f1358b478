// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mujoco/mujoco.h>

#include "plugin/instance.h"

namespace torso::plugin {

// Force, moment, point (world frame) pressure and pressure of the nucleus of one disc at the last
// evaluation (kResult).
const mjtNum* discResult(const mjData* d, const Instance& instance, int disc);

// Tension of a limited tendon [N]; 0 while its limit is inactive.
mjtNum tendonTension(const mjData* d, int tendon);

// Sum of the contact forces of a facet's points on the bone that carries them, world frame [N].
void facetForce(const mjModel* m, const mjData* d, const Instance& instance, int facet,
                mjtNum force[3]);

// Fills the user sensors of the torso that need this stage.
void fillSensors(const mjModel* m, mjData* d, const Instance& instance, int stage);

}  // namespace torso::plugin
