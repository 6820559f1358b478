// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "tools/clip.h"
#include "tools/commands.h"
#include "tools/error.h"
#include "tools/files.h"
#include "tools/paths.h"
#include "tools/progress_bar.h"
#include "tools/retarget.h"
#include "tools/role.h"
#include "tools/temporary_skeleton.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::vector<std::string> clips;
  std::string output, map, write_map, anatomy;
  double rate = 0;
  bool explain = false, json = false;
};

double percentile(std::vector<double> values, double share) {
  const auto at =
      values.begin() + static_cast<long>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

Json describe(const Clip& clip, const Performer& performer, const Targets& targets,
              const Retargeted& result, const Roles& roles, double seconds) {
  const HeldMotion& motion = result.motion;
  const auto rounded = [](double x) { return std::round(x * 1e4) / 1e4; };
  std::vector<double> mm, degrees;
  size_t flagged = 0;
  for (size_t f = 0; f < motion.frames(); f++) {
    mm.push_back(1e3 * motion.position_errors[f]);
    degrees.push_back(motion.rotation_errors[f] * 180 / M_PI);
    flagged += !motion.flags[f].empty();
  }
  Json parts = Json::array();
  for (const RecognisedPart& part : roles.recognised) {
    parts.push_back({{"part", part.part},
                     {"joints", part.bodies},
                     {"sureness", part.sureness},
                     {"reason", part.reason}});
  }
  std::vector<std::string> notes = performer.notes, missing;
  notes.insert(notes.end(), targets.notes.begin(), targets.notes.end());
  for (size_t b = 0; b < heldBodies().size(); b++) {
    if (!targets.has[b]) missing.push_back(heldBodies()[b]);
  }
  return {{"clip", motion.name},
          {"file", clip.path},
          {"frames", motion.frames()},
          {"rate_hz", rounded(motion.rate)},
          {"unit_m", performer.unit},
          {"stature_m", rounded(performer.anatomy.stature())},
          {"torso_scale", rounded(performer.torso_scale)},
          {"limb_scale", performer.limb_scale},
          {"parts", parts},
          {"kept_at_rest", missing},
          {"notes", notes},
          {"position_error_mm",
           {{"median", rounded(percentile(mm, 0.5))}, {"p95", rounded(percentile(mm, 0.95))}}},
          {"rotation_error_deg",
           {{"median", rounded(percentile(degrees, 0.5))},
            {"p95", rounded(percentile(degrees, 0.95))}}},
          {"frames_flagged", flagged},
          {"seconds", rounded(seconds)}};
}

void explain(const Json& clip) {
  fmt::print("{}\n", clip["clip"].get<std::string>());
  for (const Json& part : clip["parts"]) {
    std::string joints;
    for (const std::string joint : part["joints"]) joints += (joints.empty() ? "" : ", ") + joint;
    fmt::print("  {:<16} {:<28} {}: {}\n", part["part"].get<std::string>(),
               joints.empty() ? "-" : joints, part["sureness"].get<std::string>(),
               part["reason"].get<std::string>());
  }
  fmt::print("  stature {:.2f} m, trunk {:.3f} of the tables', limbs on top of it:",
             clip["stature_m"].get<double>(), clip["torso_scale"].get<double>());
  for (const auto& [segment, scale] : clip["limb_scale"].items()) {
    fmt::print(" {} {:.3f}", segment, scale.get<double>());
  }
  fmt::print("\n");
  for (const std::string note : clip["notes"]) fmt::print("  note: {}\n", note);
  if (!clip["kept_at_rest"].empty()) {
    std::string names;
    for (const std::string name : clip["kept_at_rest"]) names += (names.empty() ? "" : ", ") + name;
    fmt::print("  not in the clip, kept at rest: {}\n", names);
  }
}

void print(const Json& clip) {
  fmt::print("{:<44} {:>6} {:>7.4g} {:>8.2f} {:>8.2f} {:>7.2f} {:>7.2f} {:>7} {:>7.2f}\n",
             clip["clip"].get<std::string>(), clip["frames"].get<size_t>(),
             clip["rate_hz"].get<double>(), clip["position_error_mm"]["median"].get<double>(),
             clip["position_error_mm"]["p95"].get<double>(),
             clip["rotation_error_deg"]["median"].get<double>(),
             clip["rotation_error_deg"]["p95"].get<double>(), clip["frames_flagged"].get<size_t>(),
             clip["seconds"].get<double>());
}

// The temporary skeleton's motion: time [s] and qpos, a row for each frame.
std::string motionCsv(const Retargeted& result) {
  std::string text = "time";
  for (size_t k = 0; k < result.qpos.front().size(); k++) text += fmt::format(",qpos{}", k);
  text += "\n";
  for (size_t f = 0; f < result.qpos.size(); f++) {
    text += fmt::format("{:.6f}", static_cast<double>(f) / result.motion.rate);
    for (double x : result.qpos[f]) text += fmt::format(",{:.8g}", x);
    text += "\n";
  }
  return text;
}

// The directions of the limbs' long bones, ours against the clip's own joints: independent of how
// the targets were made [deg].
std::vector<double> directionErrors(const Clip& world, const Roles& roles,
                                    const HeldMotion& motion) {
  std::vector<double> errors;
  const auto ours = [&](size_t f, int body) {
    return Eigen::Vector3d(motion.positions[f * motion.bodies.size() + body].data());
  };
  const auto compare = [&](int side, LimbBody from, LimbBody to, int joint, int next) {
    if (joint < 0 || next < 0) return;
    for (size_t f = 0; f < motion.frames(); f++) {
      const Eigen::Vector3d a = ours(f, heldBody(side, to)) - ours(f, heldBody(side, from));
      const Eigen::Vector3d b =
          world.pose(f, next).translation() - world.pose(f, joint).translation();
      errors.push_back(std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI);
    }
  };
  for (int k = 0; k < 2; k++) {
    compare(k, kUpperArm, kLowerArm, roles.upper_arm[k], roles.lower_arm[k]);
    compare(k, kLowerArm, kHand, roles.lower_arm[k], roles.hand[k]);
    compare(k, kThigh, kShin, roles.thigh[k], roles.shin[k]);
    compare(k, kShin, kFoot, roles.shin[k], roles.foot[k]);
  }
  return errors;
}

void retrofitPerson(const Options& options, const Anatomy& tables, const Clip& clip,
                    const Roles& roles, const std::string& name, Json& report) {
  const auto start = std::chrono::steady_clock::now();
  const Performer performer = measurePerformer(tables, clip, roles);
  const Clip world = inWorld(clip, performer);
  const Targets targets = makeTargets(world, roles, performer);
  const Retargeted result = solveMotion(targets, performer, name, clip.rate);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  Json line = describe(clip, performer, targets, result, roles, time.count());
  const std::vector<double> directions = directionErrors(world, roles, result.motion);
  if (!directions.empty()) {
    line["limb_direction_error_deg"] = {{"median", percentile(directions, 0.5)},
                                        {"p95", percentile(directions, 0.95)}};
  }
  if (!options.write_map.empty()) {
    writeFile(options.write_map, writePartMap(mapOf(clip, roles), roleMapParts()));
  }
  if (!options.output.empty()) {
    writeFiles(
        {{options.output + "/" + name + "_temporary.xml",
          temporarySkeletonMjcf(performer.anatomy, mjcfFolder() + "/assets", performer.limb_scale)},
         {options.output + "/" + name + "_temporary.csv", motionCsv(result)}});
  }
  const bool first = std::none_of(report.begin(), report.end(),
                                  [](const Json& other) { return other.contains("clip"); });
  report.push_back(line);
  if (options.json) return;
  if (first) {
    fmt::print("{:<44} {:>6} {:>7} {:>17} {:>15} {:>7} {:>7}\n", "clip", "frames", "Hz",
               "position [mm]", "rotation [deg]", "flagged", "time");
  }
  if (options.explain) explain(line);
  print(line);
}

// Each person of each take; what fails does not stop the others. Returns how many went through.
int retrofit(const Options& options, const Anatomy& tables, Json& report) {
  const PartMap map = options.map.empty() ? PartMap() : readPartMap(options.map, roleMapParts());
  int done = 0;
  const auto attempt = [&](const std::string& path, const auto& work) {
    try {
      work();
    } catch (const Error& e) {
      fmt::print(stderr, "torso retrofit: {}\n", e.what());
      report.push_back({{"file", path}, {"error", e.what()}});
    }
  };
  for (const std::string& path : options.clips) {
    std::vector<Clip> takes;
    attempt(path, [&] { takes = readClips(path); });
    for (Clip& take : takes) {
      attempt(path, [&] {
        const Clip clip = options.rate > 0 ? resampled(take, options.rate) : std::move(take);
        const std::vector<Roles> persons = findRoles(clip, map);
        for (size_t k = 0; k < persons.size(); k++) {
          const std::string name =
              clip.name + (persons.size() > 1 ? fmt::format("_{}", k + 1) : "");
          attempt(path, [&] {
            retrofitPerson(options, tables, clip, persons[k], name, report);
            done++;
          });
        }
      });
    }
  }
  return done;
}

}  // namespace

