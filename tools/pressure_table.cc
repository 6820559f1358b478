// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/pressure_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace torso::tools {
namespace {

constexpr const char* kLevels[] = {"L5/S1", "L4/L5",  "L3/L4",  "L2/L3",
                                   "L1/L2", "T12/L1", "T9/T10", "T6/T7"};
constexpr const char* kNachemsonsDisc = "L3/L4";

double mostServos(const Loading& loading) {
  double most = 0;
  for (const double moment : loading.servo_moments) most = std::max(most, std::abs(moment));
  return most;
}

}  // namespace

void printPressures(const std::vector<ActivityLoads>& all) {
  const bool muscles = !all.front().muscles.discs.empty();
  const double area = all.front().servos.at(kMeasuredDisc).area;
  const bool same_area = std::abs(area / kSubjectsArea - 1) < 1e-3;
  fmt::print(
      "{}: pressure in the nucleus [MPa] on a disc of the measured man's {:.0f} mm2{};\n"
      "{:.2f} of the unloaded disc included; compression [N]; left: the most that servos still\n"
      "give at one of the discs from L5/S1 to T12/L1 [Nm]\n",
      kMeasuredDisc, kSubjectsArea * 1e6,
      same_area ? "" : fmt::format(", in brackets\non ours of {:.0f}", area * 1e6),
      kUnloadedPressure / 1e6);
  fmt::print("{:<38}{:>8}{:>16}{:>7}", "", "in vivo", "servos only", "[N]");
  if (muscles) fmt::print("{:>16}{:>7}{:>12}{:>7}", "muscles", "[N]", "to in vivo", "left");
  fmt::print("\n");
  const auto figures = [&](const DiscLoad& load) {
    const std::string ours =
        same_area ? "" : fmt::format(" ({:4.2f})", load.nucleus_pressure / 1e6);
    return fmt::format("{:>9.2f}{:7}{:>7.0f}", load.pressureOnSubjectsArea() / 1e6, ours,
                       load.compression);
  };
  for (const ActivityLoads& loads : all) {
    const double measured = loads.activity.pressure;
    fmt::print("{:<38}{:>8.2f}{}", loads.activity.title, measured / 1e6,
               figures(loads.servos.at(kMeasuredDisc)));
    if (muscles) {
      const DiscLoad& with = loads.muscles.at(kMeasuredDisc);
      fmt::print("{}{:>+10.0f} %{:>7.1f}", figures(with),
                 100 * (with.pressureOnSubjectsArea() / measured - 1), mostServos(loads.muscles));
    }
    fmt::print("\n");
  }
}

void printBalance(const std::vector<ActivityLoads>& all) {
  fmt::print(
      "\n{}, by statics: moments that extend the spine [Nm], of muscles, of the pressure in the\n"
      "abdomen (and that, in kPa) and of disc, facets and ligaments, against that of weight and\n"
      "load; muscles' pull along the disc [N], all on both sides, and its arm behind the disc "
      "[mm]\n"
      "(erector spinae alone in scans: 50 - 66); compression [N], and {} x {:.0f} mm2 x the "
      "measured\n"
      "pressure (Nachemson 1960); pressure over compression per area of the disc (1.3 - 1.66 in\n"
      "laboratories); lean of the whole body that balances it [deg]\n",
      kMeasuredDisc, kForceOverPressure, kSubjectsArea * 1e6);
  fmt::print("{:<38}{:>6}{:>8}{:>9}{:>7}{:>7}{:>7}{:>7}{:>5}{:>7}{:>9}{:>7}\n", "", "lean",
             "weight", "muscles", "abd.", "[kPa]", "spine", "pull", "arm", "force", "in vivo",
             "ratio");
  for (const ActivityLoads& loads : all) {
    if (loads.activity.held == Held::kBed) continue;  // which carries part of the weight above
    for (const Balance& b : loads.balance) {
      if (b.disc != kMeasuredDisc) continue;
      const DiscLoad& disc = loads.muscles.at(kMeasuredDisc);
      // Rounded here, for fmt 9.1 writes -9.99946 as "-10.".
      const double lean = std::round(loads.lean * 1800 / EIGEN_PI) / 10;
      fmt::print("{:<38}{:>6.1f}{:>8.0f}{:>9.0f}{:>7.1f}{:>7.1f}{:>7.1f}{:>7.0f}{:>5.0f}",
                 loads.activity.title, lean, b.external, -b.muscles, -b.abdomen,
                 loads.abdominal_pressure / 1e3, -b.passive(), b.muscle_pull,
                 -1e3 * b.muscles / b.muscle_pull);
      fmt::print("{:>7.0f}{:>9.0f}{:>7.2f}\n", disc.compression,
                 loads.activity.pressure * kForceOverPressure * kSubjectsArea,
                 disc.nucleus_pressure * disc.area / disc.compression);
    }
  }
}

void printLevels(const std::vector<ActivityLoads>& all) {
  fmt::print(
      "\nPressure in the nuclei of our discs [MPa]; compression of {} [N], and Nachemson's for a\n"
      "subject of 70 kg (1966-1970)\n{:<38}",
      kNachemsonsDisc, "");
  for (const char* level : kLevels) fmt::print("{:>8}", level);
  fmt::print("{:>9}{:>11}\n", kNachemsonsDisc, "published");
  for (const ActivityLoads& loads : all) {
    fmt::print("{:<38}", loads.activity.title);
    for (const char* level : kLevels) {
      fmt::print("{:>8.2f}", loads.muscles.at(level).nucleus_pressure / 1e6);
    }
    fmt::print("{:>9.0f}", loads.muscles.at(kNachemsonsDisc).compression);
    if (loads.activity.l3_load > 0) fmt::print("{:>11.0f}", loads.activity.l3_load);
    fmt::print("\n");
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

}  // namespace torso::tools
