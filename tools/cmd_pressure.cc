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
#include "tools/muscle_arms.h"
#include "tools/paths.h"
#include "tools/pressure_plots.h"
#include "tools/pressure_study.h"
#include "tools/progress_bar.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kMeasuredDisc = "L4/L5";

struct Options {
  std::vector<std::string> activities;
  std::string plot;
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
  fmt::print(
      "{}: pressure in the nucleus [MPa], {:.2f} of the unloaded disc included; (surface): normal\n"
      "force over area, as in the paper; [subject]: on a disc of the measured man's {:.0f} mm2, "
      "ours\n"
      "has {:.0f}; force: compression [N]; left: the most that servos still give at one of the "
      "discs\n"
      "from L5/S1 to T12/L1 [Nm]\n",
      kMeasuredDisc, kUnloadedPressure / 1e6, kSubjectsArea * 1e6,
      all.front().servos.at(kMeasuredDisc).area * 1e6);
  fmt::print("{:<38}{:>8}{:>22}{:>7}", "", "in vivo", "servos only", "force");
  if (muscles) fmt::print("{:>22}{:>7}{:>13}{:>9}", "muscles", "force", "against it", "left");
  fmt::print("\n");
  const auto mpa = [](const DiscLoad& load) {
    return fmt::format("{:>8.2f} ({:4.2f}) [{:4.2f}]{:>7.0f}", load.nucleus_pressure / 1e6,
                       load.surface_pressure / 1e6, load.pressureOnSubjectsArea() / 1e6,
                       load.compression);
  };
  const auto left = [](const Loading& loading) {
    double most = 0;
    for (const double moment : loading.servo_moments) most = std::max(most, std::abs(moment));
    return most;
  };
  for (const ActivityLoads& loads : all) {
    const double measured = loads.activity.pressure;
    fmt::print("{:<38}{:>8.2f}{}", loads.activity.title, measured / 1e6,
               mpa(loads.servos.at(kMeasuredDisc)));
    if (muscles) {
      const DiscLoad& with = loads.muscles.at(kMeasuredDisc);
      fmt::print("{}{:>+5.0f} [{:+3.0f}] %{:>8.1f}", mpa(with),
                 100 * (with.nucleus_pressure / measured - 1),
                 100 * (with.pressureOnSubjectsArea() / measured - 1), left(loads.muscles));
    }
    fmt::print("\n");
  }
}

// Where the compression comes from, beside what the measured pressure stands for.
void explain(const std::vector<ActivityLoads>& all) {
  fmt::print(
      "\n{}: extending moments [Nm] that hold weight and load ({:s}), by muscles, pressure in the\n"
      "abdomen, passive spine and servos; muscles' pull along the disc [N] and their arm [mm]\n"
      "(published: erector spinae 50 - 66); compression [N] beside 0.66 x area x measured "
      "pressure\n"
      "(Nachemson 1960); nucleus pressure over compression per area (published 1.3 - 1.66)\n",
      kMeasuredDisc, "ext");
  fmt::print("{:<38}{:>6}{:>7}{:>7}{:>6}{:>6}{:>6}{:>6}{:>7}{:>5}{:>7}{:>8}{:>7}\n", "", "lean",
             "ext", "muscle", "abd.", "[kPa]", "pass.", "servo", "pull", "arm", "force", "in vivo",
             "ratio");
  for (const ActivityLoads& loads : all) {
    for (const Balance& b : loads.balance) {
      if (b.disc != kMeasuredDisc) continue;
      const DiscLoad& disc = loads.muscles.at(kMeasuredDisc);
      fmt::print(
          "{:<38}{:>6.1f}{:>7.0f}{:>7.0f}{:>6.1f}{:>6.1f}{:>6.1f}{:>6.1f}{:>7.0f}{:>5.0f}{:>7.0f}{:"
          ">8.0f}{:>7.2f}\n",
          loads.activity.title, loads.lean * 180 / EIGEN_PI, b.external, -b.muscles, -b.abdomen,
          loads.abdominal_pressure / 1e3, -b.passive(), -b.servos, b.muscle_pull,
          b.muscle_pull > 0 ? -1e3 * b.muscles / b.muscle_pull : 0, disc.compression,
          0.66 * kSubjectsArea * loads.activity.pressure,
          disc.nucleus_pressure * disc.area / disc.compression);
    }
  }
}

void printArms(const std::vector<MuscleArm>& arms) {
  fmt::print("moment arms, standing, one side, weighted by section [mm]; in brackets published\n");
  fmt::print("{:<20}{:<7}{:>28}{:>28}\n", "", "", "behind the disc (extension)",
             "beside (bending)");
  for (const MuscleArm& a : arms) {
    fmt::print("{:<20}{:<7}{:>12.0f} ({:>4.0f} - {:>4.0f}){:>14.0f} ({:>4.0f} - {:>4.0f}){}\n",
               a.muscle, a.disc, 1e3 * a.behind, 1e3 * a.behind_low, 1e3 * a.behind_high,
               1e3 * a.beside, 1e3 * a.beside_low, 1e3 * a.beside_high,
               a.inside() ? "" : "  outside");
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
  const Skeleton skeleton = readSkeleton(anatomy, mjcfFolder() + "/assets", bodyNames(anatomy));
  if (!options.plot.empty()) makeFolder(options.plot);
  PosedBody body(anatomy, skeleton, options.plot.empty() ? "" : mjcfFolder() + "/assets");
  const MuscleMoments moments(body.model());
  if (options.arms) {
    printArms(measureArms(anatomy, anatomyFolder(), body.model(), body.data(), moments));
    return;
  }
  std::vector<ActivityLoads> results;
  {
    const ProgressBar bar;
    for (const Activity& activity : chosen) {
      bar.show(static_cast<double>(results.size()) / chosen.size());
      results.push_back(measureActivity(body, moments, activity, options.muscles));
      if (!options.plot.empty()) writePosture(options.plot + "/" + activity.name + ".png", body);
    }
  }
  if (!options.plot.empty()) {
    writePressurePlot(options.plot, kMeasuredDisc, results);
    if (!runGnuplot(options.plot, "pressure.gp")) {
      fmt::print(stderr, "torso pressure: {}: no bars, as there is no gnuplot on this machine\n",
                 options.plot);
    }
  }
  if (options.json) {
    std::cout << describe(results).dump(2) << '\n';
  } else {
    print(results, options.muscles);
    if (options.explain) explain(results);
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
      "the nucleus of L4/L5 (Wilke et al. 1999, 2001).\n\n"
      "Examples:\n"
      "  torso pressure\n"
      "  torso pressure --activity standing hold_close --no-muscles\n"
      "  torso pressure --plot out\n"
      "  torso pressure --json | jq '.activities[] | .muscles.discs'");
  command->add_option("--activity", options->activities, "Only these, by their names in the table");
  command->add_flag("--muscles,!--no-muscles", options->muscles,
                    "Whether muscles take over from the servos (default: they do)");
  command->add_flag("--arms", options->arms,
                    "Print the muscles' moment arms beside published ones, and do no more");
  command->add_flag(
      "--explain", options->explain,
      "Print what carries the moment at L4/L5, beside what the measurement stands for");
  command->add_option("--plot", options->plot,
                      "Write pictures of the postures and bars of the pressures into this folder");
  command->add_flag("--json", options->json, "Print JSON, with all discs and muscles");
  command->callback([options] { pressure(*options); });
}

}  // namespace torso::tools
