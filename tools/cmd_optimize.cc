// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "tools/build_models.h"
#include "tools/commands.h"
#include "tools/control_problem.h"
#include "tools/error.h"
#include "tools/files.h"
#include "tools/optimize.h"
#include "tools/paths.h"
#include "tools/processes.h"
#include "tools/progress_bar.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string task;
  OptimizeOptions optimize;
  std::optional<double> horizon, timestep, knots, temperature, noise, noise_decay;
  std::optional<int> samples, iterations;
  int seeds = 1;
  bool compare = false, json = false, list = false;
};

// Ctrl-C ends the iteration at hand, which is lost; a second one ends the program.
int interrupted = 0;

void onInterrupt(int) {
  __atomic_store_n(&interrupted, 1, __ATOMIC_RELAXED);
  std::signal(SIGINT, SIG_DFL);
}

template <typename T>
void replace(const std::optional<T>& option, T* value) {
  if (option) *value = *option;
}

void listTasks() {
  for (const auto& [name, path] : shippedTasks()) {
    fmt::print("{:8} {}\n", name, readTask(path).description);
  }
}

std::string cell(const Json& row, const char* key, const char* format) {
  if (!row.contains(key)) return "";
  return row[key].is_null() ? "inf" : fmt::format(fmt::runtime(format), row[key].get<double>());
}

void printRow(const Json& row) {
  fmt::print("{:>9} {:>13} {:>13} {:>13} {:>11} {:>9} {:>6}\n", cell(row, "iteration", "{:.0f}"),
             cell(row, "nominal_cost", "{:.6f}"), cell(row, "best_cost", "{:.6f}"),
             cell(row, "mean_cost", "{:.6f}"), cell(row, "spread", "{:.6f}"),
             cell(row, "effective", "{:.1f}"), cell(row, "failed", "{:.0f}"));
  std::fflush(stdout);
}

void setUp(Options* options) {
  OptimizeOptions& o = options->optimize;
  Task& task = o.task = findTask(options->task);
  replace(options->horizon, &task.horizon);
  replace(options->timestep, &task.timestep);
  replace(options->knots, &task.knot_interval);
  o.iterations = options->iterations.value_or(task.iterations);
  o.mppi.samples = options->samples.value_or(task.samples);
  o.mppi.temperature = options->temperature.value_or(task.temperature);
  o.mppi.noise = options->noise.value_or(task.noise);
  o.mppi.noise_decay = options->noise_decay.value_or(task.noise_decay);
  if (o.model.empty()) o.model = mjcfFolder() + "/human.xml";
  if (o.output.empty()) o.output = task.name + "_optimum";
}

// The model, and for a comparison the same body with a fixed torso.
std::vector<std::string> models(const Options& options) {
  const std::string& model = options.optimize.model;
  if (!options.compare) return {model};
  const std::string fixed = humanBeside(model, TorsoKind::kFixed);
  if (fixed.empty()) {
    throw Error(model + ": no body with a fixed torso is beside it; write one with torso build");
  }
  return {model, fixed};
}

// One optimisation, with a table of its iterations.
Json runOne(const OptimizeOptions& o, bool print, const Processes& processes) {
  const bool leads = processes.rank() == 0;
  std::optional<ProgressBar> bar;
  if (leads) bar.emplace();
  OptimizeWatch watch;
  watch.cancel = &interrupted;
  watch.progress = [&bar](double share) {
    if (bar) bar->show(share);
  };
  watch.iteration = [&](const Json& row) {
    if (!leads || !print) return;
    bar->clear();
    if (row["iteration"] == 0) {
      fmt::print(
          "iteration  nominal_cost     best_cost     mean_cost      spread effective failed\n");
    }
    printRow(row);
  };
  const Json result = optimize(o, processes, watch);
  if (bar) bar->clear();
  if (leads && print) {
    fmt::print("cost {:.6f} at the start, {:.6f} at best; {:.0f} core-seconds; files in {}\n",
               result["start_cost"].get<double>(), result["best_cost"].get<double>(),
               result["core_s"].get<double>(), o.output);
  }
  return result;
}

