// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tools/commands.h"
#include "tools/control_option.h"
#include "tools/error.h"
#include "tools/files.h"
#include "tools/motion_file.h"
#include "tools/mujoco_support.h"
#include "tools/picture_options.h"
#include "tools/processes.h"
#include "tools/progress_bar.h"
#include "tools/recorded_rollout.h"
#include "tools/renderer.h"
#include "tools/rollout.h"
#include "tools/run_record.h"
#include "tools/run_report.h"
#include "tools/vtu.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string model, keyframe, motion, csv, render_folder, vtu_folder, results;
  bool resume = false;
  RolloutOptions rollout;
  double timestep = 0;  // [s], 0: the model's
  double rate = 60;     // of the time series [1/s]
  int frames = 8;
  double vtu_interval = 0.1;      // [s]
  std::vector<double> vtu_times;  // [s], instead
  PictureOptions picture;
  bool json = false;
};

// Ctrl-C ends the rollout after the step at hand; a second one ends the program.
std::atomic<bool> interrupted = false;

void onInterrupt(int) {
  interrupted = true;
  std::signal(SIGINT, SIG_DFL);
}

// The time series of a run as CSV.
class TimeSeries {
 public:
  TimeSeries(const mjModel* m, int discs) : discs_(discs) {
    text_ = "time_s,com_x_m,com_y_m,com_z_m,kinetic_energy_j,contacts,constraints";
    for (int i = 0; i < discs; i++) {
      text_ += fmt::format(",pressure_{}_mpa", torso_discName(m, i));
    }
    text_ += '\n';
  }

  void add(const mjModel* m, const mjData* d) {
    momentum_.resize(m->nv);
    mj_mulM(m, d, momentum_.data(), d->qvel);
    const mjtNum kinetic_energy = mju_dot(momentum_.data(), d->qvel, m->nv) / 2;
    const mjtNum* com = d->subtree_com;
    text_ += fmt::format("{:.6f},{:.6f},{:.6f},{:.6f},{:.6g},{},{}", d->time, com[0], com[1],
                         com[2], kinetic_energy, d->ncon, d->nefc);
    for (int i = 0; i < discs_; i++) {
      text_ += fmt::format(",{:.6g}", 1e-6 * torso_discPressure(m, d, i));
    }
    text_ += '\n';
  }

  const std::string& text() const { return text_; }

 private:
  int discs_;
  std::string text_;
  std::vector<mjtNum> momentum_;  // generalised
};

// The inside of the discs over a run: one file per instant as it comes, and at last what lists
// them.
class VtuFolder {
 public:
  VtuFolder(const std::string& folder, std::uint64_t seed) : folder_(folder), seed_(seed) {
    makeFolder(folder);
  }

  void add(const mjModel* m, const mjData* d) {
    const std::string name = fmt::format("seed{}_{:05}.vtu", seed_, files_.size());
    writeFile(folder_ + "/" + name, vtu(m, d));
    files_.push_back({d->time, name});
  }

  void finish() const { writeFile(fmt::format("{}/seed{}.pvd", folder_, seed_), pvd(files_)); }

 private:
  std::string folder_;
  std::uint64_t seed_;
  std::vector<std::pair<double, std::string>> files_;
};

// One camera for all frames, so that the motion shows.
void writeFrames(const Options& options, mjModel* m, const std::vector<DataPtr>& frames) {
  if (frames.empty()) return;
  makeFolder(options.render_folder);
  std::vector<const mjData*> states;
  for (const DataPtr& d : frames) states.push_back(d.get());
  const mjvCamera camera = options.picture.view(m, states, options.model);
  const mjvOption visibility = options.picture.visibility();
  const auto discs = options.picture.discColours(m, states, options.model);
  Renderer renderer(m, options.picture.width, options.picture.height, discs);
  for (const DataPtr& d : frames) {
    const std::string path = fmt::format("{}/seed{}_{:06.0f}ms.png", options.render_folder,
                                         options.rollout.seed0, 1000 * d->time);
    writeFile(path, renderer.png(d.get(), visibility, camera));
  }
}

// A motion in place of the simulation: positions and velocities are the motion's, forces those that
// the model has there.
void replayInstead(const mjModel* m, const std::string& path, RolloutOptions* rollout) {
  const auto motion = std::make_shared<const Motion>(motionOf(m, readMotion(path), path));
  rollout->seconds = std::max(duration(*motion), m->opt.timestep);
  rollout->control = Control::kNone;
  rollout->replay = [m, motion, before = std::vector<mjtNum>(m->nq)](mjData* d,
                                                                     double time) mutable {
    const double last = duration(*motion), step = m->opt.timestep;
    time = std::min(time, last);
    motionAt(m, *motion, time, d->qpos);
    motionAt(m, *motion, std::max(time - step, 0.0), before.data());
    mj_differentiatePos(m, d->qvel, step, before.data(), d->qpos);
  };
}

