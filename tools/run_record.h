// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Runs as text: the folder in which `torso run --results` keeps them, one file for each seed, so
// that it can go on after a kill, and messages between processes.

#include <cstdint>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "tools/rollout.h"

namespace torso::tools {

// One line of JSON. Every number comes back bit for bit.
std::string recordText(const RunResult& run, const Violations& violations);

// The way back; violations are added to *all. where: what an Error names.
RunResult parseRecord(const std::string& text, const std::string& where, Violations* all);

// Of a model as a binary file; the same in each process that loads it.
std::uint64_t modelHash(const mjModel* m);

// All that the results of a seed depend on, which is the seed apart: model, options, versions and
// the instruction set of the discs' solver. m: after configureModel.
nlohmann::ordered_json runSettings(const mjModel* m, const RolloutOptions& options);

// Throws Error "<where>: ..." that names the first setting that differs.
void checkSettings(const nlohmann::ordered_json& ours, const std::string& theirs,
                   const std::string& where);

// The folder. Files appear in it whole or not at all.
class RunFolder {
 public:
  // Throws Error if the folder holds results and resume is false, or if they are of other settings.
  RunFolder(const std::string& path, const nlohmann::ordered_json& settings, bool resume);

  // Make the folder, if it is not there, write its settings, and remove the result of fewer seeds.
  void open() const;
  // Write the result of all seeds, result.json.
  void finish(const std::string& text) const;
  // Seeds of first .. first + count - 1 that have a result.
  std::set<std::uint64_t> seeds(std::uint64_t first, int count) const;
  std::string file(std::uint64_t seed) const;  // its path
  void save(std::uint64_t seed, const std::string& text) const;
  std::string load(std::uint64_t seed) const;  // throws Error if it is damaged

 private:
  std::string path_, settings_, result_;  // the folder, its settings.json and result.json
  std::string text_;                      // of settings.json
};

}  // namespace torso::tools
