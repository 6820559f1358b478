// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "tools/ablation.h"
#include "tools/bone_files.h"
#include "tools/commands.h"
#include "tools/gnuplot.h"
#include "tools/paths.h"
#include "tools/progress_bar.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegree = EIGEN_PI / 180;

struct Options {
  int mixtures = 24;
  unsigned seed = 1;
  bool json = false;
  std::string plot_folder;
};

Json describe(const Anatomy& anatomy, const SpineAblation& spine) {
  const auto [least, largest] =
      std::minmax_element(spine.l5_flexion.begin(), spine.l5_flexion.end());
  Json json = {{"l5_least_deg", *least / kDegree}, {"l5_largest_deg", *largest / kDegree}};
  if (!spine.bend.levels.empty()) {
    Json levels;
    for (std::size_t i = 0; i < spine.bend.levels.size(); i++) {
      levels[anatomy.discs[i].name] = spine.bend.levels[i] / kDegree;
    }
    json["forward_bend"] = {{"moment_nm", spine.bend.moment},
                            {"largest_share", spine.bend.largestShare()},
                            {"levels_for_half", spine.bend.levelsForHalf()},
                            {"flexion_deg", levels}};
  }
  for (const GapStatistics& gap : spine.gaps) {
    json["gaps"].push_back({{"disc", gap.disc},
                            {"rest_mm", gap.rest * 1e3},
                            {"mean_mm", gap.mean * 1e3},
                            {"deviation_mm", gap.deviation * 1e3},
                            {"collisions", gap.collisions}});
  }
  return json;
}

void print(const AblationReport& report) {
  fmt::print("{:<46}{:>12}{:>20}\n", "", "whole", "without ligaments");
  const auto range = [](const SpineAblation& spine) {
    const auto [least, largest] =
        std::minmax_element(spine.l5_flexion.begin(), spine.l5_flexion.end());
    return fmt::format("{:.1f} to {:.1f}", *least / kDegree, *largest / kDegree);
  };
  const SpineAblation &a = report.whole, &b = report.without_ligaments;
  fmt::print("{:<46}{:>12}{:>20}\n", "L5 against the sacrum, extension to flexion [deg]", range(a),
             range(b));
  fmt::print("{:<46}{:>12.1f}{:>20.1f}\n", "trunk bent by 65 deg: moment at L5/S1 [Nm]",
             a.bend.moment, b.bend.moment);
  fmt::print("{:<46}{:>12.2f}{:>20.2f}\n", "  largest share of a level", a.bend.largestShare(),
             b.bend.largestShare());
  fmt::print("{:<46}{:>12}{:>20}\n", "  levels that make up half", a.bend.levelsForHalf(),
             b.bend.levelsForHalf());
  fmt::print("\n{:<8}{:>12}{:>26}{:>13}{:>26}{:>13}\n", "level", "gap at rest", "whole, mean +- sd",
             "collisions", "without discs", "collisions");
  for (int i = static_cast<int>(a.gaps.size()) - 1; i >= 0; i--) {
    const GapStatistics &g = a.gaps[i], &h = report.without_discs.gaps[i];
    fmt::print("{:<8}{:>9.1f} mm{:>26}{:>12.0f}%{:>26}{:>12.0f}%\n", g.disc, g.rest * 1e3,
               fmt::format("{:.1f} +- {:.1f}", g.mean * 1e3, g.deviation * 1e3), 100 * g.collisions,
               fmt::format("{:.1f} +- {:.1f}", h.mean * 1e3, h.deviation * 1e3),
               100 * h.collisions);
  }
}

void ablate(const Options& options) {
  const Anatomy anatomy = Anatomy::load(anatomyFolder());
  const Skeleton skeleton = readSkeleton(anatomy, mjcfFolder() + "/assets", spineBodies(anatomy));
  const int threads = static_cast<int>(std::thread::hardware_concurrency());
  AblationReport report;
  {
    const ProgressBar bar;
    report = measureAblation(anatomy, skeleton, options.mixtures, options.seed, threads,
                             [&bar](double share) { bar.show(share); });
  }
  if (options.json) {
    const Json json = {{"whole", describe(anatomy, report.whole)},
                       {"without_ligaments", describe(anatomy, report.without_ligaments)},
                       {"without_discs", describe(anatomy, report.without_discs)}};
    std::cout << json.dump(2) << '\n';
  } else {
    print(report);
    std::fflush(stdout);
  }
  if (options.plot_folder.empty()) return;
  writeAblationPlots(options.plot_folder, anatomy, report);
  if (!runGnuplot(options.plot_folder, "ablation.gp")) {
    std::cerr << fmt::format(
        "torso ablate: {}: holds the tables and ablation.gp but no picture, as there is no gnuplot "
        "on this machine (Debian: apt install gnuplot-nox)\n",
        options.plot_folder);
  }
}

}  // namespace

void addAblate(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("ablate", "What ligaments and discs do: the spine with and without them.");
  command->footer(
      "The whole spine with the rib cage, pelvis clamped, in the motions of torso rom --whole, as\n"
      "it is, without ligaments, and without discs (a thousandth of their stiffness).\n"
      "Ligaments: how far L5 turns against the sacrum in all poses; and how a forward bend of the\n"
      "trunk by 65 degrees, by moments in proportion to those of its weight, is shared by L5/S1 -\n"
      "T1/T2. Discs: the least distance from the lower face of each vertebral body, as a "
      "cylinder,\n"
      "to the mesh of the bone below, and the share of poses in which they collide.\n\n"
      "Examples:\n"
      "  torso ablate\n"
      "  torso ablate --plot out/ablation\n"
      "  torso ablate --json | jq .without_ligaments.forward_bend");
  command->add_option("--mixtures", options->mixtures, "So many random mixtures of motions")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Of the mixtures")->capture_default_str();
  command->add_flag("--json", options->json, "Print JSON");
  command->add_option("--plot", options->plot_folder,
                      "Write tables and a picture (gnuplot) into this folder");
  command->callback([options] { ablate(*options); });
}

}  // namespace torso::tools
