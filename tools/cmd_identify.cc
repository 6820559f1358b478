// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "model/range_of_motion.h"
#include "tools/bone_files.h"
#include "tools/commands.h"
#include "tools/error.h"
#include "tools/files.h"
#include "tools/identify.h"
#include "tools/paths.h"
#include "tools/progress_bar.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegree = EIGEN_PI / 180;
constexpr const char* kTurnNames[] = {"flexion", "extension", "left_bending", "left_rotation"};
constexpr const char* kTable = "ligament_lengths.csv";

struct Options {
  std::string folder, targets;
  IdentifyOptions identify;
  FeasibilityOptions feasibility;
  bool check = false, json = false;
};

std::string turnName(Turn turn) { return kTurnNames[static_cast<int>(turn)]; }

// The table of ligament_lengths.csv: of levels that were not identified, as the anatomy has them.
std::string table(const Anatomy& anatomy, const Identification& result) {
  const Anatomy identified = withLengths(anatomy, result.lengths);
  std::vector<const Ligament*> ligaments;
  std::string text =
      "# l_max of the ligaments over their length at rest, by level; left and right alike. Written "
      "by torso identify.\ndisc";
  for (const Ligament& ligament : identified.ligaments) {
    if (ligament.side == Side::kRight) continue;
    ligaments.push_back(&ligament);
    text += "," + ligamentPair(ligament);
  }
  for (const Disc& disc : anatomy.discs) {
    if (!ligaments.front()->max_length_ratio.count(disc.name)) continue;
    text += "\n" + disc.name;
    for (const Ligament* ligament : ligaments) {
      text += fmt::format(",{:.4f}", ligament->max_length_ratio.at(disc.name));
    }
  }
  return text + "\n";
}

Json describe(const Identification& result) {
  Json lengths = Json::array(), reach = Json::array();
  for (const LigamentLength& l : result.lengths) {
    lengths.push_back({{"disc", l.disc},
                       {"ligament", l.ligament},
                       {"rest_mm", 1e3 * l.rest},
                       {"max_mm", 1e3 * l.max},
                       {"longest_in", turnName(l.turn)}});
  }
  for (const LevelReach& r : result.reach) {
    reach.push_back({{"disc", r.disc},
                     {"turn", turnName(r.turn)},
                     {"target_deg", r.target / kDegree},
                     {"without_ligaments_deg", r.reached / kDegree}});
  }
  return {{"lengths", lengths}, {"extreme_poses", reach}};
}

Json describe(const PoseReach& pose) {
  return {{"turn", turnName(pose.pose.turn)},
          {"target_deg", pose.pose.target / kDegree},
          {"reached_deg", pose.reached / kDegree},
          {"feasible", pose.feasible()}};
}

Json describe(const std::vector<LevelFeasibility>& levels, const FeasibilityOptions& options) {
  Json discs = Json::array();
  for (const LevelFeasibility& level : levels) {
    Json poses = Json::array(), shortenings = Json::array();
    for (const PoseReach& pose : level.poses) poses.push_back(describe(pose));
    for (const auto& s : level.shortenings) {
      shortenings.push_back({{"ligament", s.ligament},
                             {"loses", s.lost ? describe(*s.lost) : Json()},
                             {"slack", s.slack}});
    }
    discs.push_back({{"disc", level.disc}, {"poses", poses}, {"a_step_shorter", shortenings}});
  }
  return {{"actions", options.actions},
          {"seed", options.seed},
          {"step", options.step},
          {"discs", discs}};
}

void print(const Identification& result) {
  for (const LevelReach& r : result.reach) {
    if (r.reached > 0.999 * r.target) continue;
    fmt::print("{}: disc and facets alone let it turn by {:.1f} deg of {:.1f} in {}\n", r.disc,
               r.reached / kDegree, r.target / kDegree, turnName(r.turn));
  }
}

void print(const std::vector<LevelFeasibility>& levels, const FeasibilityOptions& options) {
  int poses = 0, reached = 0, ligaments = 0, hold = 0, slack = 0;
  for (const LevelFeasibility& level : levels) {
    fmt::print("{:<8}", level.disc);
    for (const PoseReach& p : level.poses) {
      poses++;
      reached += p.feasible();
      fmt::print("{:>15} {:4.1f} of {:4.1f}{}", turnName(p.pose.turn), p.reached / kDegree,
                 p.pose.target / kDegree, p.feasible() ? "" : " MISSED");
    }
    fmt::print("\n");
    for (const auto& s : level.shortenings) {
      ligaments++;
      hold += s.lost.has_value();
      slack += !s.lost && s.slack;
      if (s.lost) continue;
      fmt::print("{:<8}{} could be shorter{}\n", "", s.ligament,
                 s.slack ? "; it is slack in all poses" : "");
    }
  }
  fmt::print(
      "{} of {} extreme poses [deg] reached by {} actions each (seed {})\n"
      "{} of {} ligaments, made shorter by {:g} % of their length at rest, make a pose "
      "unreachable; {} of the others are slack in all poses\n",
      reached, poses, options.actions, options.seed, hold, ligaments, 100 * options.step, slack);
}

