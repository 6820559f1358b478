// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <thread>

#include "model/person.h"
#include "tools/build_models.h"
#include "tools/commands.h"
#include "tools/error.h"
#include "tools/files.h"
#include "tools/paths.h"
#include "tools/progress_bar.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegree = M_PI / 180;

struct Options {
  std::string output, anatomy, sex = "m";
  double stature = 0, mass = 0, lordosis = 0, kyphosis = 0, sacral_slope = 0;
  std::vector<std::string> torso = {};  // empty: all
  int threads = 0;
  bool json = false, muscles = false;
};

// Which of them were given says the command line, for 0 is a number like others.
Person personOf(const Options& options, const CLI::App& command) {
  Person person;
  person.sex = options.sex == "f" ? Person::Sex::kFemale : Person::Sex::kMale;
  if (command.count("--stature")) person.stature = options.stature;
  if (command.count("--mass")) person.mass = options.mass;
  if (command.count("--lordosis")) person.lordosis = options.lordosis * kDegree;
  if (command.count("--kyphosis")) person.kyphosis = options.kyphosis * kDegree;
  if (command.count("--sacral-slope")) person.sacral_slope = options.sacral_slope * kDegree;
  return person;
}

std::set<TorsoKind> kindsOf(const Options& options) {
  const std::map<std::string, TorsoKind> named = {{"detailed", TorsoKind::kDetailed},
                                                  {"fixed", TorsoKind::kFixed},
                                                  {"simple", TorsoKind::kSimple}};
  std::set<TorsoKind> kinds;
  for (const auto& [name, kind] : named) {
    const auto& asked = options.torso;
    if (asked.empty() || std::count(asked.begin(), asked.end(), name)) kinds.insert(kind);
  }
  return kinds;
}

Json describe(const Anatomy& anatomy, const Options& options) {
  const SagittalAlignment s = sagittalAlignment(anatomy);
  const auto rounded = [](double x) { return std::round(x * 1e4) / 1e4; };
  return {{"folder", options.output},
          {"stature_m", rounded(anatomy.stature())},
          {"mass_kg", rounded(anatomy.mass())},
          {"sex", options.sex},
          {"lordosis_l1_s1_deg", rounded(s.lumbar_lordosis / kDegree)},
          {"kyphosis_t4_t12_deg", rounded(s.thoracic_kyphosis / kDegree)},
          {"kyphosis_t1_t12_deg", rounded(s.kyphosis_t1_t12 / kDegree)},
          {"lordosis_c2_c7_deg", rounded(s.cervical_lordosis / kDegree)},
          {"sacral_slope_deg", rounded(s.sacral_slope / kDegree)},
          {"pelvic_tilt_deg", rounded(s.pelvic_tilt / kDegree)},
          {"c7_before_s1_m", rounded(s.c7_offset)},
          {"centre_of_mass_before_ankles_m", rounded(s.centre_of_mass)}};
}

void print(const Json& body, const std::map<std::string, std::string>& files) {
  std::string names;
  for (const auto& [name, content] : files) {
    if (name.rfind("assets/", 0) != 0) names += name + ", ";
  }
  const auto number = [&](const char* key) { return body[key].get<double>(); };
  fmt::print("{}: {}assets/\n", body["folder"].get<std::string>(), names);
  fmt::print("{} of {:.3f} m and {:.1f} kg\n", body["sex"] == "f" ? "woman" : "man",
             number("stature_m"), number("mass_kg"));
  fmt::print("lordosis L1-S1 {:.1f}, kyphosis T4-T12 {:.1f} (T1-T12 {:.1f}), neck C2-C7 {:.1f}\n",
             number("lordosis_l1_s1_deg"), number("kyphosis_t4_t12_deg"),
             number("kyphosis_t1_t12_deg"), number("lordosis_c2_c7_deg"));
  fmt::print("sacral slope {:.1f}, pelvic tilt {:.1f} [deg]; C7 {:.0f} mm before S1's rear edge\n",
             number("sacral_slope_deg"), number("pelvic_tilt_deg"), 1e3 * number("c7_before_s1_m"));
}

