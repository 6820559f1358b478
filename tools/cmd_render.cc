// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <string>

#include "tools/commands.h"
#include "tools/control_option.h"
#include "tools/files.h"
#include "tools/mujoco_support.h"
#include "tools/picture_options.h"
#include "tools/renderer.h"
#include "tools/rollout.h"

namespace torso::tools {
namespace {

struct Options {
  std::string model, output, keyframe;
  RolloutOptions rollout;
  std::uint64_t seed = 0;
  PictureOptions picture;
};

void render(Options options) {
  const ModelPtr m = loadModel(options.model);
  torsoOf(m.get(), options.model);
  options.rollout.keyframe = keyframeId(m.get(), options.keyframe, options.model);
  checkDrop(m.get(), options.rollout, options.model);
  configureModel(m.get(), options.rollout, 0);
  const mjvOption visibility = options.picture.visibility();

  const DataPtr d = makeData(m.get());
  startRun(m.get(), d.get(), options.rollout);
  if (options.rollout.seconds > 0) {
    ControlSignal controls(m.get(), d.get(), options.rollout, options.seed);
    simulate(m.get(), d.get(), controls, options.rollout.seconds);
  }
  mj_forward(m.get(), d.get());
  const mjvCamera camera = options.picture.view(m.get(), {d.get()}, options.model);
  const auto discs = options.picture.discColours(m.get(), {d.get()}, options.model);
  Renderer renderer(m.get(), options.picture.width, options.picture.height, discs);
  writeFile(options.output, renderer.png(d.get(), visibility, camera));
}

}  // namespace

void addRender(CLI::App& app) {
  auto options = std::make_shared<Options>();
  options->rollout.seconds = 0;
  CLI::App* command = app.add_subcommand("render", "A picture of a model; no display needed.");
  command->footer(
      "Examples:\n"
      "  torso render mjcf/human.xml -o human.png\n"
      "  torso render mjcf/torso.xml -o spine.png --layers bones,discs --azimuth 90\n"
      "  torso render mjcf/human.xml -o fallen.png --time 2 --drop 0.5 --control random\n"
      "  torso render mjcf/torso_held.xml -o load.png --time 1 --discs mises --azimuth 90");
  command->add_option("MODEL", options->model, "MJCF, URDF or MJB file")->required();
  command->add_option("-o,--output", options->output, "PNG file to write")->required();
  command->add_option("--time", options->rollout.seconds, "Simulate so long before [s]")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--keyframe", options->keyframe, "Start there: name or number");
  addControlOptions(*command, options->rollout);
  command->add_option("--seed", options->seed, "Of the random controls")->capture_default_str();
  options->picture.addTo(*command);
  command->callback([options] { render(*options); });
}

}  // namespace torso::tools
