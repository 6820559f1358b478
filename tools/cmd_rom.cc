// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "tools/bone_files.h"
#include "tools/commands.h"
#include "tools/error.h"
#include "tools/gnuplot.h"
#include "tools/paths.h"
#include "tools/preload_study.h"
#include "tools/progress_bar.h"
#include "tools/rom_plots.h"
#include "tools/rom_report.h"
#include "tools/whole_spine_rom.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegree = EIGEN_PI / 180;
constexpr const char* kTurnNames[] = {"flexion", "extension", "left_bending", "left_rotation"};

// Where Lee et al. 2023 say that their model differs from people.
constexpr std::pair<const char*, Motion> kPaperMisses[] = {
    {"T1/T2", kFlexion}, {"T2/T3", kFlexion},          {"T3/T4", kFlexion},
    {"L1/L2", kFlexion}, {"L1/L2", kFlexionExtension}, {"C7/T1", kAxialRotation}};

struct Options {
  std::vector<std::string> levels, without;
  std::string plot_folder;
  bool follower = false, json = false;
};

struct WholeOptions {
  bool on = false;
  int mixtures = 24;
};

struct Report {
  RomReport rom;
  std::vector<MotionBounds> misses;  // of whole segments
  std::vector<PublishedKinematics> published;
};

// Ours beside a row of segment_kinematics.csv, or a motion of one of our levels without one.
struct Kinematics {
  std::string disc, quantity;
  double ours;
  const PublishedKinematics* published;
};

std::vector<Kinematics> kinematics(const Report& report) {
  std::vector<Kinematics> all;
  const auto add = [&](const std::string& disc, const std::string& quantity, double ours) {
    const auto row = std::find_if(
        report.published.begin(), report.published.end(),
        [&](const PublishedKinematics& p) { return p.disc == disc && p.quantity == quantity; });
    all.push_back({disc, quantity, ours, row == report.published.end() ? nullptr : &*row});
  };
  const auto& curves = report.rom.curves;
  for (std::size_t i = 0; i < curves.size(); i += std::size(kTurns)) {
    const auto lax = [&](Turn turn) {
      return laxZone(curves[i + static_cast<std::size_t>(turn)].poses);
    };
    const std::string& disc = curves[i].disc;
    add(disc, "neutral_zone_flexion_extension", lax(Turn::kFlexion) + lax(Turn::kExtension));
    add(disc, "neutral_zone_lateral_bending", 2 * lax(Turn::kLeftBending));
    add(disc, "neutral_zone_axial_rotation", 2 * lax(Turn::kLeftRotation));
    add(disc, "rotation_in_bending",
        coupledMotion(curves[i + static_cast<std::size_t>(Turn::kLeftBending)]));
    add(disc, "bending_in_rotation",
        coupledMotion(curves[i + static_cast<std::size_t>(Turn::kLeftRotation)]));
  }
  return all;
}

bool isAngle(const Kinematics& k) { return k.quantity.rfind("neutral_zone_", 0) == 0; }

// Sum of the published means of the region's segments that were measured.
double publishedSum(const Anatomy& anatomy, RomReport report, Region region, Motion motion) {
  for (LevelMotion& m : report.motions) m.angle = m.range.mean;
  return regionSum(anatomy, report, region, motion);
}

