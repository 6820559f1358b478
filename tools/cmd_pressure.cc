// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "model/skeleton.h"
#include "tools/bone_files.h"
#include "tools/commands.h"
#include "tools/error.h"
#include "tools/files.h"
#include "tools/gnuplot.h"
#include "tools/measured_man.h"
#include "tools/muscle_arms.h"
#include "tools/paths.h"
#include "tools/pressure_plots.h"
#include "tools/pressure_study.h"
#include "tools/pressure_table.h"
#include "tools/progress_bar.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::vector<std::string> activities, without;
  std::string plot, body = "measured";
  bool muscles = true, json = false, arms = false, explain = false;
};

Json describe(const Loading& loading) {
  Json discs = Json::array();
  for (const DiscLoad& load : loading.discs) {
    discs.push_back({{"disc", load.disc},
                     {"nucleus_pressure_mpa", load.nucleus_pressure / 1e6},
                     {"surface_pressure_mpa", load.surface_pressure / 1e6},
                     {"nucleus_pressure_area_of_subject_mpa", load.pressureOnSubjectsArea() / 1e6},
                     {"compression_n", load.compression},
                     {"area_mm2", load.area * 1e6}});
  }
  return {{"discs", discs}, {"servo_flexion_moments_nm", loading.servo_moments}};
}

Json describe(const std::vector<ActivityLoads>& all, const Options& options) {
  Json activities = Json::array();
  for (const ActivityLoads& loads : all) {
    Json entry = {
        {"activity", loads.activity.name},
        {"title", loads.activity.title},
        {"measured_mpa", loads.activity.pressure / 1e6},
        {"measured_as_force_n", loads.activity.pressure * kForceOverPressure * kSubjectsArea},
        {"published_l3_l4_n", loads.activity.l3_load},
        {"servos", describe(loads.servos)}};
    if (!loads.muscles.discs.empty()) {
      entry["muscles"] = describe(loads.muscles);
      entry["muscle_forces_n"] = loads.group_force;
      entry["largest_muscle_stress_mpa"] = loads.largest_stress / 1e6;
      entry["abdominal_pressure_kpa"] = loads.abdominal_pressure / 1e3;
      entry["lean_deg"] = loads.lean * 180 / EIGEN_PI;
      for (const Balance& b : loads.balance) {
        entry["balance"].push_back({{"disc", b.disc},
                                    {"weight_nm", b.external},
                                    {"muscles_nm", b.muscles},
                                    {"abdomen_nm", b.abdomen},
                                    {"servos_nm", b.servos},
                                    {"passive_nm", b.passive()},
                                    {"muscle_pull_n", b.muscle_pull},
                                    {"abdomen_push_n", b.abdomen_push}});
      }
    }
    activities.push_back(entry);
  }
  return {{"disc", kMeasuredDisc},
          {"body", options.body},
          {"without", options.without},
          {"activities", activities}};
}

Json describe(const std::vector<MuscleArm>& arms) {
  Json result = Json::array();
  for (const MuscleArm& a : arms) {
    result.push_back({{"muscle", a.muscle},
                      {"disc", a.disc},
                      {"behind_mm", 1e3 * a.behind},
                      {"behind_published_mm", {1e3 * a.behind_low, 1e3 * a.behind_high}},
                      {"beside_mm", 1e3 * a.beside},
                      {"beside_published_mm", {1e3 * a.beside_low, 1e3 * a.beside_high}}});
  }
  return {{"arms", result}};
}

