// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/rom_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "tools/files.h"
#include "tools/gnuplot.h"

namespace torso::tools {
namespace {

constexpr double kDegree = EIGEN_PI / 180;
constexpr Motion kPanels[] = {kFlexionExtension, kLateralBending, kAxialRotation};

std::string title(Motion motion) {
  return motion == kFlexionExtension ? "flexion + extension"
         : motion == kLateralBending ? "lateral bending, one side"
                                     : "axial rotation, one side";
}

// A row per level, from below: name, then ours, mean, least and largest of each panel's motion.
std::string levelTable(const RomReport& report) {
  std::string text = "disc";
  for (const Motion motion : kPanels) {
    const std::string& name = motionName(motion);
    text += fmt::format(",{0}_ours_deg,{0}_mean_deg,{0}_low_deg,{0}_high_deg", name);
  }
  std::string disc;
  for (const LevelMotion& m : report.motions) {
    if (m.disc != disc) text += "\n" + m.disc;
    disc = m.disc;
    if (std::find(std::begin(kPanels), std::end(kPanels), m.motion) == std::end(kPanels)) continue;
    text += fmt::format(",{:.3f},{:.3f},{:.3f},{:.3f}", m.angle / kDegree, m.range.mean / kDegree,
                        m.range.low / kDegree, m.range.high / kDegree);
  }
  return text + "\n";
}

std::string levelFigure() {
  std::string text =
      "set output 'rom.png'\nset terminal pngcairo size 1500,1300 font 'sans,13'\n"
      "set multiplot layout 3,1 title 'Range of motion of each level: red, human mean and range "
      "of publications; blue, segments under pure moments'\n"
      "set style fill solid 0.15 noborder\nset xtics rotate by -35\nset xrange [-0.4:*]\n"
      "set offsets 0,0.4,graph 0.2,0\nset key at graph 0.5,0.97 center top horizontal\n";
  int column = 2;
  for (const Motion motion : kPanels) {
    text += fmt::format(
        "set title '{}'\nset ylabel 'angle [deg]'\nset yrange [0:*]\n{}\n", title(motion),
        plotLevels({"rom.csv", column, column + 1, column + 2, column + 3, "ours", "human"}));
    column += 4;
  }
  return text + "unset multiplot\n";
}

bool shows(Motion panel, Turn turn) {
  return panel == kFlexionExtension ? turn == Turn::kFlexion || turn == Turn::kExtension
         : panel == kLateralBending ? turn == Turn::kLeftBending
                                    : turn == Turn::kLeftRotation;
}

// Columns angle [deg] and moment [Nm] of each level, flexion and left positive.
std::string curveTable(const std::vector<std::string>& discs, const RomReport& report,
                       Motion panel) {
  std::string text = "";
  std::vector<std::vector<const SegmentPose*>> columns;
  std::vector<double> signs;
  for (const std::string& disc : discs) {
    text += fmt::format("{0}{1}_deg,{1}_Nm", text.empty() ? "" : ",", disc);
    std::vector<const SegmentPose*> column;
    std::vector<double> sign;
    for (const bool forward : {false, true}) {
      for (const LevelCurve& curve : report.curves) {
        if (curve.disc != disc || !shows(panel, curve.turn)) continue;
        if ((curve.turn != Turn::kExtension) != forward) continue;
        for (std::size_t i = 0; i < curve.poses.size(); i++) {
          // Extension from its end to no moment.
          column.push_back(&curve.poses[forward ? i : curve.poses.size() - 1 - i]);
          sign.push_back(forward ? 1 : -1);
        }
      }
    }
    columns.push_back(column);
    signs = sign;
  }
  for (std::size_t i = 0; i < signs.size(); i++) {
    for (std::size_t k = 0; k < columns.size(); k++) {
      text +=
          fmt::format("{}{:.4f},{:.4f}", k == 0 ? "\n" : ",",
                      signs[i] * columns[k][i]->angle / kDegree, signs[i] * columns[k][i]->moment);
    }
  }
  return text + "\n";
}

// Published mean and range of each level at the laboratory's moment: angle, least, largest, moment.
std::string publishedBlock(const std::vector<std::string>& discs, const RomReport& report,
                           Motion panel, double moment) {
  std::string text;
  for (const LevelMotion& m : report.motions) {
    if (std::find(discs.begin(), discs.end(), m.disc) == discs.end()) continue;
    const bool back = panel == kFlexionExtension && m.motion == kExtension;
    const bool shown =
        panel == kFlexionExtension ? m.motion == kFlexion || back : m.motion == panel;
    if (!shown) continue;
    // Levels one above the other, not on top of each other.
    const auto place = std::find(discs.begin(), discs.end(), m.disc) - discs.begin();
    const double level = moment * (1.03 + 0.022 * static_cast<double>(place));
    const double sign = (back ? -1 : 1) / kDegree;
    text += fmt::format("{:.3f},{:.3f},{:.3f},{:.3f},{}\n", sign * m.range.mean, sign * m.range.low,
                        sign * m.range.high, (back ? -1 : 1) * level, place);
  }
  return text;
}

std::string curveFigure(Region region, const std::vector<std::string>& discs,
                        const RomReport& report) {
  std::string text = fmt::format(
      "set output '{0}_curves.png'\nset terminal pngcairo size 2000,760 font 'sans,13'\n"
      "set multiplot layout 1,3 title '{0} segments: lines, ours from below (dark) to above "
      "(light); red, published mean and range of each level in the same order'\n"
      "set xtics norotate\nset xrange [*:*]\nunset offsets\n"
      "set key default bottom right font ',10'\n",
      regionName(region));
  const double moment = laboratoryMoment(region);
  const double last = std::max(1.0, static_cast<double>(discs.size()) - 1);
  for (const Motion panel : kPanels) {
    const std::string block = fmt::format("${}_{}", regionName(region), motionName(panel));
    text += fmt::format(
        "{0} << EOD\n{1}EOD\n"
        "set title '{2}'\nset xlabel 'angle [deg]'\nset ylabel 'moment [Nm]'\nset yrange [*:*]\n"
        "plot ",
        block, publishedBlock(discs, report, panel, moment),
        panel == kFlexionExtension ? "extension (-), flexion (+)" : title(panel));
    for (std::size_t i = 0; i < discs.size(); i++) {
      text += fmt::format(
          "'{}_{}.csv' skip 1 using {}:{} with lines lw 2 lc palette frac {:.3f} title '{}', \\\n "
          " ",
          regionName(region), motionName(panel), 2 * i + 1, 2 * i + 2,
          static_cast<double>(i) / last, discs[i]);
    }
    text += fmt::format(
        "{} using 1:4:2:3 with xerrorbars pt 5 ps 0.5 lw 1.5 lc rgb '#d62728' title 'published'\n",
        block);
  }
  return text + "unset multiplot\n";
}

}  // namespace

void writeRomPlots(const std::string& folder, const Anatomy& anatomy, const RomReport& report) {
  makeFolder(folder);
  writeFile(folder + "/rom.csv", levelTable(report));
  std::string script =
      "# Draws the tables beside it: gnuplot rom.gp\nset datafile separator ','\n"
      "set grid lc rgb 'gray80'\nunset colorbox\n"
      "set palette defined (0 '#0b2a5b', 0.5 '#2f6fc4', 1 '#9cc4f2')\n" +
      levelFigure();
  for (const Region region : kRegions) {
    std::vector<std::string> discs;
    for (const Disc& disc : anatomy.discs) {
      if (disc.region != region) continue;
      for (const LevelCurve& curve : report.curves) {
        if (curve.disc == disc.name && curve.turn == Turn::kFlexion) discs.push_back(disc.name);
      }
    }
    if (discs.empty()) continue;
    for (const Motion panel : kPanels) {
      writeFile(fmt::format("{}/{}_{}.csv", folder, regionName(region), motionName(panel)),
                curveTable(discs, report, panel));
    }
    script += curveFigure(region, discs, report);
  }
  writeFile(folder + "/rom.gp", script);
}

}  // namespace torso::tools
