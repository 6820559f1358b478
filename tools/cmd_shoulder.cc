// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/bone_files.h"
#include "tools/commands.h"
#include "tools/gnuplot.h"
#include "tools/paths.h"
#include "tools/shoulder_pictures.h"
#include "tools/shoulder_rhythm.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegree = EIGEN_PI / 180;

struct Options {
  double seconds = 60;
  bool json = false, no_muscles = false;
  std::string plot_folder;
};

// What a row of the published table is beside, at the top of the motion.
double ours(const ShoulderPose& top, const std::string& quantity) {
  return quantity == "upward_rotation"       ? top.upward_rotation
         : quantity == "posterior_tilt"      ? top.posterior_tilt
         : quantity == "external_rotation"   ? top.external_rotation
         : quantity == "clavicle_elevation"  ? top.clavicle_elevation
         : quantity == "clavicle_retraction" ? top.clavicle_retraction
                                             : top.clavicle_posterior_rotation;
}

Json describe(const ShoulderPose& p) {
  return {{"elevation_deg", p.elevation / kDegree},
          {"upward_rotation_deg", p.upward_rotation / kDegree},
          {"posterior_tilt_deg", p.posterior_tilt / kDegree},
          {"external_rotation_deg", p.external_rotation / kDegree},
          {"clavicle_elevation_deg", p.clavicle_elevation / kDegree},
          {"clavicle_retraction_deg", p.clavicle_retraction / kDegree},
          {"clavicle_posterior_rotation_deg", p.clavicle_posterior_rotation / kDegree},
          {"gliding_distance_mm", p.gliding_distance * 1e3},
          {"clearance_mm", p.clearance * 1e3},
          {"medial_border_mm", p.medial_border * 1e3},
          {"inferior_angle_mm", p.inferior_angle * 1e3}};
}

Json describe(const std::vector<ShoulderPose>& poses) {
  Json all = Json::array();
  for (const ShoulderPose& p : poses) all.push_back(describe(p));
  return all;
}

Json describe(const ShoulderReport& report, const std::vector<PublishedRhythm>& published) {
  Json girdle, rows = Json::array();
  for (const auto& [motion, poses] : report.girdle) {
    girdle[girdleMotionName(motion)] = describe(poses);
  }
  for (const PublishedRhythm& row : published) {
    const bool ratio = row.quantity == "elevation_ratio";
    Json json = {{"quantity", row.quantity}, {"value", ratio ? row.value : row.value / kDegree}};
    if (!ratio) json["elevation_deg"] = row.elevation / kDegree;
    json["source"] = row.source;
    json["provenance"] = row.provenance;
    rows.push_back(json);
  }
  return {{"raising_ratio", report.raising_ratio},
          {"lowering_ratio", report.lowering_ratio},
          {"gliding_distance_mm", report.gliding_distance * 1e3},
          {"clearance_mm", report.clearance * 1e3},
          {"medial_border_mm", report.medial_border * 1e3},
          {"inferior_angle_mm", report.inferior_angle * 1e3},
          {"raising", describe(report.raising)},
          {"lowering", describe(report.lowering)},
          {"girdle", girdle},
          {"published", rows}};
}

