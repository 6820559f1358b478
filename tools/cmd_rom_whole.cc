// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "tools/bone_files.h"
#include "tools/files.h"
#include "tools/gnuplot.h"
#include "tools/paths.h"
#include "tools/progress_bar.h"
#include "tools/whole_spine_rom.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegree = EIGEN_PI / 180;
constexpr Motion kMotions[] = {kFlexionExtension, kLateralBending, kAxialRotation};
constexpr double kWithin = 0.1;  // of the in-vivo total

struct RegionRow {
  const SpineRegion* region;
  Motion motion;
  double voluntary, laboratory, without_ribcage;  // [rad]
  const PublishedMotion* in_vivo;
  std::vector<const PublishedMotion*> others, ribcage;  // other sources in vivo
  bool inside() const { return std::abs(voluntary / in_vivo->value - 1) <= kWithin; }
};

std::vector<RegionRow> regionRows(const WholeSpineReport& report,
                                  const std::vector<PublishedMotion>& published) {
  std::vector<RegionRow> rows;
  for (const SpineRegion& region : spineRegions()) {
    for (const Motion motion : kMotions) {
      const auto sum = [&](const TurnAngles& angles) {
        return regionMotion(angles, region.first, region.last, motion);
      };
      RegionRow row = {&region,
                       motion,
                       sum(report.voluntary),
                       sum(report.laboratory),
                       sum(report.laboratory_without_ribcage),
                       nullptr,
                       {},
                       {}};
      for (const PublishedMotion& p : published) {
        if (p.region != region.name || p.motion != motion) continue;
        if (p.loading == "in_vivo") row.in_vivo = &p;
        if (p.loading == "in_vivo_other") row.others.push_back(&p);
        if (p.loading == "ribcage_removed") row.ribcage.push_back(&p);
      }
      rows.push_back(row);
    }
  }
  return rows;
}

void print(const Anatomy& anatomy, const WholeSpineReport& report,
           const std::vector<RegionRow>& rows) {
  fmt::print(
      "each level at the extremes of voluntary motions; in brackets all but the outer 5 % of mixed "
      "motions; then mean and range of publications [deg]\n{:<9}",
      "level");
  for (const Motion motion : kMotions) fmt::print("{:>32}", motionName(motion));
  for (int i = static_cast<int>(anatomy.discs.size()) - 1; i >= 0; i--) {
    const std::string& disc = anatomy.discs[i].name;
    fmt::print("\n{:<9}", disc);
    for (const Motion motion : kMotions) {
      const MotionRange& range = anatomy.range_of_motion.at(disc)[motion];
      const std::string mixed =
          report.spread.empty() ? ""
                                : fmt::format(" ({:.1f})", report.spread[i].of(motion) / kDegree);
      fmt::print("{:>32}",
                 fmt::format("{:.1f}{}  {:.1f} {:.1f}-{:.1f}",
                             regionMotion(report.voluntary, i, i, motion) / kDegree, mixed,
                             range.mean / kDegree, range.low / kDegree, range.high / kDegree));
    }
  }
  fmt::print("\n\n{:<8}{:<19}{:>10}{:>9}{:>9}{:>12}   without rib cage\n", "region", "motion",
             "voluntary", "in vivo", "", "laboratory");
  int inside = 0;
  for (const RegionRow& row : rows) {
    inside += row.inside();
    fmt::print("{:<8}{:<19}{:>10.1f}{:>9.1f}{:>8.0f}%{:>12.1f}", row.region->name,
               motionName(row.motion), row.voluntary / kDegree, row.in_vivo->value / kDegree,
               100 * (row.voluntary / row.in_vivo->value - 1), row.laboratory / kDegree);
    if (!row.ribcage.empty()) {
      fmt::print("   {:+.0f}% (", 100 * (row.without_ribcage / row.laboratory - 1));
      for (const PublishedMotion* p : row.ribcage) {
        fmt::print("{}{:+.0f}%, {}", p == row.ribcage.front() ? "" : "; ", 100 * p->value,
                   p->source);
      }
      fmt::print(")");
    }
    for (const PublishedMotion* p : row.others) {
      fmt::print("   {:.1f} in vivo, {}: {:+.0f}%", p->value / kDegree, p->source,
                 100 * (row.voluntary / p->value - 1));
    }
    fmt::print("\n");
  }
  fmt::print("{} of {} voluntary totals within 10 % of living people's [deg]\n", inside,
             rows.size());
}

