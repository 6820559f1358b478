// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// What `torso run` says.

#include <mujoco/mujoco.h>

#include <nlohmann/json.hpp>

#include "tools/rollout.h"

namespace torso::tools {

// The members that `torso run --json` prints; discs: how many the model has.
nlohmann::ordered_json describeRuns(const mjModel* m, const RolloutSummary& summary, int discs);

// The same as text on stdout.
void printRuns(const nlohmann::ordered_json& description);

}  // namespace torso::tools
