// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/optimize.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <map>
#include <optional>

#include "model/disc_batch.h"
#include "tools/control_problem.h"
#include "tools/error.h"
#include "tools/files.h"
#include "tools/json_file.h"
#include "tools/mujoco_support.h"
#include "tools/random.h"
#include "tools/run_record.h"
#include "tools/spine_motion.h"
#include "tools/task_scene.h"

namespace torso::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr char kFormat[] = "torso optimize 2";

double processSeconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// JSON has no infinity; null stands for it.
double costOf(const Json& json) { return json.is_null() ? INFINITY : json.get<double>(); }

// Of what a task file says, however it is laid out.
std::uint64_t taskHash(const std::string& path) {
  std::uint64_t hash = 0;
  for (const char c : nlohmann::json::parse(readFile(path)).dump()) {
    hash = mixBits(hash ^ static_cast<unsigned char>(c));
  }
  return hash;
}

Json settingsOf(const mjModel* m, const OptimizeOptions& o) {
  return {{"torso", torso_versionString()},
          {"mujoco", mj_versionString()},
          {"instruction_set", DiscBatch::instructionSet()},
          {"model", fmt::format("{:016x}", modelHash(m))},
          {"task", fmt::format("{} {:016x}", o.task.name, taskHash(o.task.path))},
          {"horizon_s", o.task.horizon},
          {"timestep_s", o.task.timestep},
          {"knot_interval_s", o.task.knot_interval},
          {"samples", o.mppi.samples},
          {"seed", o.mppi.seed},
          {"temperature", o.mppi.temperature},
          {"absolute_temperature", o.mppi.absolute_temperature},
          {"noise", o.mppi.noise},
          {"noise_decay", o.mppi.noise_decay}};
}

struct Checkpoint {
  MppiState state;
  Json rows = Json::array();
  double core_seconds = 0;  // of all processes
};

std::string checkpointText(const Checkpoint& c, const Json& settings) {
  return Json{{"format", kFormat},
              {"settings", settings},
              {"iteration", c.state.iteration},
              {"nominal", c.state.nominal},
              {"nominal_cost", c.state.nominal_cost},
              {"best", c.state.best},
              {"best_cost", c.state.best_cost},
              {"rows", c.rows},
              {"core_s", c.core_seconds}}
             .dump() +
         "\n";
}

Checkpoint parseCheckpoint(const std::string& text, const Json& settings, std::size_t size,
                           const std::string& path) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object() || json.value("format", "") != kFormat) {
    throw Error(path + ": not a checkpoint of torso optimize, or damaged; delete the folder");
  }
  if (!json.contains("settings")) throw Error(path + ": damaged: no settings; delete the folder");
  checkSettings(settings, json["settings"].dump(), path);
  try {
    Checkpoint c;
    c.state.iteration = json.at("iteration");
    c.state.nominal = json.at("nominal").get<std::vector<double>>();
    c.state.nominal_cost = costOf(json.at("nominal_cost"));
    c.state.best = json.at("best").get<std::vector<double>>();
    c.state.best_cost = json.at("best_cost");
    c.rows = json.at("rows");
    c.core_seconds = json.at("core_s");
    if (c.state.nominal.size() != size || (!c.state.best.empty() && c.state.best.size() != size) ||
        c.rows.size() != static_cast<std::size_t>(c.state.iteration)) {
      throw Error("its arrays have other sizes");
    }
    return c;
  } catch (const std::exception& e) {
    throw Error(fmt::format("{}: damaged: {}; delete the folder", path, e.what()));
  }
}

Json rowOf(const MppiReport& r) {
  return {{"iteration", r.iteration}, {"nominal_cost", r.nominal_cost},
          {"best_cost", r.best_cost}, {"mean_cost", r.mean},
          {"spread", r.spread},       {"effective", r.effective},
          {"failed", r.failed},       {"digest", fmt::format("{:016x}", r.digest)}};
}

std::string costCsv(const Json& rows) {
  const std::vector<const char*> keys = {"iteration", "nominal_cost", "best_cost", "mean_cost",
                                         "spread",    "effective",    "failed"};
  std::string text = fmt::format("{}\n", fmt::join(keys, ","));
  for (const Json& row : rows) {
    for (const char* key : keys) {
      text += key == keys[0] ? "" : ",";
      if (row.contains(key)) text += row[key].is_null() ? "inf" : row[key].dump();
    }
    text += '\n';
  }
  return text;
}

std::string controlsCsv(const mjModel* m, const std::vector<double>& controls) {
  std::string text = "time_s";
  for (int i = 0; i < m->nu; i++) text += "," + nameOf(m, mjOBJ_ACTUATOR, i);
  text += '\n';
  for (std::size_t row = 0; row * m->nu < controls.size(); row++) {
    text += fmt::format("{:.6f}", static_cast<double>(row) * m->opt.timestep);
    for (int i = 0; i < m->nu; i++) text += fmt::format(",{}", controls[row * m->nu + i]);
    text += '\n';
  }
  return text;
}

// Each process rolls out its share of the samples, and knows all costs in the end.
std::vector<double> sharedCosts(const ControlProblem& problem, const Processes& processes,
                                const std::vector<std::vector<double>>& samples,
                                const std::function<void(double)>& progress, const int* cancel) {
  const auto rank = static_cast<std::size_t>(processes.rank());
  const auto size = static_cast<std::size_t>(processes.size());
  if (size == 1) return problem.costs(samples, progress, cancel);
  std::vector<std::vector<double>> share;
  for (std::size_t i = rank; i < samples.size(); i += size) share.push_back(samples[i]);
  Json mine = Json::array();
  if (!share.empty()) mine = problem.costs(share, progress, cancel);
  const auto texts = processes.gather(mine.dump());
  Json all = Json::array();
  if (rank == 0) {
    std::vector<Json> shares;
    for (const std::string& text : texts) shares.push_back(Json::parse(text));
    for (std::size_t i = 0; i < samples.size(); i++) all.push_back(shares[i % size][i / size]);
  }
  std::vector<double> costs;
  for (const Json& cost : Json::parse(processes.broadcast(all.dump()))) {
    costs.push_back(costOf(cost));
  }
  return costs;
}

