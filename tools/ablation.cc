// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/ablation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "tools/files.h"

namespace torso::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kDegree = EIGEN_PI / 180;
constexpr int kLumbarLevels = 6;  // L5/S1 .. T12/L1

}  // namespace

double BentPose::flexion() const { return std::accumulate(levels.begin(), levels.end(), 0.0); }

double BentPose::largestShare() const {
  return *std::max_element(levels.begin(), levels.end()) / flexion();
}

BentPose bentBy(const std::vector<BentPose>& poses, double flexion) {
  for (std::size_t k = 1; k < poses.size(); k++) {
    const BentPose &a = poses[k - 1], &b = poses[k];
    if (b.flexion() < flexion) continue;
    const double t = (flexion - a.flexion()) / (b.flexion() - a.flexion());
    BentPose pose = {a.moment + t * (b.moment - a.moment), a.levels};
    for (std::size_t i = 0; i < pose.levels.size(); i++) {
      pose.levels[i] += t * (b.levels[i] - a.levels[i]);
    }
    return pose;
  }
  return poses.back();
}

LumbarBends bendLumbarSpine(const Anatomy& anatomy, const Skeleton& skeleton, bool ligaments) {
  constexpr int kStrides = 10;
  SpineParts parts;
  parts.ligaments = ligaments;
  parts.levels = kLumbarLevels;
  WholeSpine spine(anatomy, skeleton, parts);
  const std::vector<WeightAbove> above = weightAbove(anatomy);
  LumbarBends bends;
  for (const Turn turn : {Turn::kFlexion, Turn::kExtension}) {
    SpineLoad load(kLumbarLevels);
    spine.stand(load);
    for (int i = 0; i < kLumbarLevels; i++) {
      load[i].moment = kHangingShare * above[i].moment * turnAxis(turn);
    }
    auto& poses = turn == Turn::kFlexion ? bends.forward : bends.backward;
    poses = {{0, std::vector<double>(kLumbarLevels, 0.0)}};
    spine.load(load, kStrides, [&](const SpinePose& pose, double share) {
      BentPose bent = {share * load[0].moment.y(), {}};
      for (const Vector3d& level : pose.levels) bent.levels.push_back(level.y());
      poses.push_back(bent);
      return true;
    });
  }
  return bends;
}

