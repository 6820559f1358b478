// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "model/parallel.h"
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
  int mixtures = 8;
  unsigned seed = 1;
  bool json = false;
  std::string only, plot_folder;
};

Json describe(const Anatomy& anatomy, const LumbarBends& spine) {
  const auto bend = [&](const BentPose& pose) -> Json {
    Json levels;
    for (std::size_t i = 0; i < pose.levels.size(); i++) {
      levels[anatomy.discs[i].name] = pose.levels[i] / kDegree;
    }
    return {{"moment_nm", pose.moment},
            {"flexion_deg", pose.flexion() / kDegree},
            {"largest_share", pose.largestShare()},
            {"levels_deg", levels}};
  };
  return {{"hanging_forward", bend(spine.forward.back())},
          {"hanging_backward", bend(spine.backward.back())},
          {"forward_bend", bend(bentBy(spine.forward, kForwardBend))}};
}

Json describe(const std::vector<GapStatistics>& gaps) {
  Json json = Json::array();
  for (const GapStatistics& gap : gaps) {
    json.push_back({{"disc", gap.disc},
                    {"rest_mm", gap.rest * 1e3},
                    {"mean_mm", gap.mean * 1e3},
                    {"deviation_mm", gap.deviation * 1e3},
                    {"collisions", gap.collisions}});
  }
  return json;
}

void printLigaments(const LumbarBends& a, const LumbarBends& b) {
  const auto row = [](const std::string& what, const std::string& whole,
                      const std::string& without) {
    fmt::print("{:<62}{:>15}{:>19}\n", what, whole, without);
  };
  const auto ends = [](double least, double most) {
    return fmt::format("{:.1f} to {:.1f}", least / kDegree, most / kDegree);
  };
  const auto l5 = [&](const LumbarBends& s) {
    return ends(s.backward.back().levels[0], s.forward.back().levels[0]);
  };
  const auto t12 = [&](const LumbarBends& s) {
    return ends(s.backward.back().flexion(), s.forward.back().flexion());
  };
  const BentPose pa = bentBy(a.forward, kForwardBend), pb = bentBy(b.forward, kForwardBend);
  const auto bent = [](const BentPose& pose) {
    return fmt::format("{:.0f} at {:.0f} Nm", pose.flexion() / kDegree, pose.moment);
  };
  const auto share = [](const BentPose& pose) {
    return fmt::format("{:.0f} %", 100 * pose.largestShare());
  };
  row("", "whole", "without ligaments");
  row(fmt::format("{:.0f} Nm of the hanging trunk at L5/S1, back to forward: L5 [deg]",
                  a.forward.back().moment),
      l5(a), l5(b));
  row("  T12 against the sacrum [deg]", t12(a), t12(b));
  row("bent forward by 65 deg, or as far as it goes [deg]", bent(pa), bent(pb));
  row("  share of the level that turns most", share(pa), share(pb));
}

void printDiscs(const AblationReport& report) {
  fmt::print("{:<8}{:>12}{:>26}{:>13}{:>26}{:>13}\n", "level", "gap at rest", "whole, mean +- sd",
             "collisions", "without discs", "collisions");
  for (int i = static_cast<int>(report.gaps.size()) - 1; i >= 0; i--) {
    const GapStatistics &g = report.gaps[i], &h = report.gaps_without_discs[i];
    fmt::print("{:<8}{:>9.1f} mm{:>26}{:>12.0f}%{:>26}{:>12.0f}%\n", g.disc, g.rest * 1e3,
               fmt::format("{:.1f} +- {:.1f}", g.mean * 1e3, g.deviation * 1e3), 100 * g.collisions,
               fmt::format("{:.1f} +- {:.1f}", h.mean * 1e3, h.deviation * 1e3),
               100 * h.collisions);
  }
}

void ablate(const Options& options) {
  const Anatomy anatomy = Anatomy::load(anatomyFolder());
  const Skeleton skeleton = readSkeleton(anatomy, mjcfFolder() + "/assets", spineBodies(anatomy));
  const bool ligaments = options.only != "discs", discs = options.only != "ligaments";
  AblationReport report;
  {
    const ProgressBar bar;
    if (ligaments) {
      report.whole = bendLumbarSpine(anatomy, skeleton, true);
      report.without_ligaments = bendLumbarSpine(anatomy, skeleton, false);
    }
    double done[2] = {0, 0};
    std::mutex mutex;
    forEach(discs ? 2 : 0, static_cast<int>(std::thread::hardware_concurrency()), [&](int i) {
      (i == 0 ? report.gaps : report.gaps_without_discs) =
          measureGaps(anatomy, skeleton, i == 0, options.mixtures, options.seed, [&](double share) {
            const std::lock_guard<std::mutex> lock(mutex);
            done[i] = share;
            bar.show((done[0] + done[1]) / 2);
          });
    });
  }
  if (options.json) {
    Json json;
    if (ligaments) {
      json["whole"] = describe(anatomy, report.whole);
      json["without_ligaments"] = describe(anatomy, report.without_ligaments);
    }
    if (discs) {
      json["gaps"] = describe(report.gaps);
      json["gaps_without_discs"] = describe(report.gaps_without_discs);
    }
    std::cout << json.dump(2) << '\n';
  } else {
    if (ligaments) printLigaments(report.whole, report.without_ligaments);
    if (ligaments && discs) fmt::print("\n");
    if (discs) printDiscs(report);
    std::fflush(stdout);
  }
  if (options.plot_folder.empty()) return;
  writeAblationPlots(options.plot_folder, anatomy, report);
  runGnuplot("ablate", options.plot_folder, "ablation.gp");
}

}  // namespace

void addAblate(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("ablate", "What ligaments and discs do: the spine with and without them.");
  command->footer(
      "Ligaments: the lumbar spine, sacrum clamped, under a third of the moments of the trunk's\n"
      "weight when it hangs forward or backward: how far L5 and T12 turn against the sacrum, and\n"
      "how a forward bend by 65 degrees is shared by L5/S1 - T12/L1.\n"
      "Discs (at a thousandth of their stiffness): the whole spine with the rib cage in the "
      "motions\n"
      "of torso rom --whole: the least distance from the lower face of each vertebral body, as a\n"
      "cylinder, to the mesh of the bone below, and the share of poses in which they collide.\n\n"
      "Examples:\n"
      "  torso ablate                              # minutes\n"
      "  torso ablate --only ligaments             # seconds\n"
      "  torso ablate --plot out/ablation\n"
      "  torso ablate --json | jq .without_ligaments.forward_bend");
  command->add_option("--only", options->only, "Leave out only these")
      ->check(CLI::IsMember({"ligaments", "discs"}));
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