Json describe(const Anatomy& anatomy, const Report& whole) {
  const RomReport& report = whole.rom;
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
    for (int k = 0; k < kNumMotions; k++) {
      const Motion motion = static_cast<Motion>(k);
      sums["published_mean_" + motionName(motion) + "_deg"] =
          publishedSum(anatomy, report, region, motion) / kDegree;
    }
    regions.push_back({{"region", regionName(region)}, {"sums", sums}});
  }
  Json misses = Json::array(), zones = Json::array(), coupled = Json::array();
  for (const MotionBounds& m : whole.misses) {
    misses.push_back({{"disc", m.motion.disc},
                      {"motion", motionName(m.motion.motion)},
                      {"ours_deg", m.motion.angle / kDegree},
                      {"disc_alone_deg", m.disc / kDegree},
                      {"disc_and_facets_deg", m.disc_and_facets / kDegree},
                      {"taut", m.taut},
                      {"reason", reason(m)}});
  }
  for (const Kinematics& k : kinematics(whole)) {
    const double unit = isAngle(k) ? kDegree : 1;
    Json row = {{"disc", k.disc},
                {isAngle(k) ? "motion" : "quantity",
                 isAngle(k) ? k.quantity.substr(std::string("neutral_zone_").size()) : k.quantity},
                {isAngle(k) ? "lax_zone_deg" : "ours", k.ours / unit}};
    if (k.published) {
      row[isAngle(k) ? "published_neutral_zone_deg" : "published"] = k.published->value / unit;
      row["sources"] = k.published->sources;
      row["provenance"] = k.published->provenance;
    }
    (isAngle(k) ? zones : coupled).push_back(row);
  }
  return {{"inside", inside},           {"entries", report.motions.size()},
          {"motions", motions},         {"misses", misses},
          {"regions", regions},         {"lax_zones", zones},
          {"coupled_motions", coupled}, {"curves", curves}};
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

void printRegions(const Anatomy& anatomy, const RomReport& report) {
  fmt::print("\nsums of segments, ours (published means) [deg]\n");
  for (Region region : kRegions) {
    fmt::print("{:<9}", regionName(region));
    for (int k = 0; k < kNumMotions; k++) {
      const Motion motion = static_cast<Motion>(k);
      fmt::print("{:>25}", fmt::format("{:.1f} ({:.1f})",
                                       regionSum(anatomy, report, region, motion) / kDegree,
                                       publishedSum(anatomy, report, region, motion) / kDegree));
    }
    fmt::print("\n");
  }
}

void printKinematics(const Anatomy& anatomy, const Report& report) {
  const std::vector<Kinematics> all = kinematics(report);
  fmt::print(
      "\nlax zone, both sides [deg]; in brackets the published neutral zone; coupled motion [deg "
      "per deg], positive to the\nsame side; in brackets what is published\n{:<9}{:>20}{:>20}{:>20}"
      "{:>22}{:>22}\n",
      "segment", "flexion_extension", "lateral_bending", "axial_rotation", "rotation_in_bending",
      "bending_in_rotation");
  constexpr std::size_t kQuantities = 5;
  for (std::size_t i = all.size(); i >= kQuantities; i -= kQuantities) {
    fmt::print("{:<9}", all[i - 1].disc);
    for (std::size_t k = i - kQuantities; k < i; k++) {
      const double unit = isAngle(all[k]) ? kDegree : 1;
      const std::string ours =
          fmt::format(isAngle(all[k]) ? "{:.1f}" : "{:+.2f}", all[k].ours / unit);
      const std::string human = all[k].published
                                    ? fmt::format(isAngle(all[k]) ? " ({:.1f})" : " ({:+.2f})",
                                                  all[k].published->value / unit)
                                    : "";
      fmt::print("{:>{}}", ours + human, isAngle(all[k]) ? 20 : 22);
    }
    fmt::print("\n");
  }
  for (const Region region : kRegions) {
    for (const char* quantity : {"rotation_in_bending", "bending_in_rotation"}) {
      int levels = 0, same_side = 0;
      double sum = 0;
      for (const Kinematics& k : all) {
        if (anatomy.disc(k.disc).region != region || k.quantity != quantity) continue;
        levels++;
        same_side += k.ours > 0;
        sum += k.ours;
      }
      if (levels == 0) continue;
      fmt::print("{:<9} {}: mean {:+.2f}, to the same side at {} of {} levels\n",
                 regionName(region), quantity, sum / levels, same_side, levels);
    }
  }
}

