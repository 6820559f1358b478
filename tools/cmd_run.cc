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
#include "tools/mujoco_support.h"
#include "tools/picture_options.h"
#include "tools/progress_bar.h"
#include "tools/renderer.h"
#include "tools/rollout.h"
#include "tools/vtu.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string model, keyframe, csv, render_folder, vtu_folder;
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

Json place(const mjModel* m, const Extreme& extreme, const char* kind) {
  if (extreme.id < 0) return nullptr;
  std::string name;
  if (std::string(kind) == "tendon") {
    name = nameOf(m, mjOBJ_TENDON, extreme.id);
  } else {
    const char* found = std::string(kind) == "disc" ? torso_discName(m, extreme.id)
                                                    : torso_facetName(m, extreme.id);
    name = found ? found : std::to_string(extreme.id);
  }
  return {{kind, name}, {"seed", extreme.seed}, {"time_s", extreme.time}};
}

Json describe(const mjModel* m, const RolloutSummary& s, int discs) {
  const Extremes& e = s.extremes;
  Json json = {{"runs", s.runs.size()},
               {"failed", s.failed},
               {"warnings", s.warnings},
               {"dof", m->nv},
               {"timestep_s", m->opt.timestep},
               {"simulated_s", s.simulated_seconds},
               {"core_s", s.core_seconds},
               {"wall_s", s.wall_seconds},
               {"real_time_factor", s.core_seconds > 0 ? s.simulated_seconds / s.core_seconds : 0},
               {"active_constraints", s.mean_constraints},
               {"bodies_on_floor", s.has_floor ? Json(s.on_floor) : Json()},
               {"state_hash", fmt::format("{:016x}", s.state_hash)}};
  if (discs > 0) {
    json["max_disc_pressure_mpa"] = 1e-6 * e.max_disc_pressure.value;
    json["min_disc_thickness_ratio"] = e.min_disc_thickness.value;
    json["max_disc_thickness_ratio"] = e.max_disc_thickness.value;
    json["min_disc_column_ratio"] = e.min_disc_column.value;
    json["max_disc_column_ratio"] = e.max_disc_column.value;
  } else {
    for (const char* key :
         {"max_disc_pressure_mpa", "min_disc_thickness_ratio", "max_disc_thickness_ratio",
          "min_disc_column_ratio", "max_disc_column_ratio"}) {
      json[key] = nullptr;
    }
  }
  json["ligament_violation_mm"] = {{"p99", 1e3 * s.ligament_violation.quantile(0.99)},
                                   {"max", 1e3 * e.max_ligament_violation.value}};
  json["facet_violation_mm"] = {{"p99", 1e3 * s.facet_violation.quantile(0.99)},
                                {"max", 1e3 * e.max_facet_violation.value}};
  json["at"] = {{"max_disc_pressure", place(m, e.max_disc_pressure, "disc")},
                {"min_disc_thickness", place(m, e.min_disc_thickness, "disc")},
                {"max_disc_thickness", place(m, e.max_disc_thickness, "disc")},
                {"min_disc_column", place(m, e.min_disc_column, "disc")},
                {"max_disc_column", place(m, e.max_disc_column, "disc")},
                {"max_ligament_violation", place(m, e.max_ligament_violation, "tendon")},
                {"max_facet_violation", place(m, e.max_facet_violation, "facet")}};
  Json failures = Json::array();
  for (const RunResult& run : s.runs) {
    if (!run.failure.empty()) failures.push_back({{"seed", run.seed}, {"what", run.failure}});
  }
  json["failures"] = failures;
  return json;
}

// "0.93 (L4/L5, seed 3, 0.82 s)"
std::string withPlace(double value, const Json& where) {
  if (where.is_null()) return fmt::format("{:.3g}", value);
  return fmt::format("{:.3g} ({}, seed {}, {:.2f} s)", value, where.begin()->get<std::string>(),
                     where["seed"].dump(), where["time_s"].get<double>());
}