void addRetrofit(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "retrofit", "Recover spine and shoulder motion from motion capture clips.");
  command->footer(
      "Reads BVH, FBX, glTF and GLB with a human skeleton of any names, unit and axes. A clip "
      "that\n"
      "cannot be used is reported and does not stop the others. Prints for each clip its frames\n"
      "and rate [Hz], how far held bones are from the clip's [mm, degrees; median and 95 % over\n"
      "frames of the bone that is worst in each], frames flagged and seconds of work.\n\n"
      "Examples:\n"
      "  torso retrofit walk.bvh -o out\n"
      "  torso retrofit *.fbx --rate 30 -o out\n"
      "  torso retrofit odd.glb --explain --write-map map.json   what is taken for what, and why\n"
      "  torso retrofit odd.glb --map map.json -o out            with that corrected");
  command->add_option("clips", options->clips, "Motion capture files")->required();
  command->add_option("-o,--output", options->output, "Folder to write into");
  command->add_option("--map", options->map, "JSON file that says which joint is what");
  command->add_option("--write-map", options->write_map,
                      "Write what was recognised to this file, to be edited for --map");
  command->add_option("--rate", options->rate, "Frames per second [Hz] (default: the clip's own)")
      ->check(CLI::PositiveNumber);
  command->add_flag("--explain", options->explain, "Say what was recognised and why");
  command->add_option("--anatomy", options->anatomy, "Folder of the anatomy tables");
  command->add_flag("--json", options->json, "Print the report as JSON on stdout");
  command->callback([options] {
    if (!options->output.empty()) checkFolder(options->output);
    const Anatomy tables =
        Anatomy::load(options->anatomy.empty() ? anatomyFolder() : options->anatomy);
    Json report = Json::array();
    const int done = retrofit(*options, tables, report);
    if (options->json) std::cout << report.dump(2) << '\n';
    if (done == 0) throw Error("no clip could be used");
  });
}

}  // namespace torso::tools
