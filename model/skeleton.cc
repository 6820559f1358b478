// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/skeleton.h"

#include <utility>

#include "model/parallel.h"

namespace torso {

std::vector<std::string> bodyNames(const Anatomy& anatomy) {
  std::vector<std::string> names = {"ribcage", "pelvis", "head"};  // the slowest first
  for (const std::string side : {"left_", "right_"}) {
    for (const char* limb :
         {"hand", "foot", "scapula", "lower_arm", "shin", "thigh", "upper_arm", "clavicle"}) {
      names.push_back(side + limb);
    }
  }
  for (const Vertebra& v : anatomy.vertebrae) names.push_back(v.name);
  return names;
}

Skeleton::Skeleton(const Anatomy& anatomy, const std::vector<std::string>& bodies, int threads)
    : bodies_(bodies) {
  std::vector<std::vector<BonePart>> parts(bodies.size());
  forEach(static_cast<int>(bodies.size()), threads,
          [&](int i) { parts[i] = boneMesh(anatomy, bodies[i]); });
  for (std::size_t i = 0; i < bodies.size(); i++) add(bodies[i], std::move(parts[i]));
}

Skeleton::Skeleton(std::map<std::string, std::vector<BonePart>> parts) {
  for (auto& [body, surfaces] : parts) {
    bodies_.push_back(body);
    add(body, std::move(surfaces));
  }
}

void Skeleton::add(const std::string& body, std::vector<BonePart> parts) {
  TriMesh bone, whole;
  for (const BonePart& part : parts) {
    if (part.tissue == Tissue::kBone) append(bone, part.mesh);
    append(whole, part.mesh);
  }
  bones_.emplace(body, MeshTree(std::move(bone)));
  if (parts.size() > 1) wholes_.emplace(body, MeshTree(std::move(whole)));
  parts_.emplace(body, std::move(parts));
}

const MeshTree& Skeleton::whole(const std::string& body) const {
  const auto it = wholes_.find(body);
  return it == wholes_.end() ? bones_.at(body) : it->second;
}

}  // namespace torso
