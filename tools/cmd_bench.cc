// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <future>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/clock.h"
#include "tools/commands.h"
#include "tools/error.h"
#include "tools/mujoco_support.h"
#include "tools/paths.h"
#include "tools/rollout.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string model, fixed;
  double seconds = 2;
  int repetitions = 7;
  bool json = false;
};

// Processor time that the calling thread has spent in mjcb_passive while a PassiveTimer lives [s].
thread_local double passive_seconds = 0;
mjfGeneric timed_callback = nullptr;

void timedPassive(const mjModel* m, mjData* d) {
  const double start = threadSeconds();
  timed_callback(m, d);
  passive_seconds += threadSeconds() - start;
}

class PassiveTimer {
 public:
  PassiveTimer() {
    timed_callback = mjcb_passive;
    if (timed_callback) mjcb_passive = timedPassive;
  }
  ~PassiveTimer() { mjcb_passive = timed_callback; }
  PassiveTimer(const PassiveTimer&) = delete;
  PassiveTimer& operator=(const PassiveTimer&) = delete;
};

// The body falls from 0.2 m, standing, with random controls.
RolloutOptions scenario(double seconds) {
  RolloutOptions options;
  options.seconds = seconds;
  options.control = Control::kRandom;
  options.lift = 0.2;
  return options;
}

// A model at one of the rates that the result's keys name.
struct Subject {
  Subject(const std::string& file, double rate) : path(file), m(loadModel(file)) {
    torsoOf(m.get(), path);
    configureModel(m.get(), scenario(0), 1 / rate);
    d = makeData(m.get());
  }

  std::string path;
  ModelPtr m;
  DataPtr d;
};

struct StepCost {
  double step_us, passive_us;  // processor time of a step, and of the callback in it
};

StepCost measure(const Subject& subject, mjData* d, double seconds, std::uint64_t seed) {
  const mjModel* m = subject.m.get();
  const RolloutOptions options = scenario(seconds);
  startRun(m, d, options);
  ControlSignal controls(m, d, options, seed);
  passive_seconds = 0;
  const double start = threadSeconds();
  const auto steps = static_cast<double>(simulate(m, d, controls, seconds));
  const double spent = threadSeconds() - start;
  const std::string warning = firstWarning(d);
  if (!warning.empty()) {
    throw Error(fmt::format("{}: seed {} at {:.0f} Hz is not worth measuring: {}", subject.path,
                            seed, 1 / m->opt.timestep, warning));
  }
  return {1e6 * spent / steps, 1e6 * passive_seconds / steps};
}

double wallSeconds() {
  using std::chrono::steady_clock;
  return std::chrono::duration<double>(steady_clock::now().time_since_epoch()).count();
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2) return *middle;
  return (*middle + *std::max_element(values.begin(), middle)) / 2;
}

// "<folder>/human_fixed.xml" for "<folder>/human.xml"; "" if it is not there.
std::string fixedModelBeside(const std::string& model) {
  std::filesystem::path path(model);
  path.replace_filename(path.stem().string() + "_fixed" + path.extension().string());
  return std::filesystem::exists(path) ? path.string() : "";
}

