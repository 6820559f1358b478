// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

namespace torso::tools {

// One subcommand each, in the file cmd_<name>.cc. A command writes data to stdout and messages to
// stderr, and throws Error if it cannot do what was asked.
void addAblate(CLI::App& app);
void addBench(CLI::App& app);
void addBones(CLI::App& app);
void addBuild(CLI::App& app);
void addCalibrateDiscs(CLI::App& app);
void addDiscs(CLI::App& app);
void addFall(CLI::App& app);
void addGraft(CLI::App& app);
void addIdentify(CLI::App& app);
void addImportBones(CLI::App& app);
void addInfo(CLI::App& app);
void addOptimize(CLI::App& app);
void addPressure(CLI::App& app);
void addRender(CLI::App& app);
void addRetrofit(CLI::App& app);
void addRom(CLI::App& app);
void addRun(CLI::App& app);
void addShoulder(CLI::App& app);
void addStats(CLI::App& app);
void addTimestep(CLI::App& app);
void addTruth(CLI::App& app);
void addValidate(CLI::App& app);
void addView(CLI::App& app);

}  // namespace torso::tools
