// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// How far neighbouring vertebral bodies are from each other, as Lee et al. 2023 measure it:
// cylinder to mesh, so that the arches behind, which facets join, do not count.

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "model/anatomy.h"
#include "model/mesh_checks.h"
#include "model/skeleton.h"

namespace torso::tools {

// The upper body's lower face, taken as that of an elliptic cylinder, above the lower bone.
class DiscGap {
 public:
  // The skeleton has the bone below the disc.
  DiscGap(const Anatomy& anatomy, const Skeleton& skeleton, const Disc& disc);

  // Least distance of face and bone; below 0 they collide [m]. upper: the disc's frame on the upper
  // bone, in that on the lower one; identity at rest.
  double at(const Eigen::Isometry3d& upper) const;

 private:
  std::vector<Eigen::Vector3d> face_;  // points in the disc's frame at rest
  MeshTree lower_;
};

// Of all levels, L5/S1 first. The skeleton has the bones of the spine.
std::vector<DiscGap> discGaps(const Anatomy& anatomy, const Skeleton& skeleton);

struct GapStatistics {
  std::string disc;
  double rest, mean, deviation;  // over all poses [m]
  double collisions;             // share of the poses
};

// distances: by pose, at least one.
GapStatistics gapStatistics(const std::string& disc, double rest,
                            const std::vector<double>& distances);

}  // namespace torso::tools
