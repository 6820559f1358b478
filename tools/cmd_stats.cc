// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>

#include "tools/bone_files.h"
#include "tools/commands.h"
#include "tools/error.h"
#include "tools/files.h"
#include "tools/gnuplot.h"
#include "tools/motion_statistics.h"
#include "tools/paths.h"
#include "tools/progress_bar.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegree = EIGEN_PI / 180;

struct Options {
  std::string folder, plot_folder;
  bool json = false, only_whole = false;
  MotionStatisticsOptions statistics;
};

// Flexion of L5 on the sacrum [rad]: least, 2.5 %, median, 97.5 % and largest.
std::array<double, 5> l5Flexion(const SpineMotions& motions) {
  std::vector<double> angles = motions.turns[0][1];
  std::sort(angles.begin(), angles.end());
  std::array<double, 5> result = {0, 0.025, 0.5, 0.975, 1};
  for (double& x : result) {
    x = angles[static_cast<std::size_t>(std::lround(x * (angles.size() - 1.0)))];
  }
  return result;
}

Json describe(const SpineMotions& motions) {
  if (motions.turns.empty()) return nullptr;
  Json json;
  json["frames"] = motions.turns[0][0].size();
  const auto l5 = l5Flexion(motions);
  for (int i = 0; i < 5; i++) {
    const char* names[] = {"least", "2.5 %", "median", "97.5 %", "largest"};
    json["l5_flexion_deg"][names[i]] = l5[i] / kDegree;
  }
  for (std::size_t i = 0; i < motions.gaps.size(); i++) {
    const LevelSpread& spread = motions.spread[i];
    const GapStatistics& gap = motions.gaps[i];
    json["levels"].push_back({{"disc", gap.disc},
                              {"flexion_extension_deg", spread.flexion_extension / kDegree},
                              {"lateral_bending_deg", spread.lateral_bending / kDegree},
                              {"axial_rotation_deg", spread.axial_rotation / kDegree},
                              {"gap_rest_mm", gap.rest * 1e3},
                              {"gap_mean_mm", gap.mean * 1e3},
                              {"gap_deviation_mm", gap.deviation * 1e3},
                              {"collisions", gap.collisions}});
  }
  return json;
}

void print(const Anatomy& anatomy, const MotionStatistics& statistics) {
  fmt::print("{} clips, {:.0f} s, {} frames\n", statistics.clips.size(), statistics.seconds,
             statistics.whole.turns[0][0].size());
  fmt::print("\n{:<8}{:>26}{:>26}{:>26}\n", "[deg]", "flexion and extension",
             "lateral bending, one side", "axial rotation, one side");
  fmt::print("{:<8}", "level");
  for (int i = 0; i < 3; i++) fmt::print("{:>10}{:>16}", "ours", "human");
  fmt::print("\n");
  std::array<int, 3> inside = {};
  for (std::size_t i = anatomy.discs.size(); i-- > 0;) {
    const std::string& name = anatomy.discs[i].name;
    const LevelSpread& spread = statistics.whole.spread[i];
    const RangeOfMotion& human = anatomy.range_of_motion.at(name);
    fmt::print("{:<8}", name);
    const double ours[] = {spread.flexion_extension, spread.lateral_bending, spread.axial_rotation};
    for (int k = 0; k < 3; k++) {
      const MotionRange& range =
          human[std::array{kFlexionExtension, kLateralBending, kAxialRotation}[k]];
      inside[k] += ours[k] >= range.low && ours[k] <= range.high;
      fmt::print("{:>10.1f}{:>16}", ours[k] / kDegree,
                 fmt::format("{:.1f} ({:.0f} - {:.0f})", range.mean / kDegree, range.low / kDegree,
                             range.high / kDegree));
    }
    fmt::print("\n");
  }
  fmt::print("{:<8}{:>26}{:>26}{:>26}\n", "inside", inside[0], inside[1], inside[2]);

  fmt::print("C2/C3: ours with all motion of the head above, as C1 and C2 move with it\n");

  const bool others = !statistics.without_discs.gaps.empty();
  fmt::print("\n{:<8}{:>12}{:>18}{:>12}", "level", "gap at rest", "mean +- sd", "collisions");
  if (others) fmt::print("{:>20}{:>12}", "without discs", "collisions");
  fmt::print("\n");
  const auto row = [](const GapStatistics& gap) {
    return fmt::format("{:.1f} +- {:.1f} mm", gap.mean * 1e3, gap.deviation * 1e3);
  };
  for (std::size_t i = statistics.whole.gaps.size(); i-- > 0;) {
    const GapStatistics& gap = statistics.whole.gaps[i];
    fmt::print("{:<8}{:>9.1f} mm{:>18}{:>10.1f} %", gap.disc, gap.rest * 1e3, row(gap),
               100 * gap.collisions);
    if (others) {
      const GapStatistics& other = statistics.without_discs.gaps[i];
      fmt::print("{:>20}{:>10.1f} %", row(other), 100 * other.collisions);
    }
    fmt::print("\n");
  }
  fmt::print("\nflexion of L5 on the sacrum [deg]: least, 2.5 %, median, 97.5 %, largest\n");
  for (const auto& [name, motions] : {std::pair{"with ligaments", &statistics.whole},
                                      {"without", &statistics.without_ligaments}}) {
    if (motions->turns.empty()) continue;
    fmt::print("{:<16}", name);
    for (const double angle : l5Flexion(*motions)) fmt::print("{:>8.1f}", angle / kDegree);
    fmt::print("\n");
  }
}