void print(const ShoulderReport& report, const std::vector<PublishedRhythm>& published) {
  const auto at = [&](const char* source, double elevation) -> std::string {
    for (const PublishedRhythm& row : published) {
      if (row.quantity == "upward_rotation" && row.source == source &&
          std::abs(row.elevation - elevation) < 0.5 * kDegree) {
        return fmt::format("{:.0f}", row.value / kDegree);
      }
    }
    return "-";
  };
  const ShoulderPose& top = report.raising.back();
  fmt::print("upward rotation of the scapula from the arm at the side [deg]\n");
  fmt::print("{:>9}{:>10}{:>10}{:>12}{:>14}\n", "elevation", "raising", "lowering", "Inman 1944",
             "McClure 2001");
  for (double elevation = 30; elevation <= 150; elevation += 30) {
    // The couple that guides the arm stays a degree or two behind at the top.
    const double e = std::min(elevation * kDegree, top.elevation);
    fmt::print("{:>9.0f}{:>10.1f}{:>10.1f}{:>12}{:>14}\n", e / kDegree,
               upwardRotationAt(report.raising, e) / kDegree,
               upwardRotationAt(report.lowering, e) / kDegree,
               at("Inman 1944", elevation * kDegree), at("McClure 2001", elevation * kDegree));
  }
  fmt::print(
      "glenohumeral to scapular rotation from 30 deg on: {:.2f}:1 raising, {:.2f}:1 lowering "
      "(published",
      report.raising_ratio, report.lowering_ratio);
  for (const PublishedRhythm& row : published) {
    if (row.quantity == "elevation_ratio") fmt::print(" {:.1f}, {};", row.value, row.source);
  }
  fmt::print(")\n\nat the top [deg]{:>21}{:>12}\n", "ours", "published");
  for (const PublishedRhythm& row : published) {
    if (row.quantity == "elevation_ratio" || row.quantity == "upward_rotation") continue;
    fmt::print("{:<30}{:>7.1f}{:>12.1f}  {}\n", row.quantity, ours(top, row.quantity) / kDegree,
               row.value / kDegree, row.source);
  }
  fmt::print("\nthe girdle by its servos [deg]{:>12}{:>12}{:>20}\n", "elevation", "retraction",
             "medial border [mm]");
  for (const auto& [motion, poses] : report.girdle) {
    const ShoulderPose& end = poses.back();
    fmt::print("{:<30}{:>12.1f}{:>12.1f}{:>12.1f}, {:.1f} at rest\n", girdleMotionName(motion),
               end.clavicle_elevation / kDegree, end.clavicle_retraction / kDegree,
               end.medial_border * 1e3, poses.front().medial_border * 1e3);
  }
  fmt::print(
      "\nlargest distance of the scapula from its ellipsoid {:.1f} mm; least between the bones of "
      "scapula and rib cage {:.1f} mm;\nlargest of its medial border from the ribs {:.1f} mm, of "
      "its inferior angle {:.1f} mm (at rest {:.1f} and {:.1f})\n",
      report.gliding_distance * 1e3, report.clearance * 1e3, report.medial_border * 1e3,
      report.inferior_angle * 1e3, report.rest.medial_border * 1e3,
      report.rest.inferior_angle * 1e3);
}

void shoulder(const Options& options) {
  const Anatomy anatomy = Anatomy::load(anatomyFolder());
  const Skeleton skeleton =
      readSkeleton(anatomy, mjcfFolder() + "/assets", ShoulderBench::bodies());
  ShoulderBench bench(anatomy, skeleton);
  std::vector<ScapularMuscle> muscles;
  if (!options.no_muscles) {
    muscles = readScapularMuscles(anatomyFolder() + "/scapular_muscles.csv");
  }
  const ShoulderReport report = measureShoulder(bench, options.seconds, muscles);
  const std::vector<PublishedRhythm> published =
      readShoulderRhythm(anatomyFolder() + "/shoulder_rhythm.csv");
  if (options.json) {
    std::cout << describe(report, published).dump(2) << '\n';
  } else {
    print(report, published);
    std::fflush(stdout);
  }
  if (options.plot_folder.empty()) return;
  writeShoulderPlots(options.plot_folder, report, published);
  writeShoulderPictures(options.plot_folder, loadModel(mjcfFolder() + "/human.xml").get(), report);
  runGnuplot("shoulder", options.plot_folder, "shoulder.gp");
}

}  // namespace

void addShoulder(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "shoulder", "Scapulohumeral rhythm and motion of the shoulder girdle, against publications.");
  command->footer(
      "The left shoulder with the rib cage clamped. A couple between rib cage and humerus raises "
      "the\n"
      "arm in the coronal plane to 150 degrees and lowers it, and serratus anterior and trapezius\n"
      "pull (model/anatomy/scapular_muscles.csv); no servos, no gravity: the scapula follows as\n"
      "they, the capsule of the glenohumeral joint, the springs of the clavicle's joints and the\n"
      "ellipsoid that it glides on have it. Then, under gravity, the servos of the\n"
      "sternoclavicular joint shrug, protract and retract the girdle. Angles as ISB defines them,\n"
      "from the pose at rest. Published curves: model/anatomy/shoulder_rhythm.csv.\n\n"
      "Examples:\n"
      "  torso shoulder\n"
      "  torso shoulder --plot out/shoulder\n"
      "  torso shoulder --no-muscles\n"
      "  torso shoulder --json | jq .raising_ratio");
  command->add_option("--seconds", options->seconds, "Time to raise the arm, and to lower it [s]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_flag("--no-muscles", options->no_muscles,
                    "Let the couple on the arm alone move the scapula");
  command->add_flag("--json", options->json, "Print JSON, with all poses");
  command->add_option("--plot", options->plot_folder,
                      "Write the curves into this folder and draw them with gnuplot, and pictures "
                      "of the poses");
  command->callback([options] { shoulder(*options); });
}

}  // namespace torso::tools
