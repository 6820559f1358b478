// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The surfaces of all bodies at rest, made once and looked up by name: what measures bones and what
// fits ligaments and facets to them works on.

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "model/anatomy.h"
#include "model/bone_mesh.h"
#include "model/mesh_checks.h"

namespace torso {

// Names of all bodies, as boneMesh takes them.
std::vector<std::string> bodyNames(const Anatomy& anatomy);

// In the standing body [m].
class Skeleton {
 public:
  // Bones of these bodies, made on so many threads (at least 1), the same whatever their number.
  // `progress` is told the share that is done, 0 to 1, from any of them but one at a time. Throws
  // as boneMesh does.
  Skeleton(const Anatomy& anatomy, const std::vector<std::string>& bodies, int threads,
           const std::function<void(double)>& progress = nullptr);
  // These surfaces, whatever they are, at least one of bone for each body. Throws
  // std::invalid_argument as MeshTree does.
  explicit Skeleton(std::map<std::string, std::vector<BonePart>> parts);

  const std::vector<std::string>& bodies() const { return bodies_; }
  bool has(const std::string& body) const { return parts_.count(body) > 0; }
  // Throw std::out_of_range for a body that was not made.
  const std::vector<BonePart>& parts(const std::string& body) const { return parts_.at(body); }
  // The bone of a body, without its cartilage.
  const MeshTree& bone(const std::string& body) const { return bones_.at(body); }
  // All tissues of a body.
  const MeshTree& whole(const std::string& body) const;

 private:
  void add(const std::string& body, std::vector<BonePart> parts);

  std::vector<std::string> bodies_;
  std::map<std::string, std::vector<BonePart>> parts_;
  std::map<std::string, MeshTree> bones_;
  std::map<std::string, MeshTree> wholes_;  // only of bodies with more than bone
};

// All lengths times `length` > 0.
Skeleton scaled(const Skeleton& skeleton, double length);

}  // namespace torso