Json describe(const Anatomy& anatomy, const WholeSpineReport& report,
              const std::vector<RegionRow>& rows) {
  Json levels = Json::array(), regions = Json::array();
  for (std::size_t i = 0; i < anatomy.discs.size(); i++) {
    Json level = {{"disc", anatomy.discs[i].name}};
    for (int k = 0; k < 4; k++) {
      constexpr const char* kNames[] = {"flexion", "extension", "left_bending", "left_rotation"};
      level[std::string(kNames[k]) + "_voluntary_deg"] = report.voluntary[k][i] / kDegree;
      level[std::string(kNames[k]) + "_laboratory_deg"] = report.laboratory[k][i] / kDegree;
    }
    for (const Motion motion : kMotions) {
      if (report.spread.empty()) break;
      level[motionName(motion) + "_mixed_deg"] = report.spread[i].of(motion) / kDegree;
    }
    levels.push_back(level);
  }
  for (const RegionRow& row : rows) {
    Json json = {{"region", row.region->name},
                 {"motion", motionName(row.motion)},
                 {"voluntary_deg", row.voluntary / kDegree},
                 {"in_vivo_deg", row.in_vivo->value / kDegree},
                 {"source", row.in_vivo->source},
                 {"inside", row.inside()},
                 {"laboratory_deg", row.laboratory / kDegree},
                 {"without_ribcage_deg", row.without_ribcage / kDegree}};
    for (const PublishedMotion* p : row.others) {
      json["others_in_vivo"].push_back({{"value_deg", p->value / kDegree}, {"source", p->source}});
    }
    for (const PublishedMotion* p : row.ribcage) {
      json["published_without_ribcage"].push_back({{"increase", p->value}, {"source", p->source}});
    }
    regions.push_back(json);
  }
  return {{"levels", levels}, {"regions", regions}};
}

void writePlots(const std::string& folder, const Anatomy& anatomy, const WholeSpineReport& report,
                const std::vector<RegionRow>& rows) {
  makeFolder(folder);
  std::string levels = "disc", regions = "total,voluntary_deg,in_vivo_deg,laboratory_deg\n";
  for (const Motion motion : kMotions) {
    levels += fmt::format(",{0}_deg,{0}_mean_deg,{0}_low_deg,{0}_high_deg", motionName(motion));
  }
  for (std::size_t i = 0; i < anatomy.discs.size(); i++) {
    levels += "\n" + anatomy.discs[i].name;
    for (const Motion motion : kMotions) {
      const MotionRange& range = anatomy.range_of_motion.at(anatomy.discs[i].name)[motion];
      const int level = static_cast<int>(i);
      const double ours = report.spread.empty()
                              ? regionMotion(report.voluntary, level, level, motion)
                              : report.spread[i].of(motion);
      levels += fmt::format(",{:.3f},{:.3f},{:.3f},{:.3f}", ours / kDegree, range.mean / kDegree,
                            range.low / kDegree, range.high / kDegree);
    }
  }
  for (const RegionRow& row : rows) {
    constexpr const char* kShort[] = {"", "", "flexion + extension", "bending", "rotation"};
    regions += fmt::format("{} {},{:.3f},{:.3f},{:.3f}\n", row.region->name, kShort[row.motion],
                           row.voluntary / kDegree, row.in_vivo->value / kDegree,
                           row.laboratory / kDegree);
  }
  writeFile(folder + "/whole_spine.csv", levels + "\n");
  writeFile(folder + "/regions.csv", regions);
  std::string script =
      "# Draws the tables beside it: gnuplot whole_spine.gp\n"
      "set terminal pngcairo size 1500,1500 font 'sans,13'\nset output 'whole_spine.png'\n"
      "set datafile separator ','\nset grid lc rgb 'gray80'\nset style fill solid 0.15 noborder\n"
      "set multiplot layout 4,1 title 'Whole-spine motion: red, published; blue, ours'\n"
      "set xtics rotate by -35\nset ylabel 'angle [deg]'\nset yrange [0:*]\nset key outside "
      "right\n";
  int column = 2;
  for (const Motion motion : kMotions) {
    script += fmt::format("set title '{}{}' noenhanced\n{}\n", motionName(motion),
                          motion == kFlexionExtension ? "" : ", one side",
                          plotLevels({"whole_spine.csv", column, column + 1, column + 2, column + 3,
                                      "ours", "published"}));
    column += 4;
  }
  script +=
      "set title 'totals of regions'\nset style fill solid 0.8\nset boxwidth 0.25\n"
      "plot 'regions.csv' skip 1 using ($0-0.27):3:xtic(1) with boxes lc rgb '#d62728' title 'in "
      "vivo', '' skip 1 using 0:2 with boxes lc rgb '#1f4e9c' title 'ours, voluntary loads', '' "
      "skip 1 using ($0+0.27):4 with boxes lc rgb '#9db7dd' title 'ours, laboratory moments'\n"
      "unset multiplot\n";
  writeFile(folder + "/whole_spine.gp", script);
}

}  // namespace

void romWhole(bool json, const std::string& plot_folder, int mixtures) {
  const Anatomy anatomy = Anatomy::load(anatomyFolder());
  const Skeleton skeleton = readSkeleton(anatomy, mjcfFolder() + "/assets", spineBodies(anatomy));
  const std::vector<PublishedMotion> published =
      readRegionMotion(anatomyFolder() + "/region_motion.csv");
  const int threads = static_cast<int>(std::thread::hardware_concurrency());
  WholeSpineReport report;
  {
    const ProgressBar bar;
    report = measureWholeSpine(anatomy, skeleton, mixtures, 1, threads,
                               [&bar](double share) { bar.show(share); });
  }
  const std::vector<RegionRow> rows = regionRows(report, published);
  if (json) {
    std::cout << describe(anatomy, report, rows).dump(2) << '\n';
  } else {
    print(anatomy, report, rows);
    std::fflush(stdout);
  }
  if (plot_folder.empty()) return;
  writePlots(plot_folder, anatomy, report, rows);
  runGnuplot("rom", plot_folder, "whole_spine.gp");
}

}  // namespace torso::tools
