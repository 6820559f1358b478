// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/retrofit_clip.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>
#include <utility>

#include "tools/clock.h"
#include "tools/error.h"
#include "tools/files.h"
#include "tools/motion_bvh.h"
#include "tools/motion_file.h"
#include "tools/motion_glb.h"
#include "tools/paths.h"
#include "tools/performer.h"
#include "tools/posture.h"
#include "tools/retarget.h"
#include "tools/retrofit.h"
#include "tools/retrofit_readouts.h"
#include "tools/smoothness.h"
#include "tools/temporary_skeleton.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMostRate = 30;       // [Hz], unless told otherwise
constexpr double kPreparation = 0.15;  // share of a person's time until equilibrium begins; rough

double rounded(double x) { return std::round(x * 1e4) / 1e4; }

// Median and 95th percentile, times a factor; null of nothing.
Json spread(std::vector<double> values, double factor) {
  if (values.empty()) return {{"median", nullptr}, {"p95", nullptr}};
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    return rounded(
        factor * values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))]);
  };
  return {{"median", at(0.5)}, {"p95", at(0.95)}};
}

// Reasons why frames are flagged, alike but for their numbers: how often, and the largest number.
class FlagCounts {
 public:
  void add(const std::string& flag) {
    std::size_t from = 0;
    while (from < flag.size() && !std::isdigit(static_cast<unsigned char>(flag[from]))) from++;
    std::size_t to = from;
    while (to < flag.size() && std::isdigit(static_cast<unsigned char>(flag[to]))) to++;
    auto& [count, largest] = kinds_[{flag.substr(0, from), flag.substr(to)}];
    count++;
    if (to > from) largest = std::max(largest, std::stol(flag.substr(from, to - from)));
  }
  std::string text() const {
    std::string text;
    for (const auto& [kind, seen] : kinds_) {
      const auto& [count, largest] = seen;
      text += fmt::format("{}{} x {}", text.empty() ? "" : "; ", count, kind.first);
      if (largest >= 0) text += fmt::format("up to {}{}", largest, kind.second);
    }
    return text;
  }

 private:
  struct Seen {
    int count = 0;
    long largest = -1;
  };
  std::map<std::pair<std::string, std::string>, Seen> kinds_;
};

// The directions of the limbs' long bones, ours against the clip's own joints: independent of how
// the targets were made [rad].
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
      errors.push_back(std::atan2(a.cross(b).norm(), a.dot(b)));
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

