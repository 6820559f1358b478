// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/bone_mesh.h"

#include <map>
#include <stdexcept>

#include "model/body_warp.h"
#include "model/bone_parts.h"

namespace torso {

void appendPair(TriMesh& mesh, const TriMesh& left) {
  append(mesh, left);
  append(mesh, mirrored(left));
}

namespace {

using LimbMaker = TriMesh (*)(const Anatomy&);

// Of "left_hand", "right_hand", ...; null if the name is no limb's.
LimbMaker limbMaker(const std::string& body) {
  static const std::map<std::string, LimbMaker> kMakers = {
      {"clavicle", clavicleMesh}, {"scapula", scapulaMesh}, {"upper_arm", humerusMesh},
      {"lower_arm", forearmMesh}, {"hand", handMesh},       {"thigh", femurMesh},
      {"shin", shinMesh},         {"foot", footMesh}};
  const std::size_t end = body.find('_');
  const std::string side = body.substr(0, end);
  if (end == std::string::npos || (side != "left" && side != "right")) return nullptr;
  const auto it = kMakers.find(body.substr(end + 1));
  return it == kMakers.end() ? nullptr : it->second;
}

bool isFreeVertebra(const Anatomy& anatomy, const std::string& body) {
  for (const Vertebra& v : anatomy.vertebrae) {
    if (v.name == body) return true;
  }
  return false;
}

// At the size and shape of the tables, for which the generators are made.
std::vector<BonePart> tableMesh(const Anatomy& anatomy, const std::string& body) {
  if (body == "pelvis") return pelvisMesh(anatomy);
  if (body == "ribcage") return ribCageMesh(anatomy);
  if (body == "head") return {{Tissue::kBone, headMesh(anatomy)}};
  if (isFreeVertebra(anatomy, body)) return {{Tissue::kBone, vertebraMesh(anatomy, body)}};
  if (const LimbMaker maker = limbMaker(body)) {
    const TriMesh left = maker(anatomy);
    return {{Tissue::kBone, body[0] == 'l' ? left : mirrored(left)}};
  }
  throw std::invalid_argument("no body of the torso is called '" + body + "'");
}

}  // namespace

std::vector<Tissue> boneTissues(const Anatomy& anatomy, const std::string& body) {
  if (body == "pelvis" || body == "ribcage") return {Tissue::kBone, Tissue::kCartilage};
  if (body == "head" || isFreeVertebra(anatomy, body) || limbMaker(body) != nullptr) {
    return {Tissue::kBone};
  }
  throw std::invalid_argument("no body of the torso is called '" + body + "'");
}

std::vector<BonePart> carriedMesh(const Anatomy& person, const std::string& body,
                                  std::vector<BonePart> parts) {
  // Vertebrae are described by a person's tables in full.
  const bool warped = person.warp && !isFreeVertebra(person, body);
  for (BonePart& part : parts) {
    for (Eigen::Vector3d& p : part.mesh.vertices) {
      if (warped) p = (*person.warp)(body, p);
      p *= person.length_scale;
    }
  }
  return parts;
}

std::vector<BonePart> boneMesh(const Anatomy& anatomy, const std::string& body) {
  const bool warped = anatomy.warp && !isFreeVertebra(anatomy, body);
  if (anatomy.length_scale == 1 && !warped) return tableMesh(anatomy, body);
  const Anatomy table_size =
      warped ? anatomy.warp->tables() : anatomy.scaled(1 / anatomy.length_scale, 1);
  return carriedMesh(anatomy, body, tableMesh(table_size, body));
}

}  // namespace torso
