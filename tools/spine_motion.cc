// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/spine_motion.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "tools/mujoco_support.h"
#include "tools/posture.h"
#include "tools/smoothness.h"

namespace torso::tools {
namespace {

using Eigen::Quaterniond;

constexpr double kJitter = 10;  // [Hz]

}  // namespace

std::optional<SpineMotion> spineMotion(const mjModel* m, const Motion& motion) {
  constexpr std::array<const char*, 4> kBones = {"pelvis", "T12", "T1", "C3"};
  std::array<int, 4> bodies{};
  for (std::size_t i = 0; i < bodies.size(); i++) {
    bodies[i] = mj_name2id(m, mjOBJ_BODY, kBones[i]);
    if (bodies[i] < 0) return std::nullopt;
  }
  const DataPtr d = makeData(m);
  const auto orientations = [&] {
    mj_kinematics(m, d.get());
    std::array<Quaterniond, 4> all;
    for (std::size_t i = 0; i < all.size(); i++) {
      const mjtNum* q = d->xquat + 4 * bodies[i];
      all[i] = Quaterniond(q[0], q[1], q[2], q[3]);
    }
    return all;
  };
  const std::array<Quaterniond, 4> standing = orientations();
  SpineMotion spine;
  spine.rate = motion.rate;
  for (std::size_t frame = 0; frame < motion.frames(); frame++) {
    mju_copy(d->qpos, motion.qpos.data() + frame * m->nq, m->nq);
    std::array<Quaterniond, 4> q = orientations();
    for (std::size_t i = 0; i < q.size(); i++) q[i] = q[i] * standing[i].conjugate();
    spine.lumbar.push_back(rotationVector(q[0].conjugate() * q[1]));
    spine.thoracic.push_back(rotationVector(q[1].conjugate() * q[2]));
    spine.neck.push_back(rotationVector(q[2].conjugate() * q[3]));
  }
  return spine;
}

double neckJitter(const SpineMotion& spine) {
  if (spine.neck.size() < 4) return 0;
  std::vector<std::vector<Eigen::Vector3d>> turns;
  for (const Eigen::Vector3d& turn : spine.neck) turns.push_back({turn});
  return powerShareAbove(turns, spine.rate, kJitter);
}

std::string spineCsv(const SpineMotion& spine) {
  std::string text = "time_s,lumbar_flexion_deg,thoracic_flexion_deg,neck_flexion_deg\n";
  for (std::size_t i = 0; i < spine.neck.size(); i++) {
    text += fmt::format("{:.6f}", static_cast<double>(i) / spine.rate);
    for (const auto* part : {&spine.lumbar, &spine.thoracic, &spine.neck}) {
      text += fmt::format(",{:.3f}", (*part)[i].y() * 180 / M_PI);
    }
    text += '\n';
  }
  return text;
}

}  // namespace torso::tools
