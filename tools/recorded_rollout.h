// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "tools/processes.h"
#include "tools/rollout.h"
#include "tools/run_record.h"

namespace torso::tools {

// rollout() by all processes together, each of which takes its share of the seeds that have no
// result yet in the folder of any of them (null: no folder). The summary, on process 0 only, is
// that of one process that runs all seeds, but for the times it took. The run of seed0, if there
// are observers, is done by process 0 in any case. Throws Error, also if the processes' settings
// differ (machines of different kinds).
std::optional<RolloutSummary> recordedRollout(const mjModel* m, RolloutOptions options,
                                              const nlohmann::ordered_json& settings,
                                              const RunFolder* folder, const Processes& processes,
                                              const std::vector<Observer>& observers,
                                              const std::function<void(double)>& progress,
                                              const std::atomic<bool>& stop);

}  // namespace torso::tools
