// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
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
#include "tools/paths.h"
#include "tools/picture_options.h"
#include "tools/progress_bar.h"
#include "tools/renderer.h"
#include "tools/rollout.h"
#include "tools/stick_figure.h"
#include "tools/video.h"

namespace torso::tools {
namespace {

struct Options {
  std::string model, output, keyframe, motion, clip, video;
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

// The clip that a motion was made of, beside the body.
class Beside {
 public:
  explicit Beside(const Options& options) {
    if (options.clip.empty()) return;
    const std::string name = std::filesystem::path(options.motion).stem().string();
    figure_.emplace(Anatomy::load(anatomyFolder()), options.clip, name);
    // To the right in the picture, an arm's length or two away.
    constexpr double kAside = 1.2;  // [m]
    const double azimuth = options.picture.azimuth.value_or(kDefaultAzimuth) * mjPI / 180;
    shift_ = kAside * Eigen::Vector3d(std::sin(azimuth), -std::cos(azimuth), 0);
  }
  std::vector<Stick> at(double time) const {
    return figure_ ? figure_->at(time, shift_) : std::vector<Stick>();
  }

 private:
  std::optional<StickFigure> figure_;
  Eigen::Vector3d shift_ = Eigen::Vector3d::Zero();
};

// A motion from one place that has all of it in the picture.
void film(const Options& options, mjModel* m, const Motion& motion) {
  const int frames = static_cast<int>(duration(motion) * options.rate) + 1;
  const Beside beside(options);
  std::vector<DataPtr> states;
  std::vector<const mjData*> seen;
  std::vector<Stick> sticks;
  constexpr int kSamples = 20;  // enough to find the camera's place
  for (int i = 0; i < kSamples; i++) {
    const double time = duration(motion) * i / (kSamples - 1);
    states.push_back(makeData(m));
    place(m, states.back().get(), motion, time);
    seen.push_back(states.back().get());
    for (const Stick& stick : beside.at(time)) sticks.push_back(stick);
  }
  const mjvOption visibility = options.picture.visibility();
  const mjvCamera camera = options.picture.view(m, seen, options.model, sticks);
  const auto discs = options.picture.discColours(m, seen, options.model);
  Renderer renderer(m, options.picture.width, options.picture.height, discs);
  Video video(options.video, options.rate, options.picture.width, options.picture.height);
  const ProgressBar bar;
  for (int frame = 0; frame < frames; frame++) {
    const double time = frame / options.rate;
    place(m, states[0].get(), motion, time);
    video.add(renderer.pixels(states[0].get(), visibility, camera, beside.at(time)));
    bar.show(static_cast<double>(frame + 1) / frames);
  }
  const std::string path = video.finish();
  if (path != options.video) {
    std::cerr << fmt::format(
        "torso render: there is no ffmpeg (Debian: apt install ffmpeg); wrote pictures to {}\n",
        path);
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
  const std::vector<Stick> sticks = Beside(options).at(options.rollout.seconds);
  const mjvCamera camera = options.picture.view(m.get(), {d.get()}, options.model, sticks);
  const auto discs = options.picture.discColours(m.get(), {d.get()}, options.model);
  Renderer renderer(m.get(), options.picture.width, options.picture.height, discs);
  writeFile(options.output, renderer.png(d.get(), visibility, camera, sticks));
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
      "  torso render out/walk.xml --motion out/walk.bin -o step.png --time 0.4\n"
      "  torso render out/walk.xml --motion out/walk.bin --clip walk.bvh --video walk.mp4");
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
  command
      ->add_option("--clip", options->clip,
                   "Draw the skeleton of this motion capture file beside it, from which torso "
                   "retrofit made the motion")
      ->needs(motion);
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