void printMisses(const Report& report) {
  if (!report.misses.empty()) fmt::print("\noutside of the published range\n");
  for (const MotionBounds& miss : report.misses) {
    fmt::print("{} {}: {:.1f} deg; {}\n", miss.motion.disc, motionName(miss.motion.motion),
               miss.motion.angle / kDegree, reason(miss));
  }
  fmt::print("\nwhere the model of Lee et al. 2023 differs from people\n");
  for (const LevelMotion& m : report.rom.motions) {
    for (const auto& [disc, motion] : kPaperMisses) {
      if (m.disc != disc || m.motion != motion) continue;
      fmt::print("{} {}: {:.1f} deg, {} {:.1f}-{:.1f} (mean {:.1f})\n", disc, motionName(motion),
                 m.angle / kDegree, m.inside() ? "inside" : "outside of", m.range.low / kDegree,
                 m.range.high / kDegree, m.range.mean / kDegree);
    }
  }
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
  const bool whole = parts.ligaments && parts.facets && !options.follower;
  Report report;
  {
    const ProgressBar bar;
    report.rom = measureRom(anatomy, skeleton, options.levels, parts, options.follower, threads,
                            [&bar](double share) { bar.show(share); });
    if (whole) report.misses = boundsOfMisses(anatomy, skeleton, report.rom, threads);
  }
  report.published = readPublishedKinematics(anatomyFolder() + "/segment_kinematics.csv");
  if (options.json) {
    std::cout << describe(anatomy, report).dump(2) << '\n';
  } else {
    print(report.rom);
    if (options.levels.empty()) printRegions(anatomy, report.rom);
    printKinematics(anatomy, report);
    if (whole) printMisses(report);
    std::fflush(stdout);
  }
  if (options.plot_folder.empty()) return;
  writeRomPlots(options.plot_folder, anatomy, report.rom);
  runGnuplot("rom", options.plot_folder, "rom.gp");
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
      "head's joint stands for the joints of C1 and C2, too.\n"
      "Then come the regions' sums, the lax zone (Crawford 1998: where the tangents at the ends\n"
      "of the curve meet no moment; the neutral zone of Wilke 1998, what is left without load, is\n"
      "nothing here, for nothing has friction), coupled motions, and what bounds each motion that\n"
      "is outside of the published range. Published neutral zones and coupled motions are in\n"
      "model/anatomy/segment_kinematics.csv.\n\n"
      "Examples:\n"
      "  torso rom\n"
      "  torso rom --plot out/rom                     # also moment-angle curves\n"
      "  torso rom --level L4/L5 --without ligaments\n"
      "  torso rom --whole --plot out/whole           # whole spine, totals of regions; minutes\n"
      "  torso rom --follower --json | jq .regions\n"
      "  torso rom --preload                          # how a follower load stiffens the lumbar "
      "spine");
  command->add_option("--level", options->levels, "Only these segments, e.g. L4/L5");
  command->add_option("--without", options->without, "Leave these out: ligaments, facets")
      ->check(CLI::IsMember({"ligaments", "facets"}));
  command->add_flag("--follower", options->follower,
                    "Under a follower load: 400 N, in the neck 100 N");
  command->add_option("--plot", options->plot_folder,
                      "Write curves and pictures (gnuplot) into this folder");
  command->add_flag("--json", options->json, "Print JSON, with the curves");
  auto whole = std::make_shared<WholeOptions>();
  auto* flag = command->add_flag("--whole", whole->on,
                                 "The whole spine with the rib cage instead: extremes of voluntary "
                                 "motions, totals of regions");
  command
      ->add_option("--mixtures", whole->mixtures,
                   "With --whole: so many random mixtures of motions, of which the outer 5 % are "
                   "left out")
      ->needs(flag)
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  auto preload = std::make_shared<bool>(false);
  command
      ->add_flag(
          "--preload", *preload,
          "The lumbar spine instead: stiffness and range of motion under follower loads over "
          "those without, beside published ratios (model/anatomy/preload.csv)")
      ->excludes(flag);
  command->callback([options, whole, preload] {
    if (*preload) {
      romPreload(options->json);
    } else if (whole->on) {
      romWhole(options->json, options->plot_folder, whole->mixtures);
    } else {
      rom(*options);
    }
  });
}

}  // namespace torso::tools