void build(Options& options, const CLI::App& command) {
  if (options.output.empty()) options.output = mjcfFolder();
  if (options.anatomy.empty()) options.anatomy = anatomyFolder();
  if (options.threads == 0) {
    options.threads = std::max(1u, std::thread::hardware_concurrency());
  }
  const Anatomy tables = Anatomy::load(options.anatomy);
  Anatomy anatomy;
  try {
    anatomy = personalAnatomy(tables, personOf(options, command));
  } catch (const std::invalid_argument& e) {
    throw Error(fmt::format("--{}", e.what()));
  }
  checkFolder(options.output);
  std::map<std::string, std::string> files;
  {
    const ProgressBar bar;
    files = buildModels(
        anatomy, options.threads, [&](double share) { bar.show(share); }, nullptr, options.muscles,
        kindsOf(options));
  }
  std::map<std::string, std::string> by_path;
  for (const auto& [name, content] : files) by_path[options.output + "/" + name] = content;
  writeFiles(by_path);
  Json body = describe(anatomy, options);
  if (options.json) {
    for (const auto& [name, content] : files) body["files"].push_back(name);
    std::cout << body.dump(2) << '\n';
  } else {
    print(body, files);
  }
}

}  // namespace

void addBuild(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("build", "Write the MJCF models and bone meshes from the anatomy tables.");
  command->footer(
      "Writes torso.xml (torso, head, pelvis, shoulder girdle), human.xml (whole body on a "
      "floor),\n"
      "human_fixed.xml (the same with one rigid torso), human_simple.xml (with three ball joints "
      "in "
      "the\n"
      "spine's place), torso_held.xml, scene.xml (floor and light) and assets/, all of them or "
      "none;\n"
      "--torso: only the whole bodies with such a torso, and what they need. Bones, masses, limbs "
      "and\n"
      "contacts are the same in all; where the torso is fixed or simple, clavicles and scapulae "
      "are "
      "part\n"
      "of the rib cage. What is not told about the person is as in the tables: a\n"
      "man of 1.70 m and 72 kg with a lordosis of 60 and a kyphosis of 41 degrees.\n\n"
      "Examples:\n"
      "  torso build                           refresh the models that come with the project\n"
      "  torso build --anatomy mine -o models  from tables of your own\n"
      "  torso build --torso simple -o models  human_simple.xml, scene.xml and assets/\n"
      "  torso build --stature 1.85 --mass 90 --sex f --lordosis 55 --kyphosis 40 -o models");
  command->add_option("-o,--output", options->output, "Folder to write into (default: mjcf)");
  command->add_option("--anatomy", options->anatomy, "Folder of the anatomy tables");
  command->add_option("--stature", options->stature, "Stature [m]");
  command->add_option("--mass", options->mass, "Mass of the body [kg]");
  command->add_option("--sex", options->sex, "m or f")->check(CLI::IsMember({"m", "f"}));
  command->add_option("--lordosis", options->lordosis,
                      "Cobb angle from the upper endplate of L1 to that of S1 [deg]");
  command->add_option("--kyphosis", options->kyphosis,
                      "Cobb angle from the upper endplate of T4 to the lower one of T12 [deg]");
  command->add_option("--sacral-slope", options->sacral_slope,
                      "Angle of the S1 endplate against the horizontal [deg] (default: the one "
                      "that balances the body)");
  command->add_option("--threads", options->threads, "Threads (default: all)")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--torso", options->torso,
                   "detailed, fixed or simple; several with commas (default: all)")
      ->delimiter(',')
      ->check(CLI::IsMember({"detailed", "fixed", "simple"}));
  command->add_flag("--muscles", options->muscles,
                    "With the trunk's muscles: spatial tendons with actuators, off at control 0");
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options, command] { build(*options, *command); });
}

}  // namespace torso::tools
