// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "model/parallel.h"
#include "tools/build_models.h"
#include "tools/commands.h"
#include "tools/fall.h"
#include "tools/fall_pictures.h"
#include "tools/files.h"
#include "tools/paths.h"
#include "tools/progress_bar.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string model, plot, pictures;
  FallOptions fall;
  int seeds = 5, threads = 1;
  std::uint64_t seed0 = 0;
  bool json = false;
};

// Limits of a driver's head in regulations for crash tests; no person falls on a floor by them.
constexpr double kHicLimit = 700;     // HIC15, 50th percentile male: FMVSS 208 S6.2
constexpr double kHead3msLimit = 80;  // [g], exceeded for 3 ms in sum: UN Regulation 94, 5.2.1.2

Json meanJson(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return {{"mean", sum / static_cast<double>(values.size())},
          {"lowest", *std::min_element(values.begin(), values.end())},
          {"highest", *std::max_element(values.begin(), values.end())}};
}

Json describe(const FallenModel& model) {
  int heads = 0;
  for (const Fall& fall : model.falls) heads += fall.head_touch >= 0;
  const auto part = [&](FallPeaks (*peaks)(const Fall&)) -> Json {
    const auto all = [&](double FallPeaks::*peak, bool in_weights = false) {
      std::vector<double> values;
      for (const Fall& fall : model.falls) {
        values.push_back(peaks(fall).*peak / (in_weights ? fall.weight : 1));
      }
      return meanJson(values);
    };
    return {{"floor_force_n", all(&FallPeaks::force)},
            {"floor_force_bw", all(&FallPeaks::force, true)},
            {"head_acceleration_g", all(&FallPeaks::head)},
            {"head_3ms_g", all(&FallPeaks::head_3ms)},
            {"hic15", all(&FallPeaks::hic15)}};
  };
  return {{"torso", model.name},
          {"model", model.path},
          {"weight_n", model.falls[0].weight},
          {"landing", part(landingPeaksOf)},
          {"fall", part(peaksOf)},
          {"heads_on_floor", heads}};
}

std::vector<FallenModel> simulateAll(const Options& options) {
  std::vector<FallenModel> models;
  const std::string path = options.model.empty() ? mjcfFolder() + "/human.xml" : options.model;
  models.push_back({"detailed", path, loadModel(path), {}});
  for (const auto& [name, kind] :
       {std::pair{"simple", TorsoKind::kSimple}, {"fixed", TorsoKind::kFixed}}) {
    const std::string beside = humanBeside(path, kind);
    if (!beside.empty()) models.push_back({name, beside, loadModel(beside), {}});
  }
  for (FallenModel& model : models) {
    torsoOf(model.m.get(), model.path);
    model.falls.resize(options.seeds);
  }
  const int runs = static_cast<int>(models.size()) * options.seeds;
  std::atomic<int> done = 0;
  const ProgressBar bar;
  forEach(runs, options.threads, [&](int i) {
    const int seed = i / static_cast<int>(models.size());
    FallenModel& model = models[i % models.size()];
    FallOptions fall_options = options.fall;
    if (seed > 0 || options.pictures.empty()) fall_options.frame_times.clear();
    model.falls[seed] = fall(model.m.get(), model.path, fall_options, options.seed0 + seed);
    bar.show(static_cast<double>(++done) / runs);
  });
  return models;
}

void print(const Json& j) {
  fmt::print("{:<40}", fmt::format("from {:g} m, {} seeds", j["height_m"].get<double>(),
                                   j["seeds"].get<int>()));
  for (const Json& model : j["models"]) fmt::print("{:>22}", model["torso"].get<std::string>());
  fmt::print("\n");
  const auto rows = [&](const char* part, const char* title) {
    fmt::print("{}\n", title);
    for (const auto& [key, name, digits] :
         {std::tuple{"floor_force_n", "force of the floor [N]", 0},
          {"floor_force_bw", "force of the floor [body weights]", 1},
          {"head_acceleration_g", "acceleration of the head [g]", 1},
          {"head_3ms_g", "  exceeded for 3 ms [g]", 1},
          {"hic15", "head injury criterion HIC15", 0}}) {
      fmt::print("  {:<38}", name);
      for (const Json& model : j["models"]) {
        const Json& value = model[part][key];
        const auto text = [&](const char* k) {
          return fmt::format("{:.{}f}", value[k].get<double>(), digits);
        };
        fmt::print("{:>22}",
                   fmt::format("{} ({} - {})", text("mean"), text("lowest"), text("highest")));
      }
      fmt::print("\n");
    }
  };
  rows("landing", "largest on landing, mean (lowest - highest)");
  rows("fall", "largest in all the fall");
  fmt::print("{:<40}", "runs in which the head meets the floor");
  for (const Json& model : j["models"]) fmt::print("{:>22}", model["heads_on_floor"].get<int>());
  fmt::print("\nlimits of crash tests: HIC15 {:g}, 3 ms {:g} g\n", kHicLimit, kHead3msLimit);
}

