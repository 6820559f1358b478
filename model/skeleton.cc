// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/skeleton.h"

#include <algorithm>
#include <mutex>
#include <utility>

#include "model/body.h"
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

Skeleton::Skeleton(const Anatomy& anatomy, const std::vector<std::string>& bodies, int threads,
                   const std::function<void(double)>& progress)
    : bodies_(bodies) {
  // Of a pair, one is made and mirrored. The largest first, so that none is left over at the end.
  const auto left = [](const std::string& body) {
    return splitSide(body).first == Side::kRight ? "left_" + splitSide(body).second : body;
  };
  const auto isLarge = [](const std::string& body) {
    return body == "pelvis" || body == "head" || body == "ribcage";
  };
  std::vector<std::string> made;
  for (const std::string& body : bodies) {
    if (std::find(made.begin(), made.end(), left(body)) == made.end()) made.push_back(left(body));
  }
  std::stable_partition(made.begin(), made.end(), isLarge);
  std::map<std::string, std::vector<BonePart>> parts;
  std::mutex mutex;
  int done = 0;
  const int n = static_cast<int>(made.size());
  forEach(n, threads, [&](int i) {
    std::vector<BonePart> bones = boneMesh(anatomy, made[i]);
    const std::lock_guard<std::mutex> lock(mutex);
    parts[made[i]] = std::move(bones);
    done++;
    if (progress) progress(done / double(n));
  });
  for (const std::string& body : bodies) {
    std::vector<BonePart> bones = parts.at(left(body));
    if (left(body) != body) {
      for (BonePart& part : bones) part.mesh = mirrored(part.mesh);
    }
    add(body, std::move(bones));
  }
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

Skeleton scaled(const Skeleton& skeleton, double length) {
  std::map<std::string, std::vector<BonePart>> parts;
  for (const std::string& body : skeleton.bodies()) {
    std::vector<BonePart> bones = skeleton.parts(body);
    for (BonePart& part : bones) {
      for (Eigen::Vector3d& v : part.mesh.vertices) v *= length;
    }
    parts.emplace(body, std::move(bones));
  }
  return Skeleton(std::move(parts));
}

}  // namespace torso
