// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/skeleton.h"

#include <mutex>

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
  std::mutex mutex;
  forEach(static_cast<int>(bodies.size()), threads, [&](int i) {
    std::vector<BonePart> parts = boneMesh(anatomy, bodies[i]);
    TriMesh bone, whole;
    for (const BonePart& part : parts) {
      if (part.tissue == Tissue::kBone) append(bone, part.mesh);
      append(whole, part.mesh);
    }
    MeshTree tree(std::move(bone));
    const std::lock_guard<std::mutex> lock(mutex);
    bones_.emplace(bodies[i], std::move(tree));
    if (parts.size() > 1) wholes_.emplace(bodies[i], MeshTree(std::move(whole)));
    parts_.emplace(bodies[i], std::move(parts));
  });
}

const MeshTree& Skeleton::whole(const std::string& body) const {
  const auto it = wholes_.find(body);
  return it == wholes_.end() ? bones_.at(body) : it->second;
}

}  // namespace torso
