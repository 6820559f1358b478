// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mujoco/mujoco.h>

#include <string>

#include "plugin/instance.h"

namespace torso::plugin {

// Instance of a model, built at the first call and shared by models of equal torso data; null if
// the model has no torso, or damaged data. O(1) and without lock or allocation after the first
// call; any thread may call it.
const Instance* findInstance(const mjModel* m);

// What is wrong with the model's torso data; null if nothing is, or if it has none.
const char* instanceFault(const mjModel* m);

// Forgets all instances; models that are used later get new ones. No other thread may be in a
// callback meanwhile.
void clearInstances();

}  // namespace torso::plugin