void pressure(const Options& options) {
  if (options.explain && !options.muscles) throw Error("--explain is about muscles: it needs them");
  const Anatomy tables = Anatomy::load(anatomyFolder());
  const Anatomy anatomy = options.body == "tables" ? tables : measuredMan(tables);
  std::vector<Activity> chosen, all = readActivities(anatomyFolder());
  for (const Activity& activity : all) {
    if (options.activities.empty()) chosen.push_back(activity);
  }
  for (const std::string& name : options.activities) {
    std::string known;
    for (const Activity& activity : all) {
      if (activity.name == name) chosen.push_back(activity);
      known += (known.empty() ? "" : ", ") + activity.name;
    }
    if (chosen.empty() || chosen.back().name != name) {
      throw Error(
          fmt::format("--activity {}: there is none of this name; there are {}", name, known));
    }
  }
  const Skeleton skeleton = readSkeleton(anatomy, mjcfFolder() + "/assets", bodyNames(anatomy));
  if (!options.plot.empty()) makeFolder(options.plot);
  PosedBody body(anatomy, skeleton, options.plot.empty() ? "" : mjcfFolder() + "/assets");
  const MuscleMoments moments(body.model());
  if (options.arms) {
    const auto arms = measureArms(anatomy, anatomyFolder(), body.model(), body.data(), moments);
    if (options.json) {
      std::cout << describe(arms).dump(2) << '\n';
    } else {
      printArms(arms);
    }
    return;
  }
  Assumptions assumptions;
  for (const std::string& part : options.without) {
    (part == "abdomen" ? assumptions.abdomen : assumptions.coactivation) = false;
  }
  std::vector<ActivityLoads> results;
  {
    const ProgressBar bar;
    for (const Activity& activity : chosen) {
      bar.show(static_cast<double>(results.size()) / chosen.size());
      results.push_back(measureActivity(body, moments, activity, options.muscles, assumptions));
      // Who lies is simulated upright, under gravity from another side.
      if (options.plot.empty() || activity.held == Held::kBed) continue;
      writePosture(options.plot + "/" + activity.name + ".png", body);
    }
  }
  if (!options.plot.empty()) {
    writePressurePlot(options.plot, kMeasuredDisc, results);
    runGnuplot("pressure", options.plot, "pressure.gp");
  }
  if (options.json) {
    std::cout << describe(results, options).dump(2) << '\n';
  } else {
    printPressures(results);
    if (options.explain) {
      printBalance(results);
      printLevels(results);
    }
  }
}

}  // namespace

void addPressure(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "pressure", "Pressure in the discs in everyday activities, against what was measured.");
  command->footer(
      "Puts the whole body into the postures of model/anatomy/activities.csv and lets it come to\n"
      "rest, held by its servos, and then by muscles that give the servos' moments about the "
      "discs\n"
      "L5/S1 to T12/L1 with the least sum of squared stresses. The measured pressure is that in\n"
      "the nucleus of L4/L5 of one man (Wilke et al. 1999, 2001). The body is the tables' man with "
      "his\n"
      "mass and lumbar discs as large as his; --body tables: with the discs of the models.\n\n"
      "Examples:\n"
      "  torso pressure\n"
      "  torso pressure --body tables\n"
      "  torso pressure --activity standing hold_close --no-muscles\n"
      "  torso pressure --explain --plot out\n"
      "  torso pressure --json | jq '.activities[] | .muscles.discs'");
  command->add_option("--activity", options->activities, "Only these, by their names in the table");
  command
      ->add_option("--body", options->body, "Whose discs: those of the measured man or the tables'")
      ->check(CLI::IsMember({"measured", "tables"}))
      ->capture_default_str();
  command->add_flag("--muscles,!--no-muscles", options->muscles,
                    "Whether muscles take over from the servos (default: they do)");
  command
      ->add_option("--without", options->without,
                   "Leave out pressure in the abdomen or the muscles' coactivation")
      ->delimiter(',')
      ->check(CLI::IsMember({"abdomen", "coactivation"}));
  command->add_flag("--arms", options->arms,
                    "Print the muscles' moment arms beside published ones, and do no more");
  command->add_flag("--explain", options->explain,
                    "Print also what carries the moment about L4/L5, and the other discs, beside "
                    "published figures");
  command->add_option("--plot", options->plot,
                      "Write pictures of the postures and bars of the pressures into this folder");
  command->add_flag("--json", options->json, "Print JSON, with all discs and muscles");
  command->callback([options] { pressure(*options); });
}

}  // namespace torso::tools
