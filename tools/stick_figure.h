// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "model/anatomy.h"
#include "tools/clip.h"
#include "tools/stick.h"

namespace torso::tools {

// The skeleton of a motion capture clip, to be drawn beside the body that `torso retrofit` made of
// it.
class StickFigure {
 public:
  // path: of the clip; name: of the files that retrofit wrote for the person, without ending; not
  // needed if there is but one person in the clip. Throws Error, one that lists the persons.
  StickFigure(const Anatomy& tables, const std::string& path, const std::string& name);

  // From hips to all joints below and above, at a time [s] that is brought into the clip's as
  // motionAt does; in the world of the retrofitted motion, shifted [m].
  std::vector<Stick> at(double time, const Eigen::Vector3d& shift) const;

 private:
  Clip world_;
  std::vector<int> joints_;  // those with a stick to their parent
};

}  // namespace torso::tools
