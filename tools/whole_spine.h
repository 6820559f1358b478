// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The whole spine with head and rib cage on the bench: pelvis clamped, no gravity, no servos,
// turned by couples on its bones and pressed by a follower load, step by step to rest.

#include <Eigen/Geometry>
#include <functional>
#include <string>
#include <vector>

#include "model/anatomy.h"
#include "model/skeleton.h"
#include "tools/mujoco_support.h"

namespace torso::tools {

// What is left in; discs that are not have a thousandth of their stiffness.
struct SpineParts {
  bool ligaments = true, facets = true, discs = true, ribcage = true;
  int levels = 0;  // only the lowest so many, without the rib cage; 0: all
};

// What a level carries.
struct LevelLoad {
  // Axes of the standing body: x to the right, y forward, z to the left [Nm].
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  double follower = 0;  // compression along the disc's axis [N], see WholeSpine::load
};
using SpineLoad = std::vector<LevelLoad>;  // L5/S1 .. C2/C3; those of levels left out are unused

struct SpinePose {
  // Rotation vector of each level's upper bone against its lower one, since the pose of `stand`,
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

  // From the standing pose to rest under a load, where `load` starts. The path of the follower load
  // lies so far in front of or behind the discs' centres that compression alone turns no level
  // (Patwardhan et al. 1999, Spine 24:1003-1009). Throws Error if MuJoCo warns, as does `load`.
  void stand(const SpineLoad& load);

  // From there in `steps` equal steps to `end`, each held until the spine is at rest. The poses of
  // all steps. The same whatever was loaded before.
  std::vector<SpinePose> load(const SpineLoad& end, int steps);
  // The same, pose by pose with the share of the load, until `visit` returns false.
  void load(const SpineLoad& end, int steps,
            const std::function<bool(const SpinePose&, double)>& visit);

 private:
  struct Level {
    int lower_site, upper_site, lower_body, upper_body;
    double path;            // of the follower load in front of the disc's centre [m]
    Eigen::Matrix3d start;  // rotation of the upper site in the lower one's frame
  };
  Eigen::Matrix3d relative(const Level& level) const;
  void apply(const SpineLoad& end, double share);
  void settle(const SpineLoad& end, double share);
  SpinePose pose() const;

  ModelPtr m_;
  DataPtr d_, start_;
  SpineLoad start_load_;
  std::vector<Level> levels_;
};

}  // namespace torso::tools
