// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "tools/bone_files.h"
#include "tools/commands.h"
#include "tools/files.h"
#include "tools/identify.h"
#include "tools/paths.h"
#include "tools/progress_bar.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegree = EIGEN_PI / 180;
constexpr const char* kTurnNames[] = {"flexion", "extension", "bending", "rotation"};
constexpr const char* kTable = "ligament_lengths.csv";

struct Options {
  std::string folder;
  bool json = false;
};

std::string turnName(Turn turn) { return kTurnNames[static_cast<int>(turn)]; }

std::string table(const Identification& result) {
  std::string text =
      "# l_max of the ligaments over their length at rest, by level; left and right alike. Written "
      "by torso identify.\ndisc";
  std::map<std::string, std::string> rows;
  std::vector<std::string> discs;
  for (const LigamentLength& length : result.lengths) {
    if (!rows.count(length.disc)) discs.push_back(length.disc);
    if (length.disc == result.lengths.front().disc) text += "," + length.ligament;
    rows[length.disc] += fmt::format(",{:.4f}", length.max / length.rest);
  }
  text += "\n";
  for (const std::string& disc : discs) text += disc + rows[disc] + "\n";
  return text;
}

Json describe(const Identification& result, const std::string& path) {
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
                     {"reached_deg", r.reached / kDegree}});
  }
  return {{"table", path}, {"lengths", lengths}, {"extreme_poses", reach}};
}

void print(const Identification& result, const std::string& path) {
  for (const LevelReach& r : result.reach) {
    if (r.reached > 0.999 * r.target) continue;
    fmt::print("{}: disc and facets alone let it turn by {:.1f} deg of {:.1f} in {}\n", r.disc,
               r.reached / kDegree, r.target / kDegree, turnName(r.turn));
  }
  fmt::print("written: {}\n", path);
}

void identify(const Options& options) {
  const Anatomy anatomy = Anatomy::load(anatomyFolder());
  const std::string folder = options.folder.empty() ? anatomyFolder() : options.folder;
  makeFolder(folder);
  const Skeleton skeleton = readSkeleton(anatomy, mjcfFolder() + "/assets", spineBodies(anatomy));
  const int threads = static_cast<int>(std::thread::hardware_concurrency());
  Identification result;
  {
    const ProgressBar bar;
    result = identifyLigaments(anatomy, skeleton, {}, threads,
                               [&bar](double share) { bar.show(share); });
  }
  const std::string path = folder + "/" + kTable;
  writeFile(path, table(result));
  if (options.json) {
    std::cout << describe(result, path).dump(2) << '\n';
  } else {
    print(result, path);
  }
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
      "holds at the longest that it gets there. Writes ligament_lengths.csv; models see it after\n"
      "`torso build`.\n\n"
      "Examples:\n"
      "  torso identify\n"
      "  torso identify --out out --json");
  command->add_option("--out", options->folder,
                      "Write ligament_lengths.csv into this folder; by default the anatomy's own");
  command->add_flag("--json", options->json, "Print JSON, with the poses that were reached");
  command->callback([options] { identify(*options); });
}

}  // namespace torso::tools