void run(const Options& options) {
  if (!options.plot.empty()) checkFolder(options.plot);
  std::vector<FallenModel> models = simulateAll(options);
  Json result = {{"height_m", options.fall.height},
                 {"seeds", options.seeds},
                 {"seconds", options.fall.seconds},
                 {"rate_hz", options.fall.rate},
                 {"amplitude", options.fall.amplitude},
                 {"landing_s", kLanding},
                 {"hic15_limit", kHicLimit},
                 {"head_3ms_limit_g", kHead3msLimit},
                 {"models", Json::array()}};
  for (const FallenModel& model : models) result["models"].push_back(describe(model));
  if (!options.plot.empty()) writeFallPlot(options.plot, models, kHead3msLimit);
  if (!options.pictures.empty()) {
    writeFile(options.pictures, fallStrip(models, options.fall.frame_times));
  }
  if (options.json) {
    std::cout << result.dump(2) << '\n';
  } else {
    print(result);
  }
}

}  // namespace

void addFall(CLI::App& app) {
  auto options = std::make_shared<Options>();
  options->fall.frame_times = {-0.1, 0.03, 0.08, 0.15, 0.3, 0.5, 0.8, 1.3};
  CLI::App* command = app.add_subcommand(
      "fall", "Drop the body on its feet, with a detailed, a simple and a fixed torso.");
  command->footer(
      "The standing body falls with small random controls (Lee et al. 2023: from 2 m). Compared "
      "with\n"
      "MODEL_simple.xml and MODEL_fixed.xml, if they are beside MODEL (torso build).\n\n"
      "force of the floor     all contacts with the world together, largest magnitude\n"
      "acceleration           of the head's centre of mass as an accelerometer shows it, largest\n"
      "                       magnitude; and the level exceeded for 3 ms in sum (UN R94)\n"
      "HIC15                  head injury criterion over at most 15 ms (FMVSS 208)\n"
      "landing                within 0.1 s of the first touch; else in all the fall, where heads "
      "may\n"
      "                       meet the floor\n\n"
      "Each sample is the exact mean over a step, whose rate of 2400 Hz lets nothing pass above\n"
      "1200 Hz; the filter of SAE J211 for heads (CFC 1000), which cuts at 1650 Hz, would change\n"
      "nothing.\n\n"
      "Examples:\n"
      "  torso fall\n"
      "  torso fall --drop 1 --seeds 10 --json\n"
      "  torso fall --seeds 3 --plot out --pictures fall.png");
  command->add_option("MODEL", options->model,
                      "MJCF file with a detailed torso; by default the human.xml that comes with "
                      "torso");
  command->add_option("--drop", options->fall.height, "Height of the fall [m]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--seconds", options->fall.seconds, "Simulated time of each run [s]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--rate", options->fall.rate, "Steps per second [Hz]")
      ->check(CLI::Range(600.0, 20000.0))
      ->capture_default_str();
  command
      ->add_option("--amplitude", options->fall.amplitude,
                   "Of the random controls, share of each actuator's range")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--seeds", options->seeds, "Number of runs of each body")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--seed0", options->seed0, "The first seed")->capture_default_str();
  command->add_option("--threads", options->threads, "Number of threads")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->add_option("--plot", options->plot,
                      "Write the first seed's course to this folder: fall.csv, fall.gp and, with "
                      "gnuplot, fall.png");
  command->add_option("--pictures", options->pictures,
                      "PNG file of the first seed: a row of pictures of each body");
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options] { run(*options); });
}

}  // namespace torso::tools