std::vector<GapStatistics> measureGaps(const Anatomy& anatomy, const Skeleton& skeleton, bool discs,
                                       int mixtures, unsigned seed,
                                       const std::function<void(double)>& progress) {
  std::vector<Vector3d> weights = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                   {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
  for (const Vector3d& w : randomWeights(mixtures, seed)) weights.push_back(w);
  const std::vector<DiscGap> gaps = discGaps(anatomy, skeleton);
  SpineParts parts;
  parts.discs = discs;
  WholeSpine spine(anatomy, skeleton, parts);
  spine.stand(standingLoad(anatomy));
  std::vector<std::vector<double>> distances(gaps.size());
  for (std::size_t k = 0; k < weights.size(); k++) {
    for (const SpinePose& pose : spine.load(mixedLoad(anatomy, weights[k]), kMotionSteps)) {
      for (std::size_t i = 0; i < gaps.size(); i++) {
        distances[i].push_back(gaps[i].at(pose.placement[i]));
      }
    }
    progress((k + 1.0) / weights.size());
  }
  std::vector<GapStatistics> statistics;
  for (std::size_t i = 0; i < gaps.size(); i++) {
    statistics.push_back(
        gapStatistics(anatomy.discs[i].name, gaps[i].at(Isometry3d::Identity()), distances[i]));
  }
  return statistics;
}

namespace {

constexpr const char* kPlotHead =
    "# Draws the tables beside it: gnuplot ablation.gp\n"
    "set terminal pngcairo size 1700,{} font 'sans,13'\nset output 'ablation.png'\n"
    "set datafile separator ','\nset grid lc rgb 'gray80'\nset multiplot layout {},2\n";

constexpr const char* kLigamentPlots =
    "set title 'L5 against the sacrum under the weight of the hanging trunk'\n"
    "set key left top Left reverse\n"
    "set xlabel 'moment at L5/S1 [Nm], extension to flexion'\nset ylabel 'flexion [deg]'\n"
    "set object 1 rect from graph 0, first {low:.1f} to graph 1, first {high:.1f} fc rgb '#d62728' "
    "fs solid 0.12 noborder behind\n"
    "plot NaN with boxes fs solid 0.12 noborder lc rgb '#d62728' title 'published range (lumbar "
    "spines at 7.5 to 10 Nm, living people)', 'hanging.csv' skip 1 using (strcol(1) eq 'without' ? "
    "$2 : 1/0):4 with "
    "linespoints lw 2 pt 7 lc rgb '#d98c3f' title 'without ligaments', '' skip 1 using (strcol(1) "
    "eq 'whole' ? $2 : 1/0):4 with linespoints lw 2 pt 7 lc rgb '#1f4e9c' title 'whole'\n"
    "unset object 1\nset key right top Right noreverse\nset title 'Lumbar spine bent forward'\nset "
    "xlabel ''\n"
    "set xtics rotate by -45\nset boxwidth 0.26\nset style fill solid 0.6\nset yrange [0:*]\n"
    "plot 'bend.csv' skip 1 using ($0-0.27):2:xtic(1) with boxes lc rgb '#1f4e9c' title 'whole: "
    "{a:.0f} deg at {am:.0f} Nm', '' skip 1 using 0:3 with boxes lc rgb '#d98c3f' title 'without "
    "ligaments: {b:.0f} deg at {bm:.0f} Nm', '' skip 1 using ($0+0.27):4 with boxes lc rgb "
    "'#f0cfa8' title 'without ligaments: {c:.0f} deg at {cm:.0f} Nm'\n";

constexpr const char* kDiscPlots =
    "set xtics rotate by -45\nset boxwidth 0.4\nset yrange [*:*]\nset xrange [-0.7:22.7]\nset key "
    "center bottom\nset style fill solid 0.6\n"
    "set title 'Gap between vertebral bodies against rest: mean and standard deviation'\n"
    "set xlabel ''\nset ylabel 'change [mm]'\n"
    "plot 'gaps.csv' skip 1 using ($0-0.1):6:7:xtic(1) with yerrorbars lw 2 pt 7 lc rgb '#d98c3f' "
    "title 'without discs', '' skip 1 using ($0+0.1):3:4 with yerrorbars lw 2 pt 7 lc rgb "
    "'#1f4e9c' title 'whole', '' skip 1 using 0:(-$2) with points pt 2 ps 1.2 lc rgb 'gray40' "
    "title 'contact'\n"
    "set title 'Poses in which the bodies collide'\nset ylabel 'share [%]'\nset yrange "
    "[0:100]\nset key center top\n"
    "plot 'gaps.csv' skip 1 using ($0-0.2):(100*$8):xtic(1) with boxes lc rgb '#d98c3f' title "
    "'without discs', '' skip 1 using ($0+0.2):(100*$5) with boxes lc rgb '#1f4e9c' title "
    "'whole'\n";

std::string ligamentTables(const std::string& folder, const Anatomy& anatomy,
                           const AblationReport& report) {
  const LumbarBends &whole = report.whole, &without = report.without_ligaments;
  std::string hanging = "spine,moment_nm,lumbar_deg,l5_deg\n";
  for (const LumbarBends* spine : {&whole, &without}) {
    const auto add = [&](const BentPose& pose) {
      hanging += fmt::format("{},{:.3f},{:.3f},{:.3f}\n", spine == &whole ? "whole" : "without",
                             pose.moment, pose.flexion() / kDegree, pose.levels[0] / kDegree);
    };
    std::for_each(spine->backward.rbegin(), std::prev(spine->backward.rend()), add);
    std::for_each(spine->forward.begin(), spine->forward.end(), add);
  }
  writeFile(folder + "/hanging.csv", hanging);
  const BentPose a = bentBy(whole.forward, kForwardBend), b = bentBy(without.forward, kForwardBend),
                 c = without.forward.back();
  std::string bend = "disc,whole_deg,without_ligaments_deg,without_ligaments_end_deg\n";
  for (int i = 0; i < kLumbarLevels; i++) {
    bend += fmt::format("{},{:.3f},{:.3f},{:.3f}\n", anatomy.discs[i].name, a.levels[i] / kDegree,
                        b.levels[i] / kDegree, c.levels[i] / kDegree);
  }
  writeFile(folder + "/bend.csv", bend);
  const RangeOfMotion& published = anatomy.range_of_motion.at(anatomy.discs[0].name);
  return fmt::format(kLigamentPlots, fmt::arg("low", -published[kExtension].high / kDegree),
                     fmt::arg("high", published[kFlexion].high / kDegree),
                     fmt::arg("a", a.flexion() / kDegree), fmt::arg("am", a.moment),
                     fmt::arg("b", b.flexion() / kDegree), fmt::arg("bm", b.moment),
                     fmt::arg("c", c.flexion() / kDegree), fmt::arg("cm", c.moment));
}

std::string discTables(const std::string& folder, const AblationReport& report) {
  std::string gaps =
      "disc,rest_mm,whole_mm,whole_deviation_mm,whole_collisions,without_discs_mm,"
      "without_discs_deviation_mm,without_discs_collisions\n";
  for (std::size_t i = 0; i < report.gaps.size(); i++) {
    const GapStatistics &a = report.gaps[i], &b = report.gaps_without_discs[i];
    gaps += fmt::format("{},{:.3f},{:.3f},{:.3f},{:.4f},{:.3f},{:.3f},{:.4f}\n", a.disc,
                        a.rest * 1e3, (a.mean - a.rest) * 1e3, a.deviation * 1e3, a.collisions,
                        (b.mean - b.rest) * 1e3, b.deviation * 1e3, b.collisions);
  }
  writeFile(folder + "/gaps.csv", gaps);
  return kDiscPlots;
}

}  // namespace

void writeAblationPlots(const std::string& folder, const Anatomy& anatomy,
                        const AblationReport& report) {
  makeFolder(folder);
  std::string plots;
  int rows = 0;
  if (!report.whole.forward.empty()) {
    plots += ligamentTables(folder, anatomy, report);
    rows++;
  }
  if (!report.gaps.empty()) {
    plots += discTables(folder, report);
    rows++;
  }
  writeFile(folder + "/ablation.gp",
            fmt::format(kPlotHead, 600 * rows, rows) + plots + "unset multiplot\n");
}

}  // namespace torso::tools
