// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "model/anatomy.h"
#include "tools/part_map.h"
#include "tools/processes.h"

namespace torso::tools {

struct RetrofitBatch {
  std::vector<std::string> inputs;  // files and folders; of these all clips, at any depth
  std::string output;               // folder
  PartMap map;
  double rate = 0;  // [Hz]; 0: as readPersons
  int jobs = 1;     // threads, a clip each
  bool again = false, temporary = false;
};

// The clips of `inputs`, those of a folder in alphabetical order, each file once.
std::vector<std::string> clipFiles(const std::vector<std::string>& inputs);

// All of a batch, into its folder: retrofitPerson for each, <file's name>.json with what that
// returned as the mark that the file is done, and summary.csv, which is complete after every file.
// A file is skipped if its mark and what it speaks of are newer and were made with the same
// settings. Returns the rows of all files in their order, also of those skipped; of what fails:
// {"file", "error"}. Ctrl-C stops it between two frames, with whole files, as the signal would.
// Several processes share the files among them, each n-th one; the first writes summary.csv and
// returns the rows of all, the others their own.
// Throws Error if the folder cannot be written.
nlohmann::ordered_json retrofitBatch(const Anatomy& tables, const RetrofitBatch& batch,
                                     const Processes& processes);

}  // namespace torso::tools
