// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The whole spine with head and rib cage on the bench: pelvis clamped, no gravity, no servos,
// turned by couples on its bones and pressed by a follower load, step by step to rest.

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "model/anatomy.h"
#include "model/skeleton.h"
#include "tools/mujoco_support.h"

namespace torso::tools {

// What is left in; discs that are not have a thousandth of their stiffness.
struct SpineParts {
  bool ligaments = true, facets = true, discs = true, ribcage = true;
};

// What a level carries.
struct LevelLoad {
  // Axes of the standing body: x to the right, y forward, z to the left [Nm].
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  double follower = 0;  // compression along the disc's axis through its centre [N]
};
using SpineLoad = std::vector<LevelLoad>;  // L5/S1 .. C2/C3

struct SpinePose {
  // Rotation vector of each level's upper bone against its lower one, since the pose at the start,
  // in the disc's frame: x to the right, y forward, z to the left [rad]; L5/S1 .. C2/C3.
  std::vector<Eigen::Vector3d> levels;
  // Frame of the disc on each level's upper bone, in its frame on the lower one; both are one in
  // the standing pose.
  std::vector<Eigen::Isometry3d> placement;
};

class WholeSpine {
 public:
  // The skeleton has the bones of the spine. Throws Error.
  WholeSpine(const Anatomy& anatomy, const Skeleton& skeleton, const SpineParts& parts = {});

  // From the standing pose to rest under `start`, then in `steps` equal steps to `end`, each held
  // until the spine is at rest. The poses of all steps. Throws Error if MuJoCo warns.
  std::vector<SpinePose> load(const SpineLoad& start, const SpineLoad& end, int steps);

 private:
  struct Level {
    int lower_site, upper_site, lower_body, upper_body;
    Eigen::Matrix3d start;  // rotation of the upper site in the lower one's frame
  };
  Eigen::Matrix3d relative(const Level& level) const;
  void apply(const SpineLoad& start, const SpineLoad& end, double share);
  void settle(const SpineLoad& start, const SpineLoad& end, double share);
  SpinePose pose() const;

  ModelPtr m_;
  DataPtr d_;
  std::vector<Level> levels_;
};

}  // namespace torso::tools
