// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/graft.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <tuple>

#include "model/body.h"
#include "tools/bone_files.h"
#include "tools/files.h"
#include "tools/graft_xml.h"
#include "tools/grafter.h"
#include "tools/torso_mjcf.h"

namespace torso::tools {
namespace {

namespace fs = std::filesystem;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using tinyxml2::XMLElement;

constexpr const char* kSides[2] = {"left_", "right_"};

struct TemporaryFolder {
  std::string path = (fs::temp_directory_path() / "torso_graft_XXXXXX").string();
  TemporaryFolder() {
    if (!mkdtemp(path.data())) throw Error(path + ": cannot make a temporary folder");
  }
  ~TemporaryFolder() {
    std::error_code error;
    fs::remove_all(path, error);
  }
};

}  // namespace

// Scale and place of our torso.
void Grafter::fit() {
  const mjModel* m = host_.model.get();
  const auto& [hip, shoulder] = std::tie(parts_.hip, parts_.shoulder);
  const auto pair = [](const Vector3d& left) {
    return std::array<Vector3d, 2>{left, torso::mirror(left)};
  };
  const auto our_hip = pair(table_size_.landmark("hip_joint_centre"));
  const auto our_shoulder = pair(table_size_.landmark("glenohumeral_centre_GH"));
  const auto distance = [](const auto& h, const auto& s) {
    return 0.5 * (s[0] + s[1] - h[0] - h[1]).norm();
  };
  report_.hip_to_shoulder_before = distance(hip, shoulder);
  report_.length_scale = report_.hip_to_shoulder_before / distance(our_hip, our_shoulder);

  double removed = 0, made = 0;
  for (const auto& [body, part] : parts_.trunk) removed += m->body_mass[body];
  for (const std::string& body : mjcfBodies(table_size_, MjcfOptions())) {
    made += bodyInertial(table_size_, body).mass;
  }
  if (removed <= 0) fail("the trunk has no mass");
  report_.mass_scale = removed / made;
  // Far from a human's size or density steps and stiffnesses of the tables mean nothing.
  const double density = report_.mass_scale / std::pow(report_.length_scale, 3);
  if (!(report_.length_scale > 0.2 && report_.length_scale < 5 && density > 0.02 && density < 50)) {
    fail(
        fmt::format("the trunk, {:.3g} m from hips to shoulders and {:.3g} kg, is not a human's; "
                    "are its units metres and kilograms?",
                    report_.hip_to_shoulder_before, removed));
  }
  report_.mass_before = mj_getTotalmass(m);
  a_ = table_size_.scaled(report_.length_scale, report_.mass_scale);

  const Matrix3d R = trunkAxes(hip, shoulder) * trunkAxes(our_hip, our_shoulder).transpose();
  place_ = isometry(Quaterniond(R), Vector3d::Zero());
  place_.translation() =
      0.5 * (hip[0] + hip[1]) - R * (report_.length_scale * 0.5 * (our_hip[0] + our_hip[1]));
}

std::string Grafter::bodyName(const std::string& body) const {
  std::string name = ours(body);
  while (mj_name2id(host_.model.get(), mjOBJ_BODY, name.c_str()) > 0 &&
         !removed_.count({"body", name})) {
    name = "torso_" + name;  // as renameClashes does
  }
  return name;
}

std::string Grafter::replacement(int body) const {
  const auto nearest = [&](Region region) {
    const Vector3d com(host_.data->xipos[3 * body], host_.data->xipos[3 * body + 1],
                       host_.data->xipos[3 * body + 2]);
    const Vector3d local = place_.inverse() * com;
    const Vertebra* best = nullptr;
    for (const Vertebra& v : a_.vertebrae) {
      if (v.region != region) continue;
      if (!best || std::abs(v.position.z() - local.z()) < std::abs(best->position.z() - local.z()))
        best = &v;
    }
    return best->name;
  };
  switch (parts_.trunk.at(body)) {
    case TrunkPart::kPelvis:
      return "pelvis";
    case TrunkPart::kWaist:
      return nearest(Region::kLumbar);
    case TrunkPart::kChest:
      return "ribcage";
    case TrunkPart::kNeck:
      return nearest(Region::kCervical);
    case TrunkPart::kHead:
      return "head";
    case TrunkPart::kLeftClavicle:
      return "left_clavicle";
    case TrunkPart::kRightClavicle:
      return "right_clavicle";
  }
  return "";
}

std::string Grafter::replacement(const std::string& body) const {
  for (const auto& [id, part] : parts_.trunk) {
    if (host_.bodyName(id) == body) return replacement(id);
  }
  return "";
}

void Grafter::writeMap() const {
  if (o_.write_map.empty()) return;
  PartMap map;
  for (const RecognisedPart& p : parts_.recognised) {
    std::vector<std::string>& names = map.bodies[p.part];
    for (const std::string& name : p.bodies) {
      // Only a body with a name can be in a map.
      if (mj_name2id(host_.model.get(), mjOBJ_BODY, name.c_str()) > 0) names.push_back(name);
    }
    if (names.empty() && !p.bodies.empty()) map.bodies.erase(p.part);
  }
  writeFile(o_.write_map, writePartMap(map, bodyMapParts()));
}

void Grafter::checkOutput() const {
  const auto same = [&](const std::string& file) {
    std::error_code error;
    return fs::equivalent(file, o_.output, error);
  };
  if (same(o_.input)) throw Error(o_.output + ": is the humanoid itself; name another file");
  for (const std::string& file : host_.included) {
    if (same(file)) throw Error(o_.output + ": is a file of the humanoid; name another one");
  }
  if (!o_.map.empty() && same(o_.map)) {
    throw Error(o_.output + ": is the map; name another file");
  }
}

GraftReport Grafter::run() {
  checkOutput();
  checkSettings();
  try {
    parts_ = recognise(host_, o_.map.empty() ? PartMap() : readPartMap(o_.map, bodyMapParts()));
  } catch (const Error&) {
    if (torsoOf(host_.model.get(), o_.input).ntorso == 0) throw;
    fail("it has a torso of ours already, and no other humanoid");
  }
  report_.parts = parts_.recognised;
  writeMap();
  fit();
  isolateDefaults();
  takeLimbs();
  takeCarried();
  removeTrunk();
  writeTorso();
  takeTrunkActuators();
  addGroups();
  dropReferences();
  takeKeyframes();
  mergeSettings();
  hangLimbs();
  merge();
  for (int k = 0; k < 2; k++) {
    const std::string arm = host_.bodyName(parts_.upper_arm[k]);
    const std::string thigh = host_.bodyName(parts_.thigh[k]);
    const char* why = "neighbours at a joint";
    exclude(arm, bodyName("ribcage"), why);
    exclude(arm, bodyName(std::string(kSides[k]) + "clavicle"), why);
    exclude(thigh, bodyName("L5"), why);
    exclude(thigh, bodyName("L4"), why);
  }

  const Files meshes = boneFiles(table_size_, *bones_);
  const TemporaryFolder stage;
  const std::string staged = stage.path + "/" + fs::path(o_.output).filename().string();
  ModelPtr m;
  for (std::size_t excluded = 0; excluded != excluded_.size();) {
    excluded = excluded_.size();
    write(staged, meshes);
    try {
      m = loadModel(staged);
    } catch (const Error& e) {
      const std::string what = e.what();
      fail("the grafted model does not load: " + what +
           (what.find("Rank-def") == std::string::npos
                ? ""
                : "; are two joints of a limb about one axis, without armature?"));
    }
    excludeOverlaps(m.get());
    writeKeyframes(m.get());
  }
  if (keyframes_) {
    write(staged, meshes);
    m = loadModel(staged);
  }
  check(m.get());
  if (!o_.dry_run) write(o_.output, meshes);
  return report_;
}

GraftReport graft(const Anatomy& anatomy, const GraftOptions& options) {
  return Grafter(anatomy, options).run();
}

}  // namespace torso::tools