void print(const Json& j) {
  const auto row = [](const char* name, const std::string& value) {
    fmt::print("{:<36}{}\n", name, value);
  };
  const auto number = [&](const char* key) { return j[key].get<double>(); };
  row("runs", fmt::format("{} ({} failed, {} warnings)", j["runs"].dump(), j["failed"].dump(),
                          j["warnings"].dump()));
  row("degrees of freedom", j["dof"].dump());
  row("active constraints, mean", fmt::format("{:.0f}", number("active_constraints")));
  row("simulated time [s]", fmt::format("{:.2f}, in steps of {:.3g} ms", number("simulated_s"),
                                        1e3 * number("timestep_s")));
  row("wall time [s]", fmt::format("{:.2f}", number("wall_s")));
  row("real-time factor of one core", fmt::format("{:.2f}", number("real_time_factor")));
  if (!j["bodies_on_floor"].is_null()) {
    row("runs that end on the floor", fmt::format("{:.0f} %", 100 * number("bodies_on_floor")));
  }
  if (j["max_disc_pressure_mpa"].is_null()) return;
  const Json& at = j["at"];
  row("largest disc pressure [MPa]",
      withPlace(number("max_disc_pressure_mpa"), at["max_disc_pressure"]));
  row("disc thickness to that at rest, min",
      withPlace(number("min_disc_thickness_ratio"), at["min_disc_thickness"]));
  row("  max", withPlace(number("max_disc_thickness_ratio"), at["max_disc_thickness"]));
  row("  min of any column", withPlace(number("min_disc_column_ratio"), at["min_disc_column"]));
  row("  max of any column", withPlace(number("max_disc_column_ratio"), at["max_disc_column"]));
  row("ligament violation [mm], 99 %",
      fmt::format("{:.3g}", j["ligament_violation_mm"]["p99"].get<double>()));
  row("  max", withPlace(j["ligament_violation_mm"]["max"], at["max_ligament_violation"]));
  row("facet violation [mm], 99 %",
      fmt::format("{:.3g}", j["facet_violation_mm"]["p99"].get<double>()));
  row("  max", withPlace(j["facet_violation_mm"]["max"], at["max_facet_violation"]));
}

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

void run(Options options) {
  const ModelPtr m = loadModel(options.model);
  const torsoInfo torso = torsoOf(m.get(), options.model);
  options.rollout.keyframe = keyframeId(m.get(), options.keyframe, options.model);
  checkDrop(m.get(), options.rollout, options.model);
  configureModel(m.get(), options.rollout, options.timestep);
  options.picture.visibility();  // refuse a wrong layer before the work, not after it

  std::vector<Observer> observers;
  TimeSeries series(m.get(), torso.ndisc);
  if (!options.csv.empty()) {
    observers.push_back(
        {options.rate, [&](const mjModel* model, const mjData* d) { series.add(model, d); }});
  }
  std::vector<DataPtr> frames;
  if (!options.render_folder.empty()) {
    observers.push_back({(options.frames - 1) / options.rollout.seconds,
                         [&](const mjModel* model, const mjData* d) {
                           frames.push_back(makeData(model));
                           mj_copyData(frames.back().get(), model, d);
                         }});
  }

  std::optional<VtuFolder> vtu_folder;
  if (!options.vtu_folder.empty()) {
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

  std::signal(SIGINT, onInterrupt);
  const RolloutSummary summary = [&] {
    const ProgressBar bar;
    const auto show = [&bar](double share) { bar.show(share); };
    return rollout(m.get(), options.rollout, observers, show, interrupted);
  }();

  const Json json = describe(m.get(), summary, torso.ndisc);
  if (options.json) {
    std::cout << json.dump(2) << std::endl;
  } else {
    print(json);
    std::fflush(stdout);
  }
  if (!options.csv.empty()) writeFile(options.csv, series.text());
  if (vtu_folder) vtu_folder->finish();
  if (!options.render_folder.empty()) writeFrames(options, m.get(), frames);

  if (interrupted) {
    std::cerr << fmt::format("torso run: interrupted after {} of {} runs\n", summary.runs.size(),
                             options.rollout.seeds);
    std::signal(SIGINT, SIG_DFL);
    std::raise(SIGINT);
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
      "Examples:\n"
      "  torso run mjcf/human.xml\n"
      "  torso run mjcf/human.xml --drop 2 --control random --seeds 100 --threads 2 --json\n"
      "  torso run mjcf/human.xml --drop 0.5 --csv drop.csv --render frames\n"
      "  torso run mjcf/torso_held.xml --seconds 1 --vtu discs --vtu-at 0,1");
  command->add_option("MODEL", options->model, "MJCF, URDF or MJB file")->required();
  command->add_option("--seconds", rollout.seconds, "Simulated time of each run [s]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--seeds", rollout.seeds, "Number of runs; only random controls differ")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--seed0", rollout.seed0, "The first seed")->capture_default_str();
  command->add_option("--threads", rollout.threads, "Number of threads")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  addControlOptions(*command, rollout);
  command->add_option("--keyframe", options->keyframe, "Start there: name or number");
  command->add_option("--timestep", options->timestep, "Instead of the model's [s]")
      ->check(CLI::PositiveNumber);
  command->add_flag("--json", options->json, "Print JSON");
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
