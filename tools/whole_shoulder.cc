// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/whole_shoulder.h"

#include <algorithm>
#include <stdexcept>

namespace torso::tools {
namespace {

constexpr char kJoint[] = "glenohumeral";
constexpr char kRows[] = "shoulder";
constexpr double kScapulaShare = 1.0 / 3;  // of the elevation of the arm

}  // namespace

Anatomy withWholeShoulder(const Anatomy& anatomy) {
  Anatomy a = anatomy;
  const auto joint = std::find_if(a.joints.begin(), a.joints.end(),
                                  [](const BallJoint& j) { return j.name == kJoint; });
  if (joint == a.joints.end()) throw std::runtime_error("anatomy: no glenohumeral joint");
  joint->limit = 0;
  for (Servo& servo : a.servos) {
    if (servo.joint != kJoint) continue;
    const auto row =
        std::find_if(anatomy.servos.begin(), anatomy.servos.end(),
                     [&](const Servo& s) { return s.joint == kRows && s.motion == servo.motion; });
    if (row == anatomy.servos.end()) {
      throw std::runtime_error("anatomy: servos.csv has no row shoulder," + servo.motion);
    }
    servo = *row;
    servo.joint = kJoint;
    joint->limit = std::max({joint->limit, servo.max, -servo.min});
  }
  joint->slack += kScapulaShare * joint->limit;
  return a;
}

}  // namespace torso::tools