// Of the runs of one model from several seeds.
Json bodyOf(const std::string& model, const std::vector<Json>& runs) {
  Json body = {{"model", std::filesystem::path(model).stem().string()},
               {"start_cost", runs[0]["start_cost"]},
               {"parameters", runs[0]["parameters"]}};
  double sum = 0, squares = 0, core_s = 0;
  for (const Json& run : runs) {
    const double cost = run["best_cost"];
    body["best_costs"].push_back(cost);
    if (run.contains("spine")) body["spines"].push_back(run["spine"]);
    sum += cost;
    core_s += run["core_s"].get<double>();
  }
  const auto n = static_cast<double>(runs.size());
  for (const double cost : body["best_costs"]) squares += (cost - sum / n) * (cost - sum / n);
  body["mean_cost"] = sum / n;
  body["sd"] = n > 1 ? Json(std::sqrt(squares / (n - 1))) : Json();
  body["core_s"] = core_s / n;
  return body;
}

void printSummary(const Json& summary) {
  fmt::print("{:14} {:>6} {:>9} {:>9} {:>7} {:>9} {:>9} {:>7}\n", "body", "knots", "start", "mean",
             "sd", "least", "largest", "core_s");
  for (const Json& body : summary["bodies"]) {
    const std::vector<double> costs = body["best_costs"];
    const auto [least, largest] = std::minmax_element(costs.begin(), costs.end());
    fmt::print("{:14} {:>6} {:>9.3f} {:>9.3f} {:>7} {:>9.3f} {:>9.3f} {:>7.0f}\n",
               body["model"].get<std::string>(), body["parameters"].get<int>(),
               body["start_cost"].get<double>(), body["mean_cost"].get<double>(),
               cell(body, "sd", "{:.3f}"), *least, *largest, body["core_s"].get<double>());
  }
  if (summary.contains("core_s_ratio")) {
    fmt::print("the detailed torso takes {:.0f} times the time of the fixed one\n",
               summary["core_s_ratio"].get<double>());
  }
}

// Each run has a folder of its own: OUTPUT, OUTPUT/seed1, OUTPUT/human_fixed/seed1, ...
Json runAll(const Options& options, const Processes& processes) {
  Json summary;
  const std::vector<std::string> bodies = models(options);
  for (const std::string& model : bodies) {
    std::vector<Json> runs;
    for (int i = 0; i < options.seeds; i++) {
      OptimizeOptions o = options.optimize;
      o.model = model;
      if (options.compare) o.output += "/" + std::filesystem::path(model).stem().string();
      o.mppi.seed += static_cast<std::uint64_t>(i);
      if (options.seeds > 1) o.output += fmt::format("/seed{}", o.mppi.seed);
      runs.push_back(runOne(o, !options.json, processes));
    }
    if (bodies.size() == 1 && runs.size() == 1) return runs[0];
    if (summary.is_null()) {
      summary = runs[0];
      for (const char* key :
           {"knobs", "parameters", "start_cost", "best_cost", "rows", "spine", "core_s"}) {
        summary.erase(key);
      }
      summary["seeds"] = options.seeds;
    }
    summary["bodies"].push_back(bodyOf(model, runs));
  }
  const Json& all = summary["bodies"];
  if (all.size() > 1) {
    summary["core_s_ratio"] = all[0]["core_s"].get<double>() / all[1]["core_s"].get<double>();
  }
  if (processes.rank() == 0) {
    writeFiles({{options.optimize.output + "/result.json", summary.dump(2) + "\n"}});
  }
  return summary;
}

void run(Options options) {
  if (options.list) return listTasks();
  if (options.task.empty()) {
    throw CLI::ValidationError("TASK", "give a task, or --list to see those there are");
  }
  setUp(&options);
  const Processes processes;
  std::signal(SIGINT, onInterrupt);
  Json result;
  try {
    result = runAll(options, processes);
  } catch (const ControlProblem::Cancelled&) {
    std::cerr << "torso optimize: interrupted; --resume goes on from the last iteration\n";
    std::signal(SIGINT, SIG_DFL);
    std::raise(SIGINT);
  }
  processes.leave();
  if (processes.rank() != 0) return;
  if (options.json) {
    std::cout << result.dump(2) << std::endl;
  } else if (result.contains("bodies")) {
    printSummary(result);
  }
}

}  // namespace

