// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

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
#include "tools/paths.h"
#include "tools/pressure_study.h"
#include "tools/progress_bar.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kMeasuredDisc = "L4/L5";

struct Options {
  std::vector<std::string> activities;
  bool muscles = true, json = false;
};

const DiscLoad& at(const Loading& loading, const std::string& disc) {
  for (const DiscLoad& load : loading.discs) {
    if (load.disc == disc) return load;
  }
  throw Error("the model has no disc " + disc);
}

Json describe(const Loading& loading) {
  Json discs = Json::array();
  for (const DiscLoad& load : loading.discs) {
    discs.push_back({{"disc", load.disc},
                     {"nucleus_pressure_mpa", load.nucleus_pressure / 1e6},
                     {"surface_pressure_mpa", load.surface_pressure / 1e6},
                     {"compression_n", load.compression}});
  }
  return {{"discs", discs}, {"servo_flexion_moments_nm", loading.servo_moments}};
}

Json describe(const std::vector<ActivityLoads>& all) {
  Json activities = Json::array();
  for (const ActivityLoads& loads : all) {
    Json entry = {{"activity", loads.activity.name},
                  {"title", loads.activity.title},
                  {"measured_mpa", loads.activity.pressure / 1e6},
                  {"servos", describe(loads.servos)}};
    if (!loads.muscles.discs.empty()) {
      entry["muscles"] = describe(loads.muscles);
      entry["muscle_forces_n"] = loads.group_force;
      entry["largest_muscle_stress_mpa"] = loads.largest_stress / 1e6;
    }
    activities.push_back(entry);
  }
  return {{"disc", kMeasuredDisc}, {"activities", activities}};
}

void print(const std::vector<ActivityLoads>& all, bool muscles) {
  fmt::print("{}: pressure of the nucleus [MPa], of the surface in brackets; compression [N]\n",
             kMeasuredDisc);
  fmt::print("{:<38}{:>9}{:>15}{:>7}", "", "measured", "servos", "N");
  if (muscles) fmt::print("{:>15}{:>7}{:>7}{:>9}", "muscles", "N", "off", "stress");
  fmt::print("\n");
  for (const ActivityLoads& loads : all) {
    const DiscLoad& servos = at(loads.servos, kMeasuredDisc);
    fmt::print("{:<38}{:>9.2f}{:>8.2f} ({:4.2f}){:>7.0f}", loads.activity.title,
               loads.activity.pressure / 1e6, servos.nucleus_pressure / 1e6,
               servos.surface_pressure / 1e6, servos.compression);
    if (muscles) {
      const DiscLoad& with = at(loads.muscles, kMeasuredDisc);
      fmt::print("{:>8.2f} ({:4.2f}){:>7.0f}{:>+6.0f}%{:>9.2f}", with.nucleus_pressure / 1e6,
                 with.surface_pressure / 1e6, with.compression,
                 100 * (with.nucleus_pressure / loads.activity.pressure - 1),
                 loads.largest_stress / 1e6);
    }
    fmt::print("\n");
  }
}

void pressure(const Options& options) {
  const Anatomy anatomy = Anatomy::load(anatomyFolder());
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
  const Skeleton skeleton = readSkeleton(anatomy, mjcfFolder() + "/assets", spineBodies(anatomy));
  PosedBody body(anatomy, skeleton);
  const MuscleMoments moments(body.model());
  std::vector<ActivityLoads> results;
  {
    const ProgressBar bar;
    for (const Activity& activity : chosen) {
      bar.show(static_cast<double>(results.size()) / chosen.size());
      results.push_back(measureActivity(body, moments, activity, options.muscles));
    }
  }
  if (options.json) {
    std::cout << describe(results).dump(2) << '\n';
  } else {
    print(results, options.muscles);
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
      "L5/S1 to T10/T11 with the least sum of squared stresses. The measured pressure is that in\n"
      "the nucleus of L4/L5 (Wilke et al. 1999, 2001); ours is above that of the unloaded disc.\n\n"
      "Examples:\n"
      "  torso pressure\n"
      "  torso pressure --activity standing hold_close --no-muscles\n"
      "  torso pressure --json | jq '.activities[] | .muscles.discs'");
  command->add_option("--activity", options->activities, "Only these, by their names in the table");
  command->add_flag("--muscles,!--no-muscles", options->muscles,
                    "Whether muscles take over from the servos (default: they do)");
  command->add_flag("--json", options->json, "Print JSON, with all discs and muscles");
  command->callback([options] { pressure(*options); });
}

}  // namespace torso::tools