// The temporary skeleton's motion: time [s] and qpos, a row for each frame.
std::string temporaryCsv(const Retargeted& result) {
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

Json describe(const Person& person, const Performer& performer, const Targets& targets) {
  Json parts = Json::array();
  for (const RecognisedPart& part : person.roles.recognised) {
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
  const Clip& clip = person.clip;
  return {{"clip", person.name},
          {"file", clip.path},
          {"frames", clip.frames()},
          {"rate_hz", rounded(clip.rate)},
          {"seconds", rounded(static_cast<double>(clip.frames()) / clip.rate)},
          {"unit_m", performer.unit},
          {"stature_m", rounded(performer.anatomy.stature())},
          {"torso_scale", rounded(performer.torso_scale)},
          {"limb_scale", performer.limb_scale},
          {"parts", parts},
          {"kept_at_rest", missing},
          {"notes", notes}};
}

void addErrors(Json* row, const HeldMotion& motion, const RetrofitResult& result) {
  // [of all frames, of those that are not flagged].
  std::array<std::vector<double>, 2> positions, rotations;
  FlagCounts flags;
  size_t flagged = 0;
  constexpr double kDegrees = 180 / M_PI;
  // Of these, within 3 mm and 1 degree, within 10 mm and 3 degrees.
  std::array<std::array<size_t, 2>, 2> within{};
  for (const RetrofitFrame& frame : result.frames) {
    const double mm = 1e3 * frame.position_error, degrees = kDegrees * frame.rotation_error;
    for (size_t k = 0; k <= (frame.flags.empty() ? 1 : 0); k++) {
      within[k][0] += mm < 3 && degrees < 1;
      within[k][1] += mm < 10 && degrees < 3;
      positions[k].push_back(frame.position_error);
      rotations[k].push_back(frame.rotation_error);
    }
    flagged += !frame.flags.empty();
    for (const std::string& flag : frame.flags) flags.add(flag);
  }
  (*row)["held_error_mm"] = spread(positions[0], 1e3);
  (*row)["held_error_deg"] = spread(rotations[0], kDegrees);
  (*row)["reached_error_mm"] = spread(positions[1], 1e3);
  (*row)["reached_error_deg"] = spread(rotations[1], kDegrees);
  (*row)["skeleton_error_mm"] = spread(motion.position_errors, 1e3);
  (*row)["skeleton_error_deg"] = spread(motion.rotation_errors, kDegrees);
  (*row)["frames_flagged"] = flagged;
  (*row)["frames_within_3mm_1deg"] = within[0][0];
  (*row)["frames_within_10mm_3deg"] = within[0][1];
  (*row)["reached_within_3mm_1deg"] = within[1][0];
  (*row)["reached_within_10mm_3deg"] = within[1][1];
  (*row)["flags"] = flags.text();
}

// Of the turns of levels and scapulae, against those of the held bones.
void addSmoothness(Json* row, const HeldMotion& motion, const RetrofitResult& result,
                   const std::vector<std::string>& names) {
  if (result.frames.size() < 4) return;
  std::vector<std::vector<Eigen::Vector3d>> turns;
  for (const RetrofitFrame& frame : result.frames) turns.push_back(frame.turns);
  const Smoothness s = smoothness(heldTurns(motion), turns, result.rate);
  (*row)["band_hz"] = rounded(s.band);
  (*row)["power_above_band_over_input"] = rounded(s.gain);
  (*row)["largest_jump_deg"] = rounded(s.largest_jump * 180 / M_PI);
  (*row)["largest_own_jump_deg"] =
      rounded(ExplainedJumps(motion).largestBeyond(names, turns) * 180 / M_PI);
}

// The body's file: in the scene and with the meshes that lie beside it, so that the folder may
// move.
std::string inScene(std::string mjcf, const std::string& meshes) {
  const std::string from = "file=\"" + meshes + "/", to = "file=\"assets/";
  for (std::size_t at = 0; (at = mjcf.find(from, at)) != std::string::npos; at += to.size()) {
    mjcf.replace(at, from.size(), to);
  }
  const std::size_t root = mjcf.find('>', mjcf.find("<mujoco"));
  return mjcf.substr(0, root + 1) + "\n    <include file=\"scene.xml\"/>" + mjcf.substr(root + 1);
}

// Of a file: without what shells and file systems do not like.
std::string fileName(std::string name) {
  for (char& c : name) {
    const auto u = static_cast<unsigned char>(c);
    if (u < 0x80 && !std::isalnum(u) && c != '.' && c != '-') c = '_';
  }
  return name;
}

}  // namespace

std::vector<Person> readPersons(const std::string& path, const std::string& stem, double rate,
                                const PartMap& map, std::vector<std::string>* errors) {
  std::vector<Person> persons;
  const auto attempt = [&](const auto& work) {
    try {
      work();
    } catch (const Error& e) {
      errors->push_back(e.what());
    }
  };
  const std::string file_stem = std::filesystem::path(path).stem().string();
  attempt([&] {
    for (Clip& take : readClips(path)) {
      attempt([&] {
        const double to = rate > 0 ? rate : std::min(take.rate, kMostRate);
        const Clip clip = resampled(take, to);
        const std::vector<Roles> found = findRoles(clip, map);
        for (size_t k = 0; k < found.size(); k++) {
          const bool begins = clip.name.rfind(file_stem, 0) == 0;
          std::string name = stem + (begins ? clip.name.substr(file_stem.size()) : "_" + clip.name);
          if (found.size() > 1) name += fmt::format("_{}", k + 1);
          persons.push_back({fileName(name), clip, found[k]});
        }
      });
    }
  });
  return persons;
}

Json describePerson(const Anatomy& tables, const Person& person) {
  const Performer performer = measurePerformer(tables, person.clip, person.roles);
  return describe(person, performer,
                  makeTargets(inWorld(person.clip, performer), person.roles, performer));
}

Json retrofitPerson(const Anatomy& tables, const Person& person, const std::string& folder,
                    bool temporary, const std::function<void(double)>& progress) {
  const double start = threadSeconds();
  const std::string meshes = mjcfFolder() + "/assets";
  const Performer performer = measurePerformer(tables, person.clip, person.roles);
  const Clip world = inWorld(person.clip, performer);
  const Targets targets = makeTargets(world, person.roles, performer);
  Json row = describe(person, performer, targets);
  const Retargeted posed = solveMotion(targets, performer, person.name, person.clip.rate);
  progress(0.5 * kPreparation);
  const std::string mjcf = performerMjcf(tables, performer, meshes, meshes);
  const RetrofitModels models(BodyMjcf(mjcf, person.name));
  progress(kPreparation);
  const RetrofitResult result =
      retrofit(models, posed.motion, RetrofitOptions(),
               [&](double share) { progress(kPreparation + (1 - kPreparation) * share); });

  const Motion motion = motionOf(models, result);
  const mjModel* m = models.human.get();
  const std::string base = folder + "/" + person.name;
  std::map<std::string, std::string> files = {
      {base + ".csv", motionCsv(motion)},
      {base + ".bin", motionBinary(motion)},
      {base + ".bvh", motionBvh(m, motion)},
      {base + ".glb", motionGlb(compileModel(mjcf, person.name).get(), motion)},
      {base + ".xml", inScene(mjcf, meshes)},
      {base + "_readouts.csv", readoutsCsv(models, result)}};
  if (temporary) {
    files[base + "_temporary.xml"] =
        temporarySkeletonMjcf(performer.anatomy, meshes, performer.limb_scale);
    files[base + "_temporary.csv"] = temporaryCsv(posed);
  }
  writeFiles(files);

  addErrors(&row, posed.motion, result);
  addSmoothness(&row, posed.motion, result, Posture(models.torso.get()).names());
  const std::vector<double> directions = directionErrors(world, person.roles, posed.motion);
  if (!directions.empty()) row["limb_direction_error_deg"] = spread(directions, 180 / M_PI);
  const double core_seconds = threadSeconds() - start;
  row["core_seconds"] = rounded(core_seconds);
  row["core_s_per_s"] = rounded(core_seconds / row["seconds"].get<double>());
  row["equilibrium_core_seconds"] = rounded(result.core_seconds);
  return row;
}

}  // namespace torso::tools