// The same bytes however the runs were spread: without the times they took.
std::string merged(const Json& settings, Json description) {
  for (const char* time : {"core_s", "wall_s", "real_time_factor"}) description.erase(time);
  return Json{{"settings", settings}, {"result", description}}.dump(2) + "\n";
}

void run(Options options) {
  const Processes processes;
  const bool leads = processes.rank() == 0;  // it prints, and watches seed0
  const ModelPtr m = loadModel(options.model);
  const torsoInfo torso = torsoOf(m.get(), options.model);
  options.rollout.keyframe = keyframeId(m.get(), options.keyframe, options.model);
  checkDrop(m.get(), options.rollout, options.model);
  if (!options.motion.empty()) replayInstead(m.get(), options.motion, &options.rollout);
  configureModel(m.get(), options.rollout, options.timestep);
  options.picture.visibility();  // refuse a wrong layer before the work, not after it

  std::vector<Observer> observers;
  TimeSeries series(m.get(), torso.ndisc);
  if (leads && !options.csv.empty()) {
    observers.push_back(
        {options.rate, [&](const mjModel* model, const mjData* d) { series.add(model, d); }});
  }
  std::vector<DataPtr> frames;
  if (leads && !options.render_folder.empty()) {
    observers.push_back({(options.frames - 1) / options.rollout.seconds,
                         [&](const mjModel* model, const mjData* d) {
                           frames.push_back(makeData(model));
                           mj_copyData(frames.back().get(), model, d);
                         }});
  }

  std::optional<VtuFolder> vtu_folder;
  if (leads && !options.vtu_folder.empty()) {
    if (torso.ndisc == 0) throw Error(options.model + ": the model has no discs to write");
    std::vector<double>& times = options.vtu_times;
    std::sort(times.begin(), times.end());
    times.erase(std::unique(times.begin(), times.end()), times.end());
    if (!times.empty() && times.back() > options.rollout.seconds) {
      throw Error(
          fmt::format("--vtu-at {}: the run ends at {} s", times.back(), options.rollout.seconds));
    }
    vtu_folder.emplace(options.vtu_folder, options.rollout.seed0);
    observers.push_back({1 / options.vtu_interval,
                         [&](const mjModel* model, const mjData* d) { vtu_folder->add(model, d); },
                         times});
  }

  std::optional<RunFolder> folder;
  Json settings;
  if (!options.results.empty() || processes.size() > 1) {
    settings = runSettings(m.get(), options.rollout);
    if (!options.motion.empty()) settings["motion"] = options.motion;
    if (!options.results.empty()) folder.emplace(options.results, settings, options.resume);
  }

  std::signal(SIGINT, onInterrupt);
  const std::optional<RolloutSummary> result = [&]() -> std::optional<RolloutSummary> {
    std::optional<ProgressBar> bar;
    if (leads) bar.emplace();
    const auto show = [&bar](double share) {
      if (bar) bar->show(share);
    };
    if (settings.is_null()) return rollout(m.get(), options.rollout, observers, show, interrupted);
    return recordedRollout(m.get(), options.rollout, settings, folder ? &*folder : nullptr,
                           processes, observers, show, interrupted);
  }();
  processes.leave();
  if (!result) return;
  const RolloutSummary& summary = *result;

  const Json json = describeRuns(m.get(), summary, torso.ndisc);
  if (options.json) {
    std::cout << json.dump(2) << std::endl;
  } else {
    printRuns(json);
    std::fflush(stdout);
  }
  const bool complete = static_cast<int>(summary.runs.size()) == options.rollout.seeds;
  if (folder && complete) folder->finish(merged(settings, json));
  if (!options.csv.empty()) writeFile(options.csv, series.text());
  if (vtu_folder) vtu_folder->finish();
  if (!options.render_folder.empty()) writeFrames(options, m.get(), frames);

  if (interrupted) {
    std::cerr << fmt::format("torso run: interrupted after {} of {} runs{}\n", summary.runs.size(),
                             options.rollout.seeds, folder ? "; --resume goes on" : "");
    std::signal(SIGINT, SIG_DFL);
    std::raise(SIGINT);
  }
  if (!complete) {
    throw Error(fmt::format("{} of {} runs were done, for another process was interrupted{}",
                            summary.runs.size(), options.rollout.seeds,
                            folder ? "; --resume goes on" : ""));
  }
  if (summary.failed) {
    const Json& first = json["failures"][0];
    throw Error(fmt::format("{}: {} of {} runs failed, the first with seed {}: {}", options.model,
                            summary.failed, summary.runs.size(), first["seed"].dump(),
                            first["what"].get<std::string>()));
  }
}

}  // namespace