Json bench(const Options& options) {
  const std::string path = options.model.empty() ? mjcfFolder() + "/human.xml" : options.model;
  const std::string fixed_path = options.fixed.empty() ? fixedModelBeside(path) : options.fixed;
  const Subject at600(path, 600), at200(path, 200);
  const DataPtr second = makeData(at600.m.get());
  std::unique_ptr<Subject> fixed;
  if (!fixed_path.empty()) fixed = std::make_unique<Subject>(fixed_path, 600);

  // Everything in turn in each repetition, so that what else the machine does hits all alike. The
  // first repetition warms up and does not count.
  std::vector<double> step600, disc600, step200, disc200, ratio, speedup;
  const double seconds = options.seconds;
  const PassiveTimer timer;
  for (int seed = 0; seed <= options.repetitions; seed++) {
    const double start = wallSeconds();
    const StepCost cost600 = measure(at600, at600.d.get(), seconds, seed);
    const double wall_one = wallSeconds() - start;
    const StepCost cost_fixed = fixed ? measure(*fixed, fixed->d.get(), seconds, seed) : StepCost{};
    const StepCost cost200 = measure(at200, at200.d.get(), seconds, seed);

    const double start_two = wallSeconds();
    auto other =
        std::async(std::launch::async, [&] { return measure(at600, second.get(), seconds, seed); });
    measure(at600, at600.d.get(), seconds, seed);
    other.get();
    const double wall_two = wallSeconds() - start_two;

    if (seed == 0) continue;
    step600.push_back(cost600.step_us);
    disc600.push_back(cost600.passive_us);
    step200.push_back(cost200.step_us);
    disc200.push_back(cost200.passive_us);
    if (fixed) ratio.push_back(cost600.step_us / cost_fixed.step_us);
    speedup.push_back(2 * wall_one / wall_two);
  }

  return {{"model", path},
          {"fixed_model", fixed ? Json(fixed_path) : Json()},
          {"repetitions", options.repetitions},
          {"step_us", median(step600)},
          {"disc_us", median(disc600)},
          {"step_200hz_us", median(step200)},
          {"disc_200hz_us", median(disc200)},
          {"rtf_600hz", 1e6 / 600 / median(step600)},
          {"rtf_200hz", 1e6 / 200 / median(step200)},
          {"ratio_to_fixed_torso", fixed ? Json(median(ratio)) : Json()},
          {"threads_2_speedup", median(speedup)}};
}

void print(const Json& j) {
  const auto row = [](const char* name, const std::string& value) {
    fmt::print("{:<42}{}\n", name, value);
  };
  const auto number = [&](const char* key) { return j[key].get<double>(); };
  row("model", j["model"].get<std::string>());
  row("step at 600 Hz [us]",
      fmt::format("{:.0f}, of which discs {:.0f}", number("step_us"), number("disc_us")));
  row("step at 200 Hz [us]", fmt::format("{:.0f}, of which discs {:.0f}", number("step_200hz_us"),
                                         number("disc_200hz_us")));
  row("real-time factor of one core, 600 Hz", fmt::format("{:.2f}", number("rtf_600hz")));
  row("real-time factor of one core, 200 Hz", fmt::format("{:.2f}", number("rtf_200hz")));
  row("cost of a step to that with a fixed torso",
      j["fixed_model"].is_null() ? "not measured: there is no model with a fixed torso"
                                 : fmt::format("{:.1f} x", number("ratio_to_fixed_torso")));
  row("speed of 2 threads to that of 1", fmt::format("{:.2f} x", number("threads_2_speedup")));
}

}  // namespace

void addBench(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("bench", "What a simulation step costs.");
  command->footer(
      "The standing body falls from 0.2 m with random controls. Medians over the repetitions, "
      "each\n"
      "of which measures everything in turn. Times of steps are processor times of one thread;\n"
      "disc_us is the part inside mjcb_passive, the torso plugin's. threads_2_speedup is wall "
      "time:\n"
      "it needs two idle cores.\n\n"
      "Examples:\n"
      "  torso bench\n"
      "  torso bench mjcf/human.xml --repetitions 15 --json");
  command->add_option("MODEL", options->model,
                      "MJCF, URDF or MJB file; by default the human.xml that comes with torso");
  command->add_option("--fixed", options->fixed,
                      "The same body with a fixed torso; by default MODEL_fixed.xml, if it exists");
  command->add_option("--seconds", options->seconds, "Simulated time of each measurement [s]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--repetitions", options->repetitions, "Measurements that count")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options] {
    const Json result = bench(*options);
    if (options->json) {
      std::cout << result.dump(2) << '\n';
    } else {
      print(result);
    }
  });
}

}  // namespace torso::tools