void addOptimize(CLI::App& app) {
  auto options = std::make_shared<Options>();
  OptimizeOptions& o = options->optimize;
  CLI::App* command = app.add_subcommand(
      "optimize", "Find the controls that do a task best (MPPI): swing, jump, bow or your own.");
  command->footer(
      "An open-loop sequence of controls over the horizon is improved, iteration by iteration, by\n"
      "the weighted mean of random changes to it (Williams et al., ICRA 2017). What changes are\n"
      "the targets of the servos, by knobs that move groups of servos together; a knob over time\n"
      "is a smooth spline. A task is a JSON file, see those that come with torso; its cost is in\n"
      "our axes, x forward, y left, z up (the paper's z, x and y).\n\n"
      "It prints, and writes to cost.csv, the cost of the nominal controls of each iteration, the\n"
      "best so far, mean and spread (median less smallest) of the samples, how many samples the\n"
      "mean rests on, and how many failed. The folder also gets best.motion (torso view\n"
      "--motion), controls.csv, spine.csv (how lumbar, thoracic and cervical spine bend along "
      "it),\n"
      "result.json (also how jittery the neck is), checkpoint.json and, for a task with a scene "
      "of\n"
      "its own, scene.xml, the model to view it with.\n\n"
      "--seeds and --compare run it several times, each in a folder of its own, and print and "
      "write\n"
      "(result.json) mean and spread.\n\n"
      "All of them are the same, byte for byte, for any number of threads, and of processes under\n"
      "mpirun, and after a kill and --resume, on machines of one kind.\n\n"
      "Examples:\n"
      "  torso optimize --list\n"
      "  torso optimize swing -o swing --threads 2\n"
      "  torso optimize swing -o swing --threads 2 --resume\n"
      "  torso view swing/scene.xml --motion swing/best.motion\n"
      "  torso optimize jump --model mjcf/human_fixed.xml -o jump_fixed\n"
      "  torso optimize swing --seeds 3 --compare -o swing       detailed against fixed torso\n"
      "  torso optimize mine.json --samples 128 --iterations 50 --seed 3");
  command->add_option("TASK", options->task, "Its name, or a file TASK.json");
  command->add_flag("--list", options->list, "List the tasks that come with torso");
  command->add_option("--model", o.model, "MJCF of the body; by default mjcf/human.xml");
  command->add_option("-o,--output", o.output, "Folder to write; by default TASK_optimum");
  command->add_option("--iterations", options->iterations, "Instead of the task's, as all below")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--samples", options->samples, "Rollouts in an iteration")
      ->check(CLI::Range(2, 1000000));
  command->add_option("--horizon", options->horizon, "[s]")->check(CLI::PositiveNumber);
  command->add_option("--timestep", options->timestep, "[s]")->check(CLI::PositiveNumber);
  command->add_option("--knots", options->knots, "Time between the knots of the controls [s]")
      ->check(CLI::PositiveNumber);
  auto* temperature = command
                          ->add_option("--temperature", options->temperature,
                                       "Of the weights, as a share of the spread of the costs")
                          ->check(CLI::PositiveNumber);
  command
      ->add_flag("--absolute-temperature", o.mppi.absolute_temperature,
                 "The temperature is in units of the cost")
      ->needs(temperature);
  command->add_option("--noise", options->noise, "Factor on the noise of the task's actions")
      ->check(CLI::PositiveNumber);
  command->add_option("--noise-decay", options->noise_decay, "Factor on it after each iteration")
      ->check(CLI::Range(0.1, 1.0));
  command->add_option("--seed", o.mppi.seed, "Of the noise")->capture_default_str();
  command->add_option("--seeds", options->seeds, "Run from so many seeds, from --seed on")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_flag("--compare", options->compare,
                    "Run also the same body with a fixed torso, MODEL_fixed.xml");
  command->add_option("--threads", o.threads, "Number of threads")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->add_flag("--resume", o.resume, "Go on from the folder's checkpoint, if it has one");
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options] { run(*options); });
}

}  // namespace torso::tools
