// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "model/median.h"
#include "tools/build_models.h"
#include "tools/commands.h"
#include "tools/error.h"
#include "tools/mujoco_support.h"
#include "tools/paths.h"
#include "tools/renderer.h"
#include "tools/rollout.h"
#include "tools/step_cost.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string model, fixed;
  double seconds = 2;
  int repetitions = 7;
  bool json = false;
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

double measure(const Subject& subject, mjData* d, double seconds, std::uint64_t seed) {
  try {
    return stepMicroseconds(subject.m.get(), d, scenario(seconds), seed);
  } catch (const Error& e) {
    throw Error(fmt::format("{}: {}", subject.path, e.what()));
  }
}

double wallSeconds() {
  using std::chrono::steady_clock;
  return std::chrono::duration<double>(steady_clock::now().time_since_epoch()).count();
}

// What the viewer's user waits for: the file, and a frame of its window.
Json viewing(const std::string& path, int repetitions) {
  constexpr int kWidth = 1280, kHeight = 960, kSamples = 4;  // samples: as `simulate` asks for
  std::vector<double> load, frame;
  ModelPtr m;
  for (int i = 0; i <= repetitions; i++) {
    const double start = wallSeconds();
    m = loadModel(path);
    if (i > 0) load.push_back(wallSeconds() - start);
  }
  m->vis.quality.offsamples = kSamples;
  const DataPtr d = makeData(m.get());
  mj_forward(m.get(), d.get());
  mjvOption option;
  mjv_defaultOption(&option);
  Renderer renderer(m.get(), kWidth, kHeight);
  const mjvCamera camera =
      frameBodies(m.get(), {d.get()}, option, kDefaultAzimuth, kDefaultElevation, 4.0 / 3);
  for (int i = 0; i <= repetitions; i++) {
    const double start = wallSeconds();
    renderer.pixels(d.get(), option, camera);
    if (i > 0) frame.push_back(1e3 * (wallSeconds() - start));
  }
  return {{"load_s", median(load)},
          {"frame_ms", median(frame)},
          {"frame_pixels", {kWidth, kHeight}},
          {"frame_driver", renderer.driver()}};
}

// Median of each part, and what a step costs beyond them.
Json partsJson(const std::vector<StepParts>& measured, double step_us) {
  Json parts;
  double other = step_us;
  for (int i = 0; i < kNumParts; i++) {
    std::vector<double> values;
    for (const StepParts& p : measured) values.push_back(p[i]);
    const double value = median(values);
    parts[kPartNames[i]] = value;
    other -= value;
  }
  parts["other"] = other;
  return parts;
}

Json bench(const Options& options) {
  const std::string path = options.model.empty() ? mjcfFolder() + "/human.xml" : options.model;
  const std::string fixed_path =
      options.fixed.empty() ? humanBeside(path, TorsoKind::kFixed) : options.fixed;
  const Subject at600(path, 600), at200(path, 200);
  const DataPtr second = makeData(at600.m.get());
  std::unique_ptr<Subject> fixed;
  if (!fixed_path.empty()) fixed = std::make_unique<Subject>(fixed_path, 600);

  // Everything in turn in each repetition, so that what else the machine does hits all alike. The
  // first repetition warms up and does not count.
  std::vector<double> step600, step200, ratio, speedup;
  std::vector<StepParts> parts600, parts200;
  const double seconds = options.seconds;
  for (int seed = 0; seed <= options.repetitions; seed++) {
    const double start = wallSeconds();
    const double us600 = measure(at600, at600.d.get(), seconds, seed);
    const double wall_one = wallSeconds() - start;
    const double us_fixed = fixed ? measure(*fixed, fixed->d.get(), seconds, seed) : 0;
    const double us200 = measure(at200, at200.d.get(), seconds, seed);
    const StepParts p600 = stepParts(at600.m.get(), at600.d.get(), scenario(seconds), seed);
    const StepParts p200 = stepParts(at200.m.get(), at200.d.get(), scenario(seconds), seed);
    const double start_two = wallSeconds();
    auto other =
        std::async(std::launch::async, [&] { return measure(at600, second.get(), seconds, seed); });
    measure(at600, at600.d.get(), seconds, seed);
    other.get();
    const double wall_two = wallSeconds() - start_two;
    if (seed == 0) continue;
    step600.push_back(us600);
    step200.push_back(us200);
    parts600.push_back(p600);
    parts200.push_back(p200);
    if (fixed) ratio.push_back(us600 / us_fixed);
    speedup.push_back(2 * wall_one / wall_two);
  }
  const double us600 = median(step600), us200 = median(step200);
  return {{"model", path},
          {"fixed_model", fixed ? Json(fixed_path) : Json()},
          {"repetitions", options.repetitions},
          {"step_us", us600},
          {"step_200hz_us", us200},
          {"parts_us", partsJson(parts600, us600)},
          {"parts_200hz_us", partsJson(parts200, us200)},
          {"rtf_600hz", 1e6 / 600 / us600},
          {"rtf_200hz", 1e6 / 200 / us200},
          {"ratio_to_fixed_torso", fixed ? Json(median(ratio)) : Json()},
          {"threads_2_speedup", median(speedup)},
          {"viewing", viewing(path, options.repetitions)}};
}

void print(const Json& j) {
  const auto row = [](const char* name, const std::string& value) {
    fmt::print("{:<42}{}\n", name, value);
  };
  const auto number = [&](const char* key) { return j[key].get<double>(); };
  row("model", j["model"].get<std::string>());
  fmt::print("{:<42}{:>7}  {:>7}\n", "processor time [us]", "600 Hz", "200 Hz");
  const auto both = [](const std::string& name, const Json& at600, const Json& at200) {
    fmt::print("{:<42}{:7.1f}  {:7.1f}\n", name, at600.get<double>(), at200.get<double>());
  };
  both("step", j["step_us"], j["step_200hz_us"]);
  for (const auto& [name, us] : j["parts_us"].items()) {
    both("  " + name, us, j["parts_200hz_us"][name]);
  }
  row("real-time factor of one core, 600 Hz", fmt::format("{:.2f}", number("rtf_600hz")));
  row("real-time factor of one core, 200 Hz", fmt::format("{:.2f}", number("rtf_200hz")));
  row("cost of a step to that with a fixed torso",
      j["fixed_model"].is_null() ? "not measured: there is no model with a fixed torso"
                                 : fmt::format("{:.1f} x", number("ratio_to_fixed_torso")));
  row("speed of 2 threads to that of 1", fmt::format("{:.2f} x", number("threads_2_speedup")));
  const Json& viewing = j["viewing"];
  row("mj_loadXML [s]", fmt::format("{:.2f}", viewing["load_s"].get<double>()));
  row("a frame of 1280 x 960 [ms]", fmt::format("{:.0f}, by {}", viewing["frame_ms"].get<double>(),
                                                viewing["frame_driver"].get<std::string>()));
}

}  // namespace

void addBench(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("bench", "What a simulation step costs.");
  command->footer(
      "The standing body falls from 0.2 m with random controls. Medians over the repetitions, "
      "each\n"
      "of which measures everything in turn. Times of steps are processor times of one thread.\n"
      "Their parts come from runs of their own, on MuJoCo's timers; disc and rows are the torso\n"
      "plugin's mjcb_passive: its disc solver, and the rest. 'other' is what the parts leave of "
      "the\n"
      "step; it may be below zero by the noise. threads_2_speedup is wall time: it needs two idle\n"
      "cores. The frame is one of the viewer's: the whole body, 4 samples a pixel, shadows.\n\n"
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
