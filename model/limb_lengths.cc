// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/limb_lengths.h"

#include <algorithm>
#include <stdexcept>

namespace torso {

using Eigen::Vector3d;

const std::vector<std::string>& limbSegments() {
  static const std::vector<std::string> segments = {"upper_arm", "lower_arm", "hand",
                                                    "thigh",     "shin",      "foot"};
  return segments;
}

Anatomy withLimbs(const Anatomy& anatomy, const std::map<std::string, double>& factors) {
  for (const auto& [name, factor] : factors) {
    const auto& known = limbSegments();
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      throw std::invalid_argument("no segment of a limb is called '" + name + "'");
    }
    if (!(factor > 0)) throw std::invalid_argument(name + ": a factor must be positive");
  }
  Anatomy a = anatomy;
  for (const std::string& name : limbSegments()) {
    const auto found = factors.find(name);
    const double factor = found == factors.end() ? 1 : found->second;
    const auto joint = std::find_if(anatomy.joints.begin(), anatomy.joints.end(),
                                    [&](const BallJoint& j) { return j.child == name; });
    // The joint may already have moved with the segments before.
    const Vector3d from = anatomy.landmark(joint->landmark), to = a.landmark(joint->landmark);
    const auto moved = [&](const Vector3d& p) { return Vector3d(to + factor * (p - from)); };
    for (auto& [landmark, position] : a.landmarks) {
      if (anatomy.landmark_carriers.at(landmark) == name) {
        position = moved(anatomy.landmark(landmark));
      }
    }
    for (Segment& segment : a.segments) {
      if (segment.name != name) continue;
      segment.com = moved(segment.com);
      segment.gyration *= factor;
      segment.mass *= factor * factor * factor;
    }
  }
  for (BallJoint& joint : a.joints) joint.position = a.landmark(joint.landmark);
  return a;
}

}  // namespace torso
