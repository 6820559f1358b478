// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/ablation.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>

#include "model/parallel.h"
#include "tools/files.h"

namespace torso::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kDegree = EIGEN_PI / 180;
constexpr int kTrunkLevels = 17;  // L5/S1 .. T1/T2

double trunkFlexion(const SpinePose& pose) {
  double sum = 0;
  for (int i = 0; i < kTrunkLevels; i++) sum += pose.levels[i].y();
  return sum;
}

// Raises the moment in equal strides until the bend is passed, and takes the pose between the last
// two.
ForwardBend bendForward(const Anatomy& anatomy, WholeSpine& spine) {
  constexpr double kStride = 1.5, kMost = 45;  // at L5/S1 [Nm]
  const std::vector<WeightAbove> above = weightAbove(anatomy);
  SpineLoad full = standingLoad(anatomy);
  for (int i = 0; i < kTrunkLevels; i++) {
    full[i].moment = kMost * above[i].moment / above[0].moment * turnAxis(Turn::kFlexion);
  }
  ForwardBend bend = {std::vector<double>(kTrunkLevels, 0.0), kMost};
  double before = 0;
  spine.load(full, static_cast<int>(kMost / kStride), [&](const SpinePose& pose, double share) {
    const double now = trunkFlexion(pose);
    const bool passed = now >= kForwardBend;
    const double part = passed ? (kForwardBend - before) / (now - before) : 1;
    for (int i = 0; i < kTrunkLevels; i++) {
      bend.levels[i] += part * (pose.levels[i].y() - bend.levels[i]);
    }
    bend.moment = kMost * share - (1 - part) * kStride;
    before = now;
    return !passed;
  });
  return bend;
}

SpineAblation ablate(const Anatomy& anatomy, const std::vector<DiscGap>& gaps, WholeSpine& spine,
                     const std::vector<SpineLoad>& motions, bool bend) {
  SpineAblation result;
  spine.stand(standingLoad(anatomy));
  std::vector<std::vector<double>> distances(gaps.size());
  for (const SpineLoad& motion : motions) {
    for (const SpinePose& pose : spine.load(motion, kMotionSteps)) {
      result.l5_flexion.push_back(pose.levels[0].y());
      for (std::size_t i = 0; i < gaps.size(); i++) {
        distances[i].push_back(gaps[i].at(pose.placement[i]));
      }
    }
  }
  for (std::size_t i = 0; i < gaps.size(); i++) {
    result.gaps.push_back(
        gapStatistics(anatomy.discs[i].name, gaps[i].at(Isometry3d::Identity()), distances[i]));
  }
  if (bend) result.bend = bendForward(anatomy, spine);
  return result;
}

}  // namespace

double ForwardBend::largestShare() const {
  const double sum = std::accumulate(levels.begin(), levels.end(), 0.0);
  return *std::max_element(levels.begin(), levels.end()) / sum;
}

int ForwardBend::levelsForHalf() const {
  std::vector<double> sorted = levels;
  std::sort(sorted.rbegin(), sorted.rend());
  const double half = std::accumulate(levels.begin(), levels.end(), 0.0) / 2;
  int count = 0;
  for (double sum = 0; sum < half; count++) sum += sorted[count];
  return count;
}

AblationReport measureAblation(const Anatomy& anatomy, const Skeleton& skeleton, int mixtures,
                               unsigned seed, int threads,
                               const std::function<void(double)>& progress) {
  std::vector<SpineLoad> motions;
  for (const Vector3d& w : {Vector3d(1, 0, 0), Vector3d(-1, 0, 0), Vector3d(0, 1, 0),
                            Vector3d(0, -1, 0), Vector3d(0, 0, 1), Vector3d(0, 0, -1)}) {
    motions.push_back(mixedLoad(anatomy, w));
  }
  for (const Vector3d& w : randomWeights(mixtures, seed)) motions.push_back(mixedLoad(anatomy, w));
  const std::vector<DiscGap> gaps = discGaps(anatomy, skeleton);
  AblationReport report;
  std::atomic<int> done{0};
  forEach(3, threads, [&](int i) {
    SpineParts parts;
    parts.ligaments = i != 1;
    parts.discs = i != 2;
    WholeSpine spine(anatomy, skeleton, parts);
    (i == 0   ? report.whole
     : i == 1 ? report.without_ligaments
              : report.without_discs) = ablate(anatomy, gaps, spine, motions, i < 2);
    progress(++done / 3.0);
  });
  return report;
}