void addRun(CLI::App& app) {
  auto options = std::make_shared<Options>();
  RolloutOptions& rollout = options->rollout;
  CLI::App* command =
      app.add_subcommand("run", "Simulate a model from many seeds, and say how its torso fared.");
  command->footer(
      "The result is the same, bit for bit, for any number of threads. A run fails if MuJoCo "
      "warns\n"
      "(a number that is not finite, a full contact table, ...); the exit status is then 1.\n\n"
      "real_time_factor        simulated time over the processor time of its thread in mj_step\n"
      "bodies_on_floor         share of the runs after which the centre of mass is below 0.6 of "
      "its\n"
      "                        standing height and slower than 1.5 m/s, and each free body is "
      "below\n"
      "                        its standing height but not below the floor\n"
      "ligament_violation_mm   length beyond the limit: 99th percentile over all steps and all\n"
      "                        ligament segments that are beyond it, and the largest\n"
      "facet_violation_mm      the same for the distance of facet points beyond the band\n"
      "..._thickness_ratio     distance of a disc's endplates over that at rest, mean of the "
      "disc;\n"
      "..._column_ratio        the same of its thinnest or thickest column of nodes\n\n"
      "Under mpirun (OpenMPI) the processes share the seeds, and the first one prints the result\n"
      "of all; with --results each keeps what it has done, in one folder or, where machines have\n"
      "none in common, each in its own. result.json holds what --json prints, without the times\n"
      "that it took: it is the same, byte for byte, for any number of processes and threads and\n"
      "after any interruption, on machines of one kind.\n\n"
      "Examples:\n"
      "  torso run mjcf/human.xml\n"
      "  torso run mjcf/human.xml --drop 2 --control random --seeds 100 --threads 2 --json\n"
      "  mpirun -n 4 torso run mjcf/human.xml --control random --seeds 1000 --results r --resume\n"
      "  torso run mjcf/human.xml --drop 0.5 --csv drop.csv --render frames\n"
      "  torso run mjcf/torso_held.xml --seconds 1 --vtu discs --vtu-at 0,1\n"
      "  torso run out/walk.xml --motion out/walk.bin --csv walk.csv --vtu discs");
  command->add_option("MODEL", options->model, "MJCF, URDF or MJB file")->required();
  auto* seconds =
      command->add_option("--seconds", rollout.seconds, "Simulated time of each run [s]")
          ->check(CLI::PositiveNumber)
          ->capture_default_str();
  auto* seeds =
      command->add_option("--seeds", rollout.seeds, "Number of runs; only random controls differ")
          ->check(CLI::PositiveNumber)
          ->capture_default_str();
  command->add_option("--seed0", rollout.seed0, "The first seed")->capture_default_str();
  command->add_option("--threads", rollout.threads, "Number of threads")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  addControlOptions(*command, rollout);
  auto* keyframe =
      command->add_option("--keyframe", options->keyframe, "Start there: name or number");
  command->add_option("--timestep", options->timestep, "Instead of the model's [s]")
      ->check(CLI::PositiveNumber);
  command->add_flag("--json", options->json, "Print JSON");
  auto* motion = command->add_option(
      "--motion", options->motion,
      "Instead of simulating play this motion (CSV or binary, as torso retrofit writes them): "
      "bones move as in it, and discs, ligaments and facets are measured");
  for (CLI::Option* other : {seconds, seeds, keyframe, command->get_option("--control"),
                             command->get_option("--drop")}) {
    motion->excludes(other);
  }
  auto* results = command->add_option(
      "--results", options->results,
      "Write the result of each seed into this folder as it is done, and at last result.json");
  command
      ->add_flag(
          "--resume", options->resume,
          "Run only seeds that have no result in that folder: after a kill, or for more seeds")
      ->needs(results);
  command->add_option("--csv", options->csv,
                      "Write the time series of the first seed: centre of mass, energy, disc "
                      "pressures");
  command->add_option("--rate", options->rate, "Rows of the time series per second")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--render", options->render_folder,
                      "Write pictures of the first seed to this folder");
  command->add_option("--frames", options->frames, "Number of pictures, from start to end")
      ->check(CLI::Range(2, 100000))
      ->capture_default_str();
  auto* vtu = command->add_option("--vtu", options->vtu_folder,
                                  "Write stress and fibre stretch inside the discs of the first "
                                  "seed to this folder, for ParaView");
  auto* interval = command->add_option("--vtu-every", options->vtu_interval, "Time between [s]")
                       ->check(CLI::PositiveNumber)
                       ->needs(vtu)
                       ->capture_default_str();
  command->add_option("--vtu-at", options->vtu_times, "Only at these times [s]")
      ->delimiter(',')
      ->check(CLI::NonNegativeNumber)
      ->needs(vtu)
      ->excludes(interval);
  options->picture.addTo(*command);
  command->callback([options] { run(*options); });
}

}  // namespace torso::tools
