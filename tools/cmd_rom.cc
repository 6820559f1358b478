// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "tools/bone_files.h"
#include "tools/commands.h"
#include "tools/error.h"
#include "tools/paths.h"
#include "tools/progress_bar.h"
#include "tools/rom_report.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegree = EIGEN_PI / 180;
constexpr const char* kTurnNames[] = {"flexion", "extension", "left_bending", "left_rotation"};

struct Options {
  std::vector<std::string> levels, without;
  bool follower = false, json = false;
};

Json describe(const Anatomy& anatomy, const RomReport& report) {
  Json motions = Json::array(), curves = Json::array(), regions = Json::array();
  int inside = 0;
  for (const LevelMotion& m : report.motions) {
    inside += m.inside();
    motions.push_back({{"disc", m.disc},
                       {"motion", motionName(m.motion)},
                       {"ours_deg", m.angle / kDegree},
                       {"mean_deg", m.range.mean / kDegree},
                       {"low_deg", m.range.low / kDegree},
                       {"high_deg", m.range.high / kDegree},
                       {"inside", m.inside()},
                       {"sources", m.range.sources}});
  }
  for (const LevelCurve& curve : report.curves) {
    Json moment = Json::array(), angle = Json::array();
    for (const SegmentPose& pose : curve.poses) {
      moment.push_back(pose.moment);
      angle.push_back(pose.angle / kDegree);
    }
    curves.push_back({{"disc", curve.disc},
                      {"turn", kTurnNames[static_cast<int>(curve.turn)]},
                      {"moment_nm", moment},
                      {"angle_deg", angle}});
  }
  for (Region region : kRegions) {
    Json sums;
    for (int k = 0; k < kNumMotions; k++) {
      const Motion motion = static_cast<Motion>(k);
      sums[motionName(motion) + "_deg"] = regionSum(anatomy, report, region, motion) / kDegree;
    }
    regions.push_back({{"region", regionName(region)}, {"sums", sums}});
  }
  return {{"inside", inside},
          {"entries", report.motions.size()},
          {"motions", motions},
          {"regions", regions},
          {"curves", curves}};
}

void print(const RomReport& report) {
  fmt::print("{:<9}", "segment");
  for (int k = 0; k < kNumMotions; k++) fmt::print("{:>25}", motionName(static_cast<Motion>(k)));
  fmt::print("\n");
  int inside = 0;
  std::string row;
  for (auto m = report.motions.rbegin(); m != report.motions.rend(); ++m) {  // from above
    inside += m->inside();
    row = fmt::format("{:>8.1f}{} ({:4.1f}, {:4.1f}-{:4.1f})", m->angle / kDegree,
                      m->inside()               ? ' '
                      : m->angle < m->range.low ? '<'
                                                : '>',
                      m->range.mean / kDegree, m->range.low / kDegree, m->range.high / kDegree) +
          row;
    if (m->motion != kFlexion) continue;
    fmt::print("{:<8}{}\n", m->disc, row);
    row.clear();
  }
  fmt::print("{} of {} inside the published range; in brackets its mean, least and largest [deg]\n",
             inside, report.motions.size());
}

void rom(const Options& options) {
  const Anatomy anatomy = Anatomy::load(anatomyFolder());
  for (const std::string& level : options.levels) {
    if (!anatomy.range_of_motion.count(level)) {
      throw Error(
          fmt::format("--level {}: no disc has this name; they are L5/S1 ... C2/C3", level));
    }
  }
  SegmentParts parts;
  for (const std::string& part : options.without) {
    (part == "ligaments" ? parts.ligaments : parts.facets) = false;
  }
  const Skeleton skeleton = readSkeleton(anatomy, mjcfFolder() + "/assets", spineBodies(anatomy));
  const int threads = static_cast<int>(std::thread::hardware_concurrency());
  RomReport report;
  {
    const ProgressBar bar;
    report = measureRom(anatomy, skeleton, options.levels, parts, options.follower, threads,
                        [&bar](double share) { bar.show(share); });
  }
  if (options.json) {
    std::cout << describe(anatomy, report).dump(2) << '\n';
  } else {
    print(report);
  }
}

}  // namespace

void addRom(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "rom", "Range of motion of each segment under pure moments, against published ranges.");
  command->footer(
      "Each pair of neighbouring bones with its disc, ligaments and facets, cut out of the body, "
      "the\n"
      "lower bone clamped, no gravity: a pure moment about an axis of the disc rises in steps, "
      "each\n"
      "held until the segment rests, to 7.5 Nm (lumbar), 5 Nm (thoracic) or 2 Nm (cervical).\n"
      "Bending and rotation to the left; the right side is its mirror image. The ranges and their\n"
      "sources are in model/anatomy/range_of_motion.csv. C2/C3 has no ligaments and no facets: "
      "the\n"
      "head's joint stands for the joints of C1 and C2, too.\n\n"
      "Examples:\n"
      "  torso rom\n"
      "  torso rom --level L4/L5 --without ligaments\n"
      "  torso rom --follower --json | jq .regions");
  command->add_option("--level", options->levels, "Only these segments, e.g. L4/L5");
  command->add_option("--without", options->without, "Leave these out: ligaments, facets")
      ->check(CLI::IsMember({"ligaments", "facets"}));
  command->add_flag("--follower", options->follower,
                    "Under a follower load: 400 N, in the neck 100 N");
  command->add_flag("--json", options->json, "Print JSON, with the curves");
  command->callback([options] { rom(*options); });
}

}  // namespace torso::tools