void checkOptions(const Options& options, const Anatomy& anatomy) {
  for (const std::string& name : options.identify.discs) {
    if (std::none_of(anatomy.discs.begin(), anatomy.discs.end(), [&](const Disc& disc) {
          return disc.name == name && disc.upper != anatomy.c2.name;
        })) {
      throw Error(
          fmt::format("--level {}: no level with ligaments has this name; they are L5/S1 "
                      "... C3/C4",
                      name));
    }
  }
  for (const std::string& name : options.identify.order) {
    std::string known;
    bool found = false;
    for (const Ligament& ligament : anatomy.ligaments) {
      if (ligament.side == Side::kRight) continue;
      found = found || ligamentPair(ligament) == name;
      known += " " + ligamentPair(ligament);
    }
    if (!found) throw Error(fmt::format("--order {}: the ligaments are{}", name, known));
  }
  for (const Disc& disc : anatomy.discs) {
    if (!options.identify.targets.count(disc.name)) {
      throw Error(fmt::format("{}: no rows for {}", options.targets, disc.name));
    }
  }
}

void identify(Options options) {
  const Anatomy anatomy = Anatomy::load(anatomyFolder());
  options.identify.targets =
      options.targets.empty() ? anatomy.range_of_motion : readRangeOfMotion(options.targets);
  checkOptions(options, anatomy);
  const std::string folder = options.folder.empty() ? anatomyFolder() : options.folder;
  if (!options.check) makeFolder(folder);
  const Skeleton skeleton = readSkeleton(anatomy, mjcfFolder() + "/assets", spineBodies(anatomy));
  options.identify.threads = options.feasibility.threads =
      static_cast<int>(std::thread::hardware_concurrency());
  Json json;
  if (options.check) {
    std::vector<LevelFeasibility> levels;
    {
      const ProgressBar bar;
      const Identification present = presentLengths(
          anatomy, skeleton, options.identify, [&bar](double share) { bar.show(0.3 * share); });
      levels = checkFeasibility(anatomy, skeleton, present, options.feasibility,
                                [&bar](double share) { bar.show(0.3 + 0.7 * share); });
    }
    if (options.json) {
      json = describe(levels, options.feasibility);
    } else {
      print(levels, options.feasibility);
    }
  } else {
    Identification result;
    {
      const ProgressBar bar;
      result = identifyLigaments(anatomy, skeleton, options.identify,
                                 [&bar](double share) { bar.show(share); });
    }
    const std::string path = folder + "/" + kTable;
    writeFile(path, table(anatomy, result));
    if (options.json) {
      json = describe(result);
      json["table"] = path;
    } else {
      print(result);
      fmt::print("written: {}\n", path);
    }
  }
  if (options.json) std::cout << json.dump(2) << '\n';
}

}  // namespace

void addIdentify(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "identify", "Find the ligaments' lengths from the published range of motion.");
  command->footer(
      "Without its ligaments each segment is turned into the extreme poses of\n"
      "model/anatomy/range_of_motion.csv, or as far as the moments of torso rom turn it; a "
      "ligament\n"
      "holds at the longest that it gets there. Ligaments that are left with slack are then\n"
      "shortened one after the other until the segment would lose a pose: those of --order first,\n"
      "then those that are longest in one pose by far. Writes ligament_lengths.csv; models see it\n"
      "after `torso build`. Nothing is random. It takes about a minute and writes at the end, so\n"
      "that an interrupted run changes nothing; --level does some levels again and keeps the\n"
      "others' rows.\n\n"
      "--check tests the lengths of the table instead: the segment, with disc, facets and\n"
      "ligaments, must reach each extreme pose under random actions, and must not with any one\n"
      "ligament shorter by --step, unless that is slack in all poses.\n\n"
      "Examples:\n"
      "  torso identify\n"
      "  torso identify --targets my_range_of_motion.csv --order CL_dorsal CL_ventral --out out\n"
      "  torso identify --level L4/L5 --json\n"
      "  torso identify --check --actions 20 --seed 7");
  command->add_option("--out", options->folder,
                      "Write ligament_lengths.csv into this folder; by default the anatomy's own");
  command->add_option("--level", options->identify.discs, "Only these levels, e.g. L4/L5");
  command
      ->add_option("--targets", options->targets,
                   "Table with the extreme poses, of the form of range_of_motion.csv")
      ->check(CLI::ExistingFile);
  command->add_option("--order", options->identify.order,
                      "Ligaments to tighten first, e.g. ALL_mid ISL");
  CLI::Option* check =
      command->add_flag("--check", options->check, "Test the lengths of the table, write nothing");
  command
      ->add_option("--actions", options->feasibility.actions,
                   "Moments tried for each pose, one pure and the others random")
      ->needs(check)
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--seed", options->feasibility.seed, "Of the random actions")
      ->needs(check)
      ->capture_default_str();
  command
      ->add_option("--step", options->feasibility.step,
                   "Shorten ligaments by this share of their length at rest")
      ->needs(check)
      ->check(CLI::Range(0.001, 0.5))
      ->capture_default_str();
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options] { identify(*options); });
}

}  // namespace torso::tools
