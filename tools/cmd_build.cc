// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>
#include <string>

#include "tools/build_models.h"
#include "tools/commands.h"
#include "tools/paths.h"

namespace torso::tools {

void addBuild(CLI::App& app) {
  struct Options {
    std::string output, anatomy;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("build", "Write the MJCF models and bone meshes from the anatomy tables.");
  command->footer(
      "Writes torso.xml (torso, head, pelvis, shoulder girdle), human.xml (whole body on a "
      "floor),\n"
      "human_fixed.xml (the same with one rigid torso), scene.xml (floor and light) and "
      "assets/.\n\n"
      "Examples:\n"
      "  torso build                           refresh the models that come with the project\n"
      "  torso build --anatomy mine -o models  from tables of your own");
  command->add_option("-o,--output", options->output, "Folder to write into (default: mjcf)");
  command->add_option("--anatomy", options->anatomy, "Folder of the anatomy tables");
  command->callback([options] {
    if (options->output.empty()) options->output = mjcfFolder();
    if (options->anatomy.empty()) options->anatomy = anatomyFolder();
    const Anatomy anatomy = Anatomy::load(options->anatomy);
    buildModels(anatomy, options->output);
    fmt::print("{}: torso.xml, human.xml, human_fixed.xml, scene.xml, torso_held.xml, assets/\n",
               options->output);
    fmt::print("body of {:.2f} m and {:.1f} kg\n", anatomy.stature(), anatomy.mass());
  });
}

}  // namespace torso::tools
