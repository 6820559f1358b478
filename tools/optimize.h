// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// A task, a model and MPPI: the loop of `torso optimize` and the folder that it leaves.

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "tools/mppi.h"
#include "tools/processes.h"
#include "tools/task.h"

namespace torso::tools {

struct OptimizeOptions {
  Task task;           // as read, with the command's options in place
  std::string model;   // path
  std::string output;  // folder
  MppiOptions mppi;
  int iterations = 30;
  int threads = 1;
  bool resume = false;  // from the folder's checkpoint, if it has one
};

struct OptimizeWatch {
  // An iteration that is done, now or, with resume, before. A row of the cost table: the keys of
  // MppiReport; the last, of what the last update led to, has the costs alone.
  std::function<void(const nlohmann::ordered_json& row)> iteration;
  std::function<void(double)> progress;  // share of the iterations that are done
  const int* cancel;                     // nonzero: stop, and throw ControlProblem::Cancelled
};

// Writes into the output folder, after each iteration
//   checkpoint.json  from which it can go on
//   cost.csv         a row for each iteration
// and at the end
//   best.motion      the trajectory of the least cost (tools/motion_file.h), a frame for each step
//   controls.csv     the controls of each of its steps
//   result.json      what is returned, without times
//   spine.csv        the spine along it (spineCsv), if the model has the bones
//   scene.xml        the model, if the task adds a scene to it
// Each file is there whole or not at all, and is the same, byte for byte, for any number of threads
// and processes and after any interruption. The processes share the samples; all return the same,
// the first one writes. Throws Error.
nlohmann::ordered_json optimize(const OptimizeOptions& options, const Processes& processes,
                                const OptimizeWatch& watch);

}  // namespace torso::tools
