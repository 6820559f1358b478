// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/bone_mesh.h"

#include <map>
#include <stdexcept>

#include "model/bone_parts.h"

namespace torso {

void appendPair(TriMesh& mesh, const TriMesh& left) {
  append(mesh, left);
  append(mesh, mirrored(left));
}

std::vector<BonePart> boneMesh(const Anatomy& anatomy, const std::string& body) {
  if (body == "pelvis") return pelvisMesh(anatomy);
  if (body == "ribcage") return ribCageMesh(anatomy);
  if (body == "head") return {{Tissue::kBone, headMesh(anatomy)}};
  for (const Vertebra& v : anatomy.vertebrae) {
    if (body == v.name) return {{Tissue::kBone, vertebraMesh(anatomy, v.name)}};
  }
  static const std::map<std::string, TriMesh (*)(const Anatomy&)> kLimbs = {
      {"clavicle", clavicleMesh}, {"scapula", scapulaMesh}, {"upper_arm", humerusMesh},
      {"lower_arm", forearmMesh}, {"hand", handMesh},       {"thigh", femurMesh},
      {"shin", shinMesh},         {"foot", footMesh}};
  for (const std::string side : {"left_", "right_"}) {
    if (body.rfind(side, 0) != 0) continue;
    const auto limb = kLimbs.find(body.substr(side.size()));
    if (limb == kLimbs.end()) break;
    const TriMesh left = limb->second(anatomy);
    return {{Tissue::kBone, side == "left_" ? left : mirrored(left)}};
  }
  throw std::invalid_argument("no body of the torso is called '" + body + "'");
}

}  // namespace torso
