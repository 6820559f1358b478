// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/retrofit_truth.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "tools/error.h"

namespace torso::tools {
namespace {

// A group of servos that is led to a share of its range: positive of the upper limit, negative of
// the lower one. Patterns are the start and the end of a servo's name.
struct Lead {
  std::string begin, end;
  double share;
  double from = 0.3, to = 1.4;  // [s] the movement there; it comes back in the same time
};

struct Motion {
  std::string name;
  std::vector<Lead> leads;
  double pelvis_pitch[2] = {0, 0};  // at rest and at the end of the movement [deg], back is down
  double seconds = 3.4, back = 1.8;
};

// Shares of the ranges of servos.csv, which are those of living people, level by level. The
// shoulder girdle's take it through what Ludewig et al. 2009, J Bone Joint Surg Am 91:378-389, saw
// in raising an arm: clavicle retracts, rises and rolls back, scapula turns up and tilts back.
const std::vector<Motion>& motions() {
  static const std::vector<Motion> all = {
      {"flexion",
       {{"L", "_flexion", 0.8},
        {"T", "_flexion", 0.5},
        {"C", "_flexion", 0.4},
        {"head", "_flexion", 0.3}}},
      {"extension",
       {{"L", "_flexion", -0.8},
        {"T", "_flexion", -0.4},
        {"C", "_flexion", -0.5},
        {"head", "_flexion", -0.3}}},
      {"side bend",
       {{"L", "_lateral_bending", 0.8},
        {"T", "_lateral_bending", 0.5},
        {"C", "_lateral_bending", 0.4}}},
      {"twist",
       {{"L", "_axial_rotation", 0.8},
        {"T", "_axial_rotation", 0.6},
        {"C", "_axial_rotation", 0.6},
        {"head", "_axial_rotation", 0.6}}},
      {"bend and twist",
       {{"L", "_flexion", 0.6},
        {"T", "_flexion", 0.3},
        {"L", "_axial_rotation", -0.6},
        {"T", "_axial_rotation", -0.6},
        {"L", "_lateral_bending", -0.4},
        {"T", "_lateral_bending", -0.4, 0.5, 1.5},
        {"C", "_axial_rotation", 0.5, 0.5, 1.5},
        {"head", "_axial_rotation", 0.5, 0.5, 1.5}}},
      {"reach up",
       {{"left_glenohumeral", "_flexion", 0.85},
        {"left_elbow", "_flexion", 0.1},
        {"left_sternoclavicular", "_elevation", 0.2},
        {"left_sternoclavicular", "_protraction", -0.4},
        {"left_sternoclavicular", "_posterior_rotation", 0.9},
        {"left_acromioclavicular", "_upward_rotation", 0.5},
        {"left_acromioclavicular", "_posterior_tilt", 0.6},
        {"L", "_lateral_bending", -0.3},
        {"T", "_lateral_bending", -0.3},
        {"C", "_flexion", -0.3},
        {"head", "_flexion", -0.4}}},
      {"reach forward",
       {{"left_glenohumeral", "_flexion", 0.7},
        {"right_glenohumeral", "_flexion", 0.7},
        {"left_sternoclavicular", "_protraction", 0.5},
        {"right_sternoclavicular", "_protraction", 0.5},
        {"left_acromioclavicular", "_internal_rotation", 0.4},
        {"right_acromioclavicular", "_internal_rotation", 0.4},
        {"left_sternoclavicular", "_posterior_rotation", 0.5},
        {"right_sternoclavicular", "_posterior_rotation", 0.5},
        {"left_acromioclavicular", "_upward_rotation", 0.3},
        {"right_acromioclavicular", "_upward_rotation", 0.3},
        {"left_acromioclavicular", "_posterior_tilt", 0.25},
        {"right_acromioclavicular", "_posterior_tilt", 0.25},
        {"L", "_flexion", 0.5},
        {"T", "_flexion", 0.4},
        {"L", "_axial_rotation", 0.3}}},
      {"sit-up",
       {{"L", "_flexion", 0.8, 0.3, 1.4},
        {"T", "_flexion", 0.6, 0.3, 1.2},
        {"C", "_flexion", 0.7, 0.2, 0.8},
        {"head", "_flexion", 0.4, 0.2, 0.8},
        {"left_hip", "_flexion", 0.4},
        {"right_hip", "_flexion", 0.4},
        {"left_knee", "_flexion", 0.5},
        {"right_knee", "_flexion", 0.5},
        {"left_glenohumeral", "_flexion", 0.5},
        {"right_glenohumeral", "_flexion", 0.5},
        {"left_sternoclavicular", "_posterior_rotation", 0.35},
        {"right_sternoclavicular", "_posterior_rotation", 0.35},
        {"left_acromioclavicular", "_upward_rotation", 0.2},
        {"right_acromioclavicular", "_upward_rotation", 0.2},
        {"left_acromioclavicular", "_posterior_tilt", 0.2},
        {"right_acromioclavicular", "_posterior_tilt", 0.2}},
       {-90, -60}},
      {"wave",
       {{"L", "_flexion", 0.6, 0.2, 1.0},
        {"T", "_flexion", -0.4, 0.5, 1.3},
        {"C", "_flexion", 0.5, 0.8, 1.6},
        {"head", "_flexion", 0.4, 0.8, 1.6},
        {"L", "_lateral_bending", 0.4, 0.6, 1.4},
        {"T", "_lateral_bending", -0.4, 0.4, 1.2}}},
  };
  return all;
}

// 0 to 1 with no jump of velocity and acceleration (minimum jerk).
double rise(double time, double from, double to) {
  const double s = std::clamp((time - from) / (to - from), 0.0, 1.0);
  return s * s * s * (10 + s * (6 * s - 15));
}

double course(double time, double from, double to, double back) {
  return rise(time, from, to) - rise(time, back + from - 0.3, back + to - 0.3);
}

bool matches(const std::string& name, const Lead& lead) {
  return name.rfind(lead.begin, 0) == 0 && name.size() > lead.end.size() &&
         name.compare(name.size() - lead.end.size(), lead.end.size(), lead.end) == 0;
}

void drive(const mjModel* m, mjData* d, const Motion& motion) {
  mju_zero(d->ctrl, m->nu);
  for (const Lead& lead : motion.leads) {
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

std::vector<std::string> truthMotions() {
  std::vector<std::string> names;
  for (const Motion& motion : motions()) names.push_back(motion.name);
  return names;
}

Truth makeTruth(const BodyMjcf& body, const std::string& name, double rate) {
  const auto motion = std::find_if(motions().begin(), motions().end(),
                                   [&](const Motion& one) { return one.name == name; });
  if (motion == motions().end()) {
    throw Error(fmt::format("no motion is called '{}'; there are: {}", name,
                            fmt::join(truthMotions(), ", ")));
  }
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
  turnAll(m.get(), d.get(), motion->pelvis_pitch[0] * mjPI / 180);
  constexpr double kSettle = 0.5;  // [s] before the first frame, to let the body sag
  const int frames = static_cast<int>(std::floor(motion->seconds * rate)) + 1;
  for (int frame = 0; frame < frames; frame++) {
    const double start = frame / rate;
    while (d->time < kSettle + start) {
      const double time = d->time;
      d->time = std::max(0.0, time - kSettle);
      drive(m.get(), d.get(), *motion);
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