void writeAblationPlots(const std::string& folder, const Anatomy& anatomy,
                        const AblationReport& report) {
  makeFolder(folder);
  std::string l5 = "whole_deg,without_ligaments_deg\n";
  for (std::size_t i = 0; i < report.whole.l5_flexion.size(); i++) {
    l5 += fmt::format("{:.3f},{:.3f}\n", report.whole.l5_flexion[i] / kDegree,
                      report.without_ligaments.l5_flexion[i] / kDegree);
  }
  writeFile(folder + "/l5.csv", l5);
  std::string bend = "disc,whole_deg,without_ligaments_deg\n";
  for (int i = 0; i < kTrunkLevels; i++) {
    bend += fmt::format("{},{:.3f},{:.3f}\n", anatomy.discs[i].name,
                        report.whole.bend.levels[i] / kDegree,
                        report.without_ligaments.bend.levels[i] / kDegree);
  }
  writeFile(folder + "/bend.csv", bend);
  std::string gaps =
      "disc,rest_mm,whole_mm,whole_deviation_mm,whole_collisions,without_discs_mm,"
      "without_discs_deviation_mm,without_discs_collisions\n";
  for (std::size_t i = 0; i < report.whole.gaps.size(); i++) {
    const GapStatistics &a = report.whole.gaps[i], &b = report.without_discs.gaps[i];
    gaps += fmt::format("{},{:.3f},{:.3f},{:.3f},{:.4f},{:.3f},{:.3f},{:.4f}\n", a.disc,
                        a.rest * 1e3, (a.mean - a.rest) * 1e3, a.deviation * 1e3, a.collisions,
                        (b.mean - b.rest) * 1e3, b.deviation * 1e3, b.collisions);
  }
  writeFile(folder + "/gaps.csv", gaps);
  writeFile(
      folder + "/ablation.gp",
      "# Draws the tables beside it: gnuplot ablation.gp\n"
      "set terminal pngcairo size 1700,1100 font 'sans,13'\nset output 'ablation.png'\n"
      "set datafile separator ','\nset grid lc rgb 'gray80'\n"
      "set multiplot layout 2,2\n"
      "set title 'L5 against the sacrum over all motions'\nset xlabel 'flexion [deg]'\n"
      "set ylabel 'poses'\nbin(x) = 2 * floor(x / 2.0) + 1\nset boxwidth 1.9\n"
      "set style fill solid 0.5\n"
      "plot 'l5.csv' skip 1 using (bin($2)):(1) smooth frequency with boxes lc rgb '#d98c3f' title "
      "'without ligaments', '' skip 1 using (bin($1)):(1) smooth frequency with boxes lc rgb "
      "'#1f4e9c' title 'whole'\n"
      "set title 'Trunk bent forward by 65 degrees'\nset xlabel ''\nset ylabel 'flexion [deg]'\n"
      "set xtics rotate by -45\nset boxwidth 0.4\nset yrange [*:*]\n"
      "plot 'bend.csv' skip 1 using ($0-0.2):3:xtic(1) with boxes lc rgb '#d98c3f' title 'without "
      "ligaments', '' skip 1 using ($0+0.2):2 with boxes lc rgb '#1f4e9c' title 'whole'\n"
      "set title 'Gap between vertebral bodies against rest: mean and standard deviation'\n"
      "set ylabel 'change [mm]'\n"
      "plot 'gaps.csv' skip 1 using ($0-0.1):6:7:xtic(1) with yerrorbars lw 2 pt 7 lc rgb "
      "'#d98c3f' title 'without discs', '' skip 1 using ($0+0.1):3:4 with yerrorbars lw 2 pt 7 lc "
      "rgb '#1f4e9c' title 'whole', '' skip 1 using 0:(-$2) with points pt 2 ps 1.2 lc rgb "
      "'gray40' title 'contact'\n"
      "set title 'Poses in which the bodies collide'\nset ylabel 'share [%]'\nset yrange [0:100]\n"
      "plot 'gaps.csv' skip 1 using ($0-0.2):(100*$8):xtic(1) with boxes lc rgb '#d98c3f' title "
      "'without discs', '' skip 1 using ($0+0.2):(100*$5) with boxes lc rgb '#1f4e9c' title "
      "'whole'\nunset multiplot\n");
}

}  // namespace torso::tools
