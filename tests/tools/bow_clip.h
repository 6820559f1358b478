// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "tests/tools/clip_texts.h"

namespace torso::tools {

// BVH of a bow of our own body at 20 Hz, at the end 25 degrees at each of the trunk's two joints.
inline std::string bowClip(size_t frames) {
  const Anatomy tables = Anatomy::load(TORSO_ANATOMY_DIR);
  const std::vector<TestJoint> joints = testPerson(tables);
  BvhStyle style;
  style.rate = 20;
  return bvhText(
      joints, frames,
      [&](size_t joint, size_t frame) -> Eigen::Matrix3d {
        const bool trunk = joints[joint].name == "spine" || joints[joint].name == "chest";
        const double share = 0.5 - 0.5 * std::cos(M_PI * static_cast<double>(frame) /
                                                  static_cast<double>(frames - 1));
        return turnAbout(Eigen::Vector3d::UnitY(), trunk ? 25 * share : 0);
      },
      [](size_t) { return Eigen::Vector3d(0, 0, 1); }, style);
}

}  // namespace torso::tools
