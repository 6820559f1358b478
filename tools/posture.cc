// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/posture.h"

#include "plugin/mujoco_torso.h"
#include "tools/mujoco_support.h"

namespace torso::tools {

using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

Quaterniond rotation(const mjData* d, int body) {
  const mjtNum* q = d->xquat + 4 * body;
  return {q[0], q[1], q[2], q[3]};
}

}  // namespace

Posture::Posture(const mjModel* m) {
  const DataPtr d = makeData(m);
  mj_kinematics(m, d.get());
  const auto add = [&](const std::string& name, int lower, int upper) {
    names_.push_back(name);
    pairs_.push_back(
        {lower,
         upper,
         {rotation(d.get(), lower).conjugate(), rotation(d.get(), upper).conjugate()}});
  };
  levels_ = torsoOf(m, "model").ndisc;
  for (int i = 0; i < levels_; i++) {
    int bodies[2];
    torso_discBodies(m, i, bodies);
    add(torso_discName(m, i), bodies[0], bodies[1]);
  }
  const int ribcage = mj_name2id(m, mjOBJ_BODY, "ribcage");
  for (const std::string side : {"left", "right"}) {
    const int scapula = mj_name2id(m, mjOBJ_BODY, (side + "_scapula").c_str());
    if (ribcage >= 0 && scapula >= 0) add(side + "_scapula", ribcage, scapula);
  }
}

std::vector<Quaterniond> Posture::turns(const mjData* d) const {
  std::vector<Quaterniond> result;
  for (const Pair& pair : pairs_) {
    const Quaterniond lower = rotation(d, pair.lower) * pair.axes[0];
    const Quaterniond upper = rotation(d, pair.upper) * pair.axes[1];
    result.push_back((lower.conjugate() * upper).normalized());
  }
  return result;
}

Vector3d rotationVector(const Quaterniond& turn) {
  const Eigen::AngleAxisd a(turn);
  double angle = a.angle();
  if (angle > EIGEN_PI) angle -= 2 * EIGEN_PI;
  return angle * a.axis();
}

}  // namespace torso::tools
