// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace torso::tools {

// Runs a gnuplot script that lies in `folder`, in that folder. Where there is no gnuplot it says so
// on stderr, for `torso <command>`. Throws Error if gnuplot fails.
void runGnuplot(const std::string& command, const std::string& folder, const std::string& script);

// The panel of a figure of levels: a plot command that draws human data in red, their range as a
// band and their mean as a line, and ours in blue.
struct LevelPanel {
  std::string table;                   // CSV file, a row for each level, whose name is column 1
  int ours, mean, low, high;           // columns
  std::string our_title, human_title;  // of ours; of the humans', before "range" and "mean"
};
std::string plotLevels(const LevelPanel& panel);

}  // namespace torso::tools