void run(Options options) {
  if (!options.plot_folder.empty()) checkFolder(options.plot_folder);
  options.statistics.without = !options.only_whole;
  const Anatomy anatomy = Anatomy::load(anatomyFolder());
  const Skeleton skeleton = readSkeleton(anatomy, mjcfFolder() + "/assets", spineBodies(anatomy));
  MotionStatistics statistics;
  {
    const ProgressBar bar;
    statistics = measureMotions(anatomy, skeleton, options.folder, options.statistics,
                                [&bar](double share) { bar.show(share); });
  }
  for (const std::string& error : statistics.errors) {
    std::cerr << fmt::format("torso stats: {}\n", error);
  }
  if (statistics.clips.empty()) throw Error("no clip could be used");
  if (options.json) {
    const Json json = {{"clips", statistics.clips},
                       {"seconds", statistics.seconds},
                       {"whole", describe(statistics.whole)},
                       {"without_ligaments", describe(statistics.without_ligaments)},
                       {"without_discs", describe(statistics.without_discs)}};
    std::cout << json.dump(2) << std::endl;
  } else {
    print(anatomy, statistics);
    std::fflush(stdout);
  }
  if (!options.plot_folder.empty()) {
    writeMotionPlots(options.plot_folder, anatomy, statistics);
    runGnuplot("stats", options.plot_folder, "stats.gp");
  }
  if (!statistics.errors.empty()) {
    throw Error(fmt::format("{} failed, {} went through", statistics.errors.size(),
                            statistics.clips.size()));
  }
}

}  // namespace

void addStats(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "stats",
      "How far vertebrae move in retrofitted motions, with and without discs or ligaments.");
  command->footer(
      "Of all clips that torso retrofit has written into FOLDER:\n"
      "  range of motion of each level, without the outer 5 % of frames, beside that of humans;\n"
      "  distance of neighbouring vertebral bodies (the upper one's lower face, as a cylinder's, "
      "to\n"
      "  the mesh below) and how often they collide, with discs and without;\n"
      "  flexion of L5 on the sacrum, with ligaments and without.\n"
      "'Without': the spine finds its equilibrium again, with head, upper arms and pelvis where "
      "the\n"
      "motion has them. These motions are kept in FOLDER/without_discs and "
      "FOLDER/without_ligaments,\n"
      "for torso view and render --motion; after Ctrl-C the same command goes on where it was.\n\n"
      "Examples:\n"
      "  torso retrofit clips/ -o out && torso stats out --plot figures\n"
      "  torso stats out --only-whole            seconds instead of minutes\n"
      "  torso stats out --json | jq '.whole.levels[0]'");
  command->add_option("FOLDER", options->folder, "Output of torso retrofit")->required();
  command->add_flag("--only-whole", options->only_whole,
                    "Leave out what needs the motions to be solved again");
  command
      ->add_option("--every", options->statistics.every,
                   "Solve again and measure distances in each so many frames")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--jobs", options->statistics.threads, "Clips worked on at a time")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->add_flag("--json", options->json, "Print JSON");
  command->add_option("--plot", options->plot_folder,
                      "Write tables and pictures (gnuplot) into this folder");
  command->callback([options] { run(*options); });
}

}  // namespace torso::tools
