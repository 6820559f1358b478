// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/shoulder_rhythm.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/csv.h"
#include "tools/files.h"

namespace torso::tools {
namespace {

constexpr double kDegree = EIGEN_PI / 180;
constexpr int kPoses = 30;        // on the way up
constexpr int kGirdlePoses = 10;  // on the way to the end

// From the setting phase to the top.
double elevationRatio(const std::vector<ShoulderPose>& poses) {
  const ShoulderPose& top =
      *std::max_element(poses.begin(), poses.end(),
                        [](const auto& a, const auto& b) { return a.elevation < b.elevation; });
  const double scapula = top.upward_rotation - upwardRotationAt(poses, kSetting);
  return (top.elevation - kSetting - scapula) / scapula;
}

std::string published(const std::vector<PublishedRhythm>& rows, const std::string& source) {
  std::string text;
  for (const PublishedRhythm& row : rows) {
    if (row.quantity != "upward_rotation" || row.source != source) continue;
    text += fmt::format("{:.4g},{:.4g}\n", row.elevation / kDegree, row.value / kDegree);
  }
  return text;
}

}  // namespace

std::vector<PublishedRhythm> readShoulderRhythm(const std::string& path) {
  const CsvTable table(path);
  std::vector<PublishedRhythm> rows;
  for (int i = 0; i < table.rows(); i++) {
    const bool ratio = table.text(i, "quantity") == "elevation_ratio";
    rows.push_back({table.text(i, "quantity"),
                    ratio ? 0 : table.number(i, "elevation_deg") * kDegree,
                    table.number(i, "value") * (ratio ? 1 : kDegree), table.text(i, "source"),
                    table.text(i, "provenance")});
  }
  return rows;
}

double upwardRotationAt(const std::vector<ShoulderPose>& poses, double elevation) {
  for (std::size_t i = 1; i < poses.size(); i++) {
    const ShoulderPose &a = poses[i - 1], &b = poses[i];
    if ((a.elevation - elevation) * (b.elevation - elevation) > 0) continue;
    const double share = (elevation - a.elevation) / (b.elevation - a.elevation);
    return a.upward_rotation + share * (b.upward_rotation - a.upward_rotation);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

ShoulderReport measureShoulder(ShoulderBench& bench, double seconds,
                               const std::vector<ScapularMuscle>& muscles) {
  ShoulderReport report = {};
  report.rest = bench.rest();
  report.raising = bench.raiseArm(kArmRaised, seconds, kPoses, muscles);
  report.lowering.assign(report.raising.begin() + kPoses - 1, report.raising.end());
  report.raising.resize(kPoses);
  report.raising_ratio = elevationRatio(report.raising);
  report.lowering_ratio = elevationRatio(report.lowering);
  for (const GirdleMotion motion : kGirdleMotions) {
    report.girdle.push_back({motion, bench.moveGirdle(motion, kGirdlePoses)});
  }
  report.clearance = std::numeric_limits<double>::infinity();
  const auto include = [&report](const std::vector<ShoulderPose>& poses) {
    for (const ShoulderPose& p : poses) {
      report.gliding_distance = std::max(report.gliding_distance, p.gliding_distance);
      report.clearance = std::min(report.clearance, p.clearance);
      report.medial_border = std::max(report.medial_border, p.medial_border);
      report.inferior_angle = std::max(report.inferior_angle, p.inferior_angle);
    }
  };
  include(report.raising);
  include(report.lowering);
  for (const auto& [motion, poses] : report.girdle) include(poses);
  return report;
}

void writeShoulderPlots(const std::string& folder, const ShoulderReport& report,
                        const std::vector<PublishedRhythm>& rows) {
  makeFolder(folder);
  std::string table =
      "way,elevation_deg,upward_rotation_deg,posterior_tilt_deg,external_rotation_deg,"
      "clavicle_elevation_deg,clavicle_retraction_deg,clavicle_posterior_rotation_deg,"
      "gliding_distance_mm,clearance_mm,medial_border_mm,inferior_angle_mm\n";
  for (const bool up : {true, false}) {
    for (const ShoulderPose& p : up ? report.raising : report.lowering) {
      table += fmt::format(
          "{},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f}\n",
          up ? "raising" : "lowering", p.elevation / kDegree, p.upward_rotation / kDegree,
          p.posterior_tilt / kDegree, p.external_rotation / kDegree, p.clavicle_elevation / kDegree,
          p.clavicle_retraction / kDegree, p.clavicle_posterior_rotation / kDegree,
          p.gliding_distance * 1e3, p.clearance * 1e3, p.medial_border * 1e3,
          p.inferior_angle * 1e3);
    }
    table += "\n\n";  // gnuplot: the next data set
  }
  writeFile(folder + "/shoulder.csv", table);
  std::string script =
      "# Draws the table beside it: gnuplot shoulder.gp\n"
      "set terminal pngcairo size 1500,650 font 'sans,13'\nset output 'shoulder.png'\n"
      "set datafile separator ','\nset grid lc rgb 'gray80'\nset xrange [0:155]\n"
      "set xlabel 'elevation of the humerus against the thorax, coronal plane [deg]'\n"
      "set key top left Left reverse\n";
  for (const auto& [name, source] :
       {std::pair{"inman", "Inman 1944"}, {"mcclure", "McClure 2001"}}) {
    script += fmt::format("${} << EOD\n{}EOD\n", name, published(rows, source));
  }
  script +=
      "set multiplot layout 1,2\n"
      "set title 'Scapulohumeral rhythm: red, published; blue, ours'\n"
      "set ylabel 'upward rotation of the scapula [deg]'\n"
      "plot $inman with linespoints lw 2 dt 2 pt 5 lc rgb '#d62728' title 'Inman 1944 (setting, "
      "then 2:1)', \\\n"
      "  $mcclure with linespoints lw 2 pt 9 ps 1.3 lc rgb '#d62728' title 'McClure 2001 (bone "
      "pins)', \\\n"
      "  'shoulder.csv' index 0 skip 1 using 2:3 with lines lw 3 lc rgb '#1f4e9c' title 'ours, "
      "raising', \\\n"
      "  '' index 1 using 2:3 with lines lw 2 dt 4 lc rgb '#1f4e9c' title 'ours, lowering'\n"
      "set title 'Scapula and clavicle while the arm is raised'\nset ylabel 'change [deg]'\n"
      "plot for [i=4:8] 'shoulder.csv' index 0 skip 1 using 2:i with lines lw 2 title "
      "word('\"tilt of the scapula, backward\" \"external rotation of the scapula\" "
      "\"elevation of the clavicle\" \"retraction of the clavicle\" "
      "\"backward rotation of the clavicle\"', "
      "i-3)\nunset multiplot\n";
  writeFile(folder + "/shoulder.gp", script);
}

}  // namespace torso::tools
