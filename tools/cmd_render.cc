// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/commands.h"
#include "tools/control_option.h"
#include "tools/error.h"
#include "tools/files.h"
#include "tools/motion_file.h"
#include "tools/mujoco_support.h"
#include "tools/picture_options.h"
#include "tools/progress_bar.h"
#include "tools/renderer.h"
#include "tools/rollout.h"
#include "tools/video.h"

namespace torso::tools {
namespace {

struct Options {
  std::string model, output, keyframe, motion, video;
  double rate = 30;  // of a film [1/s]
  RolloutOptions rollout;
  std::uint64_t seed = 0;
  PictureOptions picture;
};

// Puts d to a time of a motion.
void place(const mjModel* m, mjData* d, const Motion& motion, double time) {
  motionAt(m, motion, time, d->qpos);
  mju_zero(d->qvel, m->nv);
  d->time = time;
  mj_forward(m, d);
}

// A motion from one place that has all of it in the picture.
void film(const Options& options, mjModel* m, const Motion& motion) {
  const int frames = static_cast<int>(duration(motion) * options.rate) + 1;
  std::vector<DataPtr> states;
  std::vector<const mjData*> seen;
  constexpr int kSamples = 20;  // enough to find the camera's place
  for (int i = 0; i < kSamples; i++) {
    states.push_back(makeData(m));
    place(m, states.back().get(), motion, duration(motion) * i / (kSamples - 1));
    seen.push_back(states.back().get());
  }
  const mjvOption visibility = options.picture.visibility();
  const mjvCamera camera = options.picture.view(m, seen, options.model);
  const auto discs = options.picture.discColours(m, seen, options.model);
  Renderer renderer(m, options.picture.width, options.picture.height, discs);
  Video video(options.video, options.rate, options.picture.width, options.picture.height);
  const ProgressBar bar;
  for (int frame = 0; frame < frames; frame++) {
    place(m, states[0].get(), motion, frame / options.rate);
    video.add(renderer.pixels(states[0].get(), visibility, camera));
    bar.show(static_cast<double>(frame + 1) / frames);
  }
  const std::string path = video.finish();
  if (path != options.video) {
    std::cerr << fmt::format("torso render: there is no ffmpeg; wrote pictures to {}\n", path);
  }
}

void render(Options options) {
  if (options.output.empty() == options.video.empty()) {
    throw CLI::ValidationError("-o, --video",
                               "give either -o PICTURE.png or, with --motion, --video FILM.mp4");
  }
  const ModelPtr m = loadModel(options.model);
  torsoOf(m.get(), options.model);
  std::optional<Motion> motion;
  if (!options.motion.empty()) {
    motion = motionOf(m.get(), readMotion(options.motion), options.motion);
  }
  if (!options.video.empty()) return film(options, m.get(), *motion);
  options.rollout.keyframe = keyframeId(m.get(), options.keyframe, options.model);
  checkDrop(m.get(), options.rollout, options.model);
  configureModel(m.get(), options.rollout, 0);
  const mjvOption visibility = options.picture.visibility();

  const DataPtr d = makeData(m.get());
  startRun(m.get(), d.get(), options.rollout);
  if (motion) {
    place(m.get(), d.get(), *motion, options.rollout.seconds);
  } else if (options.rollout.seconds > 0) {
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
      "  torso render mjcf/torso_held.xml -o load.png --time 1 --discs mises --azimuth 90\n"
      "  torso render mjcf/human.xml --motion out/walk.motion -o step.png --time 0.4\n"
      "  torso render mjcf/human.xml --motion out/walk.motion --video walk.mp4 --rate 30");
  command->add_option("MODEL", options->model, "MJCF, URDF or MJB file")->required();
  command->add_option("-o,--output", options->output, "PNG file to write");
  command
      ->add_option("--time", options->rollout.seconds,
                   "Simulate so long before, or show that time of the motion [s]")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  auto* motion = command->add_option("--motion", options->motion,
                                     "Show this motion (CSV or binary, as torso retrofit writes "
                                     "them) instead of simulating");
  auto* video = command
                    ->add_option("--video", options->video,
                                 "MP4 or GIF file of the motion (with ffmpeg; else pictures in a "
                                 "folder of that name)")
                    ->needs(motion);
  command->add_option("--rate", options->rate, "Pictures per second of the film")
      ->check(CLI::Range(0.1, 1000.0))
      ->needs(video)
      ->capture_default_str();
  command->add_option("--keyframe", options->keyframe, "Start there: name or number");
  addControlOptions(*command, options->rollout);
  command->add_option("--seed", options->seed, "Of the random controls")->capture_default_str();
  options->picture.addTo(*command);
  command->callback([options] { render(*options); });
}

}  // namespace torso::tools
