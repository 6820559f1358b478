// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/retrofit_truth.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "tools/error.h"
#include "tools/truth_motions.h"

namespace torso::tools {
namespace {

// 0 to 1 with no jump of velocity and acceleration (minimum jerk).
double rise(double time, double from, double to) {
  const double s = std::clamp((time - from) / (to - from), 0.0, 1.0);
  return s * s * s * (10 + s * (6 * s - 15));
}

double course(double time, double from, double to, double back) {
  return rise(time, from, to) - rise(time, back + from - 0.3, back + to - 0.3);
}

bool matches(const std::string& name, const TruthLead& lead) {
  return name.rfind(lead.begin, 0) == 0 && name.size() > lead.end.size() &&
         name.compare(name.size() - lead.end.size(), lead.end.size(), lead.end) == 0;
}

void drive(const mjModel* m, mjData* d, const TruthMotion& motion) {
  mju_zero(d->ctrl, m->nu);
  for (const TruthLead& lead : motion.leads) {
    const double share = lead.share * course(d->time, lead.from, lead.to, motion.back);
    for (int i = 0; i < m->nu; i++) {
      if (!matches(nameOf(m, mjOBJ_ACTUATOR, i), lead)) continue;
      const mjtNum* range = m->actuator_ctrlrange + 2 * i;
      d->ctrl[i] += share > 0 ? share * range[1] : -share * range[0];
    }
  }
  const double s = course(d->time, 0.3, 1.4, motion.back);
  const double pitch =
      mjPI / 180 * (motion.pelvis_pitch[0] + s * (motion.pelvis_pitch[1] - motion.pelvis_pitch[0]));
  const mjtNum axis[3] = {0, 1, 0};
  mju_axisAngle2Quat(d->mocap_quat, axis, pitch);
}

// The whole body turned about the pelvis, as at rest else.
void turnAll(const mjModel* m, mjData* d, double pitch) {
  const mjtNum axis[3] = {0, 1, 0};
  mjtNum turn[4];
  mju_axisAngle2Quat(turn, axis, pitch);
  const int pelvis = m->jnt_qposadr[mj_name2id(m, mjOBJ_JOINT, "pelvis")];
  mjtNum centre[3];
  mju_copy3(centre, d->qpos + pelvis);
  for (int j = 0; j < m->njnt; j++) {
    if (m->jnt_type[j] != mjJNT_FREE) continue;
    mjtNum *p = d->qpos + m->jnt_qposadr[j], *q = p + 3, arm[3], old[4];
    mju_sub3(arm, p, centre);
    mju_rotVecQuat(p, arm, turn);
    mju_addTo3(p, centre);
    mju_copy4(old, q);
    mju_mulQuat(q, turn, old);
  }
}

}  // namespace

Truth makeTruth(const BodyMjcf& body, const std::string& name, double rate) {
  const TruthMotion motion = truthMotion(name);
  const ModelPtr m = body.pelvisOnHold();
  const DataPtr d = makeData(m.get());
  Truth truth;
  truth.nq = m->nq;
  truth.held.name = name;
  truth.held.rate = rate;
  truth.held.bodies = {"pelvis", "head"};
  for (const std::string side : {"left_", "right_"}) {
    for (const char* limb : {"upper_arm", "lower_arm", "hand", "thigh", "shin", "foot"}) {
      truth.held.bodies.push_back(side + limb);
    }
  }
  mj_resetData(m.get(), d.get());
  turnAll(m.get(), d.get(), motion.pelvis_pitch[0] * mjPI / 180);
  constexpr double kSettle = 0.5;  // [s] before the first frame, to let the body sag
  const int frames = static_cast<int>(std::floor(motion.seconds * rate)) + 1;
  for (int frame = 0; frame < frames; frame++) {
    const double start = frame / rate;
    while (d->time < kSettle + start) {
      const double time = d->time;
      d->time = std::max(0.0, time - kSettle);
      drive(m.get(), d.get(), motion);
      d->time = time;
      mj_step(m.get(), d.get());
    }
    mj_kinematics(m.get(), d.get());
    truth.qpos.insert(truth.qpos.end(), d->qpos, d->qpos + m->nq);
    for (const std::string& held : truth.held.bodies) {
      const int id = mj_name2id(m.get(), mjOBJ_BODY, held.c_str());
      const mjtNum *p = d->xpos + 3 * id, *q = d->xquat + 4 * id;
      truth.held.positions.push_back({p[0], p[1], p[2]});
      truth.held.quaternions.push_back({q[0], q[1], q[2], q[3]});
    }
  }
  const std::string warning = firstWarning(d.get());
  if (!warning.empty()) throw Error(fmt::format("truth '{}': {}", name, warning));
  return truth;
}

}  // namespace torso::tools
