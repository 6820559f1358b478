// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "tools/files.h"
#include "tools/gnuplot.h"
#include "tools/motion_statistics.h"

namespace torso::tools {
namespace {

constexpr double kDegree = EIGEN_PI / 180;
constexpr Motion kPanels[] = {kFlexionExtension, kLateralBending, kAxialRotation};
constexpr const char* kTitles[] = {"Flexion and extension", "Lateral bending to one side",
                                   "Axial rotation to one side"};

// Per level ours, then ours without ligaments, and the humans' mean, least and largest; for each
// panel.
std::string romTable(const Anatomy& anatomy, const MotionStatistics& statistics) {
  std::string text = "disc";
  for (const Motion motion : kPanels) {
    text += fmt::format(
        ",{0}_ours_deg,{0}_without_ligaments_deg,{0}_human_mean_deg,{0}_human_low_deg,"
        "{0}_human_high_deg",
        motionName(motion));
  }
  for (std::size_t i = 0; i < anatomy.discs.size(); i++) {
    const std::string& name = anatomy.discs[i].name;
    text += "\n" + name;
    for (const Motion motion : kPanels) {
      const MotionRange& human = anatomy.range_of_motion.at(name)[motion];
      const auto& others = statistics.without_ligaments.spread;
      text += fmt::format(
          ",{:.3f},{},{:.3f},{:.3f},{:.3f}", statistics.whole.spread[i].of(motion) / kDegree,
          others.empty() ? "" : fmt::format("{:.3f}", others[i].of(motion) / kDegree),
          human.mean / kDegree, human.low / kDegree, human.high / kDegree);
    }
  }
  return text + "\n";
}

std::string gapTable(const MotionStatistics& statistics) {
  std::string text =
      "disc,rest_mm,whole_mm,whole_deviation_mm,whole_collisions,without_discs_mm,"
      "without_discs_deviation_mm,without_discs_collisions\n";
  for (std::size_t i = 0; i < statistics.whole.gaps.size(); i++) {
    const GapStatistics& a = statistics.whole.gaps[i];
    text += fmt::format("{},{:.3f},{:.3f},{:.3f},{:.4f}", a.disc, a.rest * 1e3,
                        (a.mean - a.rest) * 1e3, a.deviation * 1e3, a.collisions);
    if (statistics.without_discs.gaps.empty()) {
      text += ",,,\n";
      continue;
    }
    const GapStatistics& b = statistics.without_discs.gaps[i];
    text += fmt::format(",{:.3f},{:.3f},{:.4f}\n", (b.mean - b.rest) * 1e3, b.deviation * 1e3,
                        b.collisions);
  }
  return text;
}

// Share of the frames in each bin of flexion of L5 on the sacrum.
std::string flexionTable(const MotionStatistics& statistics) {
  constexpr int kFirst = -40, kLast = 70;  // [deg], in bins of a degree
  std::vector<std::array<double, 2>> bins(kLast - kFirst);
  const SpineMotions* kinds[] = {&statistics.whole, &statistics.without_ligaments};
  for (int k = 0; k < 2; k++) {
    if (kinds[k]->turns.empty()) continue;
    const std::vector<double>& flexion = kinds[k]->turns[0][1];
    for (const double angle : flexion) {
      const int bin = static_cast<int>(std::floor(angle / kDegree)) - kFirst;
      if (bin < 0 || bin >= kLast - kFirst) continue;
      bins[bin][k] += 1.0 / static_cast<double>(flexion.size());
    }
  }
  std::string text = "flexion_deg,whole,without_ligaments\n";
  for (int i = 0; i < kLast - kFirst; i++) {
    text += fmt::format("{},{:.6f},{:.6f}\n", kFirst + i + 0.5, bins[i][0], bins[i][1]);
  }
  return text;
}

std::string script(const MotionStatistics& statistics) {
  std::string text =
      "# Draws the tables beside it: gnuplot stats.gp\n"
      "set datafile separator ','\nset grid lc rgb 'gray85'\n"
      "set style fill solid 0.15 noborder\nset xtics rotate by -40\nset xrange [-0.5:22.5]\n"
      "set output 'motion_rom.png'\nset terminal pngcairo size 1500,1350 font 'sans,14'\n";
  text += fmt::format(
      "set offsets 0,0,graph 0.25,0\nset key at graph 0.5,0.97 center top horizontal\n"
      "set multiplot layout 3,1 title \"Range of motion of each level over {} clips, {:.0f} s, the "
      "outer 5 % of frames left out\\nC2/C3: ours with all motion of the head above, as C1 and C2 "
      "move with it\" noenhanced\n",
      statistics.clips.size(), statistics.seconds);
  const bool others = !statistics.without_ligaments.turns.empty();
  int column = 2;
  for (const char* title : kTitles) {
    text += fmt::format(
        "set title '{}'\nset ylabel 'angle [deg]'\nset yrange [0:*]\n"
        "{}{}\n",
        title,
        plotLevels({"rom.csv", column, column + 2, column + 3, column + 4, "retrofitted motions",
                    "human"}),
        others ? fmt::format(", \\\n  '' skip 1 using 0:{} with lines dt 2 lw 1.5 lc rgb '#d98c3f' "
                             "title 'the same without ligaments'",
                             column + 1)
               : "");
    column += 5;
  }
  text +=
      "unset multiplot\nset offsets 0,0,0,0\nset key default\nset output 'motion_gaps.png'\n"
      "set terminal pngcairo size 1500,1000 font 'sans,14'\nset multiplot layout 2,1\n"
      "set title 'Distance of vertebral bodies against rest: mean and standard deviation over all "
      "frames'\nset ylabel 'change [mm]'\nset yrange [*:*]\nset key bottom right\n"
      "plot 'gaps.csv' skip 1 using ($0-0.1):6:7:xtic(1) with yerrorbars lw 2 pt 7 lc rgb "
      "'#d98c3f' title 'without discs', \\\n"
      "  '' skip 1 using ($0+0.1):3:4 with yerrorbars lw 2 pt 7 lc rgb '#1f4e9c' title 'with "
      "discs', \\\n"
      "  '' skip 1 using 0:(-$2) with points pt 2 ps 1.2 lc rgb 'gray40' title 'bones touch'\n"
      "set title 'Frames in which vertebral bodies collide'\nset ylabel 'share [%]'\n"
      "set yrange [0:*]\nset key top right\nset boxwidth 0.4\nset style fill solid 0.6 noborder\n"
      "plot 'gaps.csv' skip 1 using ($0-0.2):(100*$8):xtic(1) with boxes lc rgb '#d98c3f' title "
      "'without discs', \\\n"
      "  '' skip 1 using ($0+0.2):(100*$5) with boxes lc rgb '#1f4e9c' title 'with discs'\n"
      "unset multiplot\nset output 'motion_l5.png'\n"
      "set terminal pngcairo size 1100,600 font 'sans,14'\nset boxwidth 1\n"
      "set title 'L5 against the sacrum over all frames'\nset xtics norotate autofreq\n"
      "set xlabel 'extension (-), flexion (+) [deg]'\nset ylabel 'share of the frames [%]'\n"
      "set xrange [-40:70]\nset style fill solid 0.5 noborder\n"
      "plot 'l5.csv' skip 1 using 1:(100*$2) with boxes lc rgb '#1f4e9c' title 'with ligaments', "
      "\\\n  '' skip 1 using 1:(100*$3) with histeps lw 2 lc rgb '#d98c3f' title 'without "
      "ligaments'\n";
  return text;
}

}  // namespace

void writeMotionPlots(const std::string& folder, const Anatomy& anatomy,
                      const MotionStatistics& statistics) {
  writeFiles({{folder + "/rom.csv", romTable(anatomy, statistics)},
              {folder + "/gaps.csv", gapTable(statistics)},
              {folder + "/l5.csv", flexionTable(statistics)},
              {folder + "/stats.gp", script(statistics)}});
}

}  // namespace torso::tools
