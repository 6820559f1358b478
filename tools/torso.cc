// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// The `torso` command: registers the subcommands and turns what they throw into one message and
// an exit status (0 done, 1 the command failed, 2 wrong usage).

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "plugin/mujoco_torso.h"
#include "tools/commands.h"
#include "tools/mujoco_support.h"

int main(int argc, char** argv) {
  using namespace torso::tools;

  installHandlers();
  CLI::App app("A detailed human torso for MuJoCo.", "torso");
  app.require_subcommand(1);
  app.set_version_flag("--version", [] {
    return fmt::format("torso {}, MuJoCo {}", torso_versionString(), mj_versionString());
  });
  addBuild(app);
  addIdentify(app);
  addImportBones(app);
  addInfo(app);
  addRom(app);
  addPressure(app);
  addRun(app);
  addShoulder(app);
  addView(app);
  addRender(app);
  addAblate(app);
  addRetrofit(app);
  addBench(app);
  addFall(app);
  addBones(app);
  addStats(app);
  addTimestep(app);
  addTruth(app);
  addValidate(app);
  addGraft(app);
  addOptimize(app);
  addDiscs(app);
  addCalibrateDiscs(app);

  int status = 0;
  std::string failure;
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    status = app.exit(e) == 0 ? 0 : 2;
  } catch (const std::exception& e) {
    failure = e.what();
    status = 1;
  }
  const auto parsed = app.get_subcommands();
  const std::string command = parsed.empty() ? "torso" : "torso " + parsed[0]->get_name();
  const std::vector<std::string> warnings = takeWarnings();
  constexpr std::size_t kShown = 3;
  for (std::size_t i = 0; i < warnings.size() && i < kShown; i++) {
    std::cerr << command << ": warning: " << warnings[i] << '\n';
  }
  if (warnings.size() > kShown) {
    std::cerr << command << ": warning: and " << warnings.size() - kShown << " more\n";
  }
  if (!failure.empty()) std::cerr << command << ": " << failure << '\n';
  return status;
}