// Least and largest flexion of the regions [deg], and the neck's jitter.
Json spineJson(const SpineMotion& spine) {
  const auto range = [](const std::vector<Eigen::Vector3d>& turns) {
    const auto [least, largest] = std::minmax_element(
        turns.begin(), turns.end(), [](const auto& a, const auto& b) { return a.y() < b.y(); });
    return Json{least->y() * 180 / M_PI, largest->y() * 180 / M_PI};
  };
  return {{"lumbar_flexion_deg", range(spine.lumbar)},
          {"thoracic_flexion_deg", range(spine.thoracic)},
          {"neck_flexion_deg", range(spine.neck)},
          {"neck_power_above_10_hz", neckJitter(spine)}};
}

ModelPtr loadTaskModel(const OptimizeOptions& o) {
  ModelPtr m = o.task.scene.empty()
                   ? loadModel(o.model)
                   : compileModel(sceneMjcf(o.model, o.task.scene, "."),
                                  o.task.name + " on " + fs::path(o.model).stem().string());
  torsoOf(m.get(), o.model);
  return m;
}

}  // namespace

Json optimize(const OptimizeOptions& o, const Processes& processes, const OptimizeWatch& watch) {
  const bool leads = processes.rank() == 0;
  const std::string checkpoint_path = o.output + "/checkpoint.json";
  if (leads) checkFolder(o.output);
  if (leads && !o.resume && fs::exists(checkpoint_path)) {
    throw Error(o.output +
                ": holds an optimisation already; add --resume to go on with it, or choose "
                "another folder");
  }
  const ModelPtr m = loadTaskModel(o);
  const ControlProblem problem(m.get(), o.task, o.model, o.threads);
  const Json settings = settingsOf(m.get(), o);

  Checkpoint c;
  c.state.nominal.assign(problem.size(), 0);
  const bool resume = leads && fs::exists(checkpoint_path);
  const std::string found = processes.broadcast(resume ? "+" + readFile(checkpoint_path) : "");
  if (!found.empty()) {
    c = parseCheckpoint(found.substr(1), settings, problem.size(), checkpoint_path);
  }
  if (c.state.iteration > o.iterations) {
    throw Error(fmt::format("{}: holds {} iterations already, more than --iterations {}", o.output,
                            c.state.iteration, o.iterations));
  }
  for (const Json& row : c.rows) watch.iteration(row);

  const std::vector<double> sigma = problem.sigma();
  while (c.state.iteration < o.iterations) {
    const int iteration = c.state.iteration;
    const double before = processSeconds();
    const auto costs = [&](const std::vector<std::vector<double>>& samples) {
      return sharedCosts(
          problem, processes, samples,
          [&](double share) { watch.progress((iteration + share) / o.iterations); }, watch.cancel);
    };
    const MppiReport report = mppiIterate(o.mppi, sigma, 1, costs, &c.state);
    const double spent = processSeconds() - before;
    for (const std::string& seconds : processes.gather(fmt::format("{}", spent))) {
      c.core_seconds += std::stod(seconds);
    }
    c.rows.push_back(rowOf(report));
    if (std::isinf(report.best_cost)) {
      throw Error(
          fmt::format("{}: every sample of the first iteration failed; take a smaller "
                      "--timestep or less --noise",
                      o.task.path));
    }
    if (leads) {
      writeFiles({{checkpoint_path, checkpointText(c, settings)},
                  {o.output + "/cost.csv", costCsv(c.rows)}});
    }
    watch.iteration(c.rows.back());
  }

  Json rows = c.rows;
  rows.push_back({{"iteration", o.iterations},
                  {"nominal_cost", c.state.nominal_cost},
                  {"best_cost", c.state.best_cost}});
  watch.iteration(rows.back());

  const ControlProblem::Trajectory best = problem.trajectory(c.state.best);
  Json result = {{"task", o.task.name},
                 {"settings", settings},
                 {"iterations", o.iterations},
                 {"knobs", problem.knobNames()},
                 {"parameters", problem.size()},
                 {"simulated_s_per_iteration", problem.simulatedSeconds() * o.mppi.samples},
                 {"start_cost", rows[0]["nominal_cost"]},
                 {"best_cost", c.state.best_cost},
                 {"rows", rows}};
  const std::optional<SpineMotion> spine = spineMotion(m.get(), best.motion);
  if (spine) result["spine"] = spineJson(*spine);
  if (leads) {
    std::map<std::string, std::string> files = {
        {o.output + "/best.motion", motionBinary(best.motion)},
        {o.output + "/controls.csv", controlsCsv(m.get(), best.controls)},
        {o.output + "/cost.csv", costCsv(rows)},
        {o.output + "/result.json", result.dump(2) + "\n"}};
    if (spine) files[o.output + "/spine.csv"] = spineCsv(*spine);
    if (!o.task.scene.empty()) {
      files[o.output + "/scene.xml"] = sceneMjcf(o.model, o.task.scene, o.output);
    }
    writeFiles(files);
  }
  result["core_s"] = c.core_seconds;
  return result;
}

}  // namespace torso::tools
