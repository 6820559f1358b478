// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/commands.h"
#include "tools/error.h"
#include "tools/posture.h"
#include "tools/progress_bar.h"
#include "tools/retrofit.h"
#include "tools/retrofit_truth.h"
#include "tools/truth_motions.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string model;
  std::vector<std::string> motions;
  double rate = 30;
  bool json = false;
};

constexpr double kDegrees = 180 / EIGEN_PI;

Json describe(const TruthErrors& e, const Posture& posture) {
  Json levels;
  for (std::size_t i = 0; i < e.levels.size(); i++) {
    levels[posture.names()[i]] = kDegrees * e.levels[i];
  }
  return {{"motion", e.motion},
          {"frames", e.frames},
          {"flagged", e.flagged},
          {"rms_deg", levels},
          {"worst_level", e.worst_level_name},
          {"worst_level_rms_deg", kDegrees * e.worst_level},
          {"lumbar_rms_deg", kDegrees * e.regions[0]},
          {"thoracic_rms_deg", kDegrees * e.regions[1]},
          {"cervical_rms_deg", kDegrees * e.regions[2]},
          {"scapula_rms_deg", kDegrees * e.worst_scapula},
          {"held_error_mm", 1e3 * e.position_error},
          {"held_error_deg", kDegrees * e.rotation_error},
          {"band_hz", e.smoothness.band},
          {"input_power_above_band", e.smoothness.input_share},
          {"output_power_above_band", e.smoothness.output_share},
          {"true_power_above_band", e.truth_smoothness.output_share},
          {"power_above_band_over_input", e.smoothness.gain},
          {"largest_jump_deg", kDegrees * e.smoothness.largest_jump},
          {"true_largest_jump_deg", kDegrees * e.truth_smoothness.largest_jump},
          {"core_s_per_s", e.core_seconds / e.seconds}};
}

void run(const Options& options) {
  const BodyMjcf body(options.model);
  const RetrofitModels models(body);
  const Posture posture(models.human.get());
  const auto motions = options.motions.empty() ? truthMotions() : options.motions;
  Json rows = Json::array();
  {
    const ProgressBar bar;
    for (const std::string& motion : motions) {
      bar.show(static_cast<double>(rows.size()) / motions.size());
      const Truth truth = makeTruth(body, motion, options.rate);
      const RetrofitResult result = retrofit(models, truth.held, RetrofitOptions());
      rows.push_back(describe(compareWithTruth(models, truth, result), posture));
    }
  }
  if (options.json) {
    std::cout << rows.dump(2) << std::endl;
    return;
  }
  fmt::print("{:15} {:>17} {:>6} {:>8} {:>8} {:>8}  {:>11}  {:>22}  {:>15} {:>5}\n",
             "rms error, deg", "worst level", "lumbar", "thoracic", "cervical", "scapula",
             "held bones", "power above band", "jump, deg", "core");
  for (const Json& row : rows) {
    const auto number = [&row](const char* name) { return row[name].get<double>(); };
    fmt::print(
        "{:15} {:>10} {:6.2f} {:6.2f} {:8.2f} {:8.2f} {:8.2f}  {:4.1f} mm {:.2f}  "
        "{:.3f}, true {:.3f} {:5.3f}  {:.2f}, true {:.2f} {:5.2f}\n",
        row["motion"].get<std::string>(), row["worst_level"].get<std::string>(),
        number("worst_level_rms_deg"), number("lumbar_rms_deg"), number("thoracic_rms_deg"),
        number("cervical_rms_deg"), number("scapula_rms_deg"), number("held_error_mm"),
        number("held_error_deg"), number("output_power_above_band"),
        number("true_power_above_band"), number("power_above_band_over_input"),
        number("largest_jump_deg"), number("true_largest_jump_deg"), number("core_s_per_s"));
  }
}

}  // namespace

void addTruth(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "truth", "How well retrofit finds motions of the body again of which every bone is known.");
  command->footer(
      "Servos of levels and joints move the whole body under its weight (forward dynamics). "
      "Pelvis,\n"
      "head and limbs of that go into retrofit, and what comes out is compared with what was:\n"
      "root mean square over the frames of the angle between the two, level by level and over "
      "whole\n"
      "regions. Retrofit knows nothing of the servos' moments, the weight and the inertia.\n"
      "power above band        of the turns of levels and scapulae, at frequencies above those "
      "that\n"
      "                        have 99 % of the power of the input's angular velocity\n"
      "core                    core-seconds per second of motion\n\n"
      "Examples:\n"
      "  torso truth mjcf/human.xml\n"
      "  torso truth mjcf/human.xml --motion wave --json\n"
      "  torso truth mjcf/human.xml --motion 'random 101,random 102'");
  command->add_option("MODEL", options->model, "MJCF file of a whole body")->required();
  command->add_option("--motion", options->motions, "Only these, or \"random N\"")
      ->delimiter(',')
      ->check([](const std::string& name) {
        try {
          truthMotion(name);
          return std::string();
        } catch (const Error& e) {
          return std::string(e.what());
        }
      });
  command->add_option("--rate", options->rate, "Frames per second [Hz]")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options] { run(*options); });
}

}  // namespace torso::tools
