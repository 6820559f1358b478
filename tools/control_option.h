// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>

#include "tools/error.h"
#include "tools/rollout.h"

namespace torso::tools {

// Add --control, --amplitude and --drop to a command.
inline void addControlOptions(CLI::App& command, RolloutOptions& options) {
  static const std::map<std::string, Control> kControls = {
      {"hold", Control::kHold}, {"random", Control::kRandom}, {"none", Control::kNone}};
  command
      .add_option("--control", options.control,
                  "hold: the controls of the start; random: new targets every 0.1 s; none: "
                  "actuators off")
      ->transform(CLI::CheckedTransformer(kControls).description(""))
      ->type_name("hold|random|none")
      ->default_str("hold");
  command
      .add_option("--amplitude", options.amplitude,
                  "Of random controls, share of each actuator's range")
      ->check(CLI::Range(0., 1.))
      ->capture_default_str();
  command.add_option("--drop", options.lift, "Start with every free body so much higher [m]")
      ->capture_default_str();
}

// Throws Error "<path>: ..." if --drop asks for what the model cannot do.
inline void checkDrop(const mjModel* m, const RolloutOptions& options, const std::string& path) {
  if (options.lift == 0) return;
  for (int j = 0; j < m->njnt; j++) {
    if (m->jnt_type[j] == mjJNT_FREE) return;
  }
  throw Error(path + ": no free body that --drop could lift; leave the option out");
}

}  // namespace torso::tools
