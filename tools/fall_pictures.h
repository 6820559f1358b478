// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tools/fall.h"

namespace torso::tools {

struct FallenModel {
  std::string name, path;  // "detailed", file
  ModelPtr m;
  std::vector<Fall> falls;  // by seed
};

// PNG of the first falls: one row for each model, one column for each of the times, which the falls
// have frames of. Throws Error.
std::string fallStrip(std::vector<FallenModel>& models, const std::vector<double>& times);

// Writes into `folder`, which is made if need be, the course of the first falls: fall.csv, fall.gp
// and, if there is gnuplot, fall.png. limit: of the head's acceleration [g], for the plot. Throws
// Error.
void writeFallPlot(const std::string& folder, const std::vector<FallenModel>& models, double limit);

}  // namespace torso::tools
