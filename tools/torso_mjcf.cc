// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/torso_mjcf.h"

#include <algorithm>

#include "model/body.h"
#include "model/disc_fit.h"
#include "tools/simple_trunk.h"
#include "tools/torso_mjcf_writer.h"
#include "tools/whole_shoulder.h"

namespace torso::tools {
namespace {

bool isRigidPart(const std::string& body) {
  const auto [side, name] = splitSide(body);
  return side == Side::kMiddle || name == "clavicle" || name == "scapula";
}

}  // namespace

std::string MjcfWriter::host(const std::string& body) const {
  if (detailed() || !isRigidPart(body) || body == "head") return body;
  return o_.kind == TorsoKind::kSimple ? simpleTrunkBody(a_, body) : "pelvis";
}

std::vector<std::string> MjcfWriter::hosts() const {
  std::vector<std::string> all;
  for (const std::string& body : mjcfBodies(a_, o_)) {
    const std::string name = host(body);
    if (std::find(all.begin(), all.end(), name) == all.end()) all.push_back(name);
  }
  return all;
}

void MjcfWriter::write() {
  root_->SetAttribute("model", named(o_.limbs ? "human" : "torso").c_str());
  if (detailed()) {
    const Skeleton* bones = o_.skeleton;
    for (const Facet& facet : o_.own  ? o_.own->facets
                              : bones ? makeFacets(a_, *bones)
                                      : makeFacets(a_)) {
      if (has(facet.points_body) && has(facet.ellipsoid_body)) facets_.push_back(facet);
    }
    for (const LigamentSegment& s : o_.own  ? o_.own->ligaments
                                    : bones ? makeLigaments(a_, *bones)
                                            : makeLigaments(a_)) {
      if (has(bodyOfLevel(a_, s.lower)) && has(bodyOfLevel(a_, s.upper))) ligaments_.push_back(s);
    }
    const std::vector<std::string> bodies = mjcfBodies(a_, o_);
    for (const MuscleLine& line : !o_.muscles ? std::vector<MuscleLine>()
                                  : bones     ? makeMuscles(a_, *bones)
                                              : makeMuscles(a_)) {
      const auto missing = [&](const MusclePoint& p) {
        return std::find(bodies.begin(), bodies.end(), p.body) == bodies.end();
      };
      if (std::none_of(line.points.begin(), line.points.end(), missing)) muscles_.push_back(line);
    }
    for (const Disc& disc : a_.discs) {
      if (!has(bodyOfLevel(a_, disc.lower)) || !has(bodyOfLevel(a_, disc.upper))) continue;
      levels_.push_back(disc);
      const bool fitted = bones && !o_.own;
      discs_.push_back(fitted ? fittedDiscMesh(a_, *bones, disc) : makeDiscMesh(disc.shape));
    }
  }
  if (o_.scene) Element(root_, "include").set("file", "scene.xml");
  writeOptions();
  writeDefaults();
  writeAssets();
  writeBodies();
  if (detailed()) writeSites();
  writeContacts();
  if (detailed()) writeTendons();
  if (detailed()) writeEqualities();
  writeActuators();
  writeMuscleActuators();
  if (detailed()) writeSensors();
  if (detailed()) writeCustom();
}

std::string boneMeshName(const std::string& body, Tissue tissue) {
  return tissue == Tissue::kCartilage ? body + "_cartilage" : body;
}

std::vector<std::string> mjcfBodies(const Anatomy& anatomy, const MjcfOptions& options) {
  std::vector<std::string> bodies = {"pelvis"};
  for (const Vertebra& v : anatomy.vertebrae) bodies.push_back(v.name);
  bodies.push_back("ribcage");
  bodies.push_back("head");
  for (const char* side : {"left_", "right_"}) {
    for (const char* part : {"clavicle", "scapula"}) bodies.push_back(std::string(side) + part);
    if (!options.limbs) continue;
    for (const char* part : {"upper_arm", "lower_arm", "hand", "thigh", "shin", "foot"}) {
      bodies.push_back(std::string(side) + part);
    }
  }
  const auto left_out = [&](const std::string& body) {
    return !options.only.empty() &&
           std::find(options.only.begin(), options.only.end(), body) == options.only.end();
  };
  bodies.erase(std::remove_if(bodies.begin(), bodies.end(), left_out), bodies.end());
  return bodies;
}

void writeMjcf(const Anatomy& anatomy, const MjcfOptions& options,
               tinyxml2::XMLDocument& document) {
  MjcfOptions o = options;
  Anatomy a = anatomy;
  if (o.kind != TorsoKind::kDetailed) a = withWholeShoulder(a);
  if (o.kind == TorsoKind::kSimple) a = withSimpleTrunk(a);
  if (o.height == 0) o.height = -anatomy.landmark("sole").z();
  document.InsertEndChild(document.NewComment(
      " Written by `torso build` from the anatomy tables; edit those, not this file. "));
  tinyxml2::XMLElement* root = document.NewElement("mujoco");
  document.InsertEndChild(root);
  MjcfWriter(a, o, root).write();
}

std::string mjcfText(const Anatomy& anatomy, const MjcfOptions& options) {
  tinyxml2::XMLDocument document;
  writeMjcf(anatomy, options, document);
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return printer.CStr();
}

}  // namespace torso::tools
