// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/rhythm.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "tools/posture.h"
#include "tools/retrofit_model.h"

namespace torso::tools {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

constexpr double kDegree = EIGEN_PI / 180;

// Scapula on the rib cage per angle of raising the arm beyond 30 deg: upward rotation as Inman,
// Saunders and Abbott 1944, J Bone Joint Surg 26:1-30 (one part of three); posterior tilt and
// external rotation as McClure et al. 2001, J Shoulder Elbow Surg 10:269-277, who saw 30 and 24 deg
// of them with 50 deg of upward rotation.
constexpr double kUpward = 1.0 / 3, kTilt = kUpward * 30 / 50, kExternal = kUpward * 24 / 50;
constexpr double kScapulaOnset = 30 * kDegree;
// Internal rotation of the scapula's plane at rest, which the axes of the three go with: Ludewig et
// al. 2009, J Bone Joint Surg Am 91:378-389.
constexpr double kScapularPlane = 41 * kDegree;
// Clavicle on the rib cage per angle beyond 25 deg, the same study: elevation; retraction (between
// 0.06 in flexion and 0.18 in abduction); posterior rotation (31 deg at 120 deg).
constexpr double kElevation = 0.05, kRetraction = 0.12, kPosterior = 31.0 / 95;
constexpr double kClavicleOnset = 25 * kDegree;

// As a corner at x = 0, rounded over some degrees so that no motion is jerked by it.
double ramp(double x) {
  constexpr double kRound = 10 * kDegree;
  return 0.5 * (x + std::sqrt(x * x + kRound * kRound));
}

Quaterniond turnBy(const Vector3d& vector) {
  const double angle = vector.norm();
  return angle < 1e-12 ? Quaterniond::Identity() : Quaterniond(AngleAxisd(angle, vector / angle));
}

Quaterniond rotation(const mjData* d, int body) {
  const mjtNum* q = d->xquat + 4 * body;
  return {q[0], q[1], q[2], q[3]};
}

// Half the range of a servo [rad]; 0 if there is none.
double servoRange(const mjModel* m, const std::string& name) {
  const int id = mj_name2id(m, mjOBJ_ACTUATOR, name.c_str());
  if (id < 0) return 0;
  return 0.5 * (m->actuator_ctrlrange[2 * id + 1] - m->actuator_ctrlrange[2 * id]);
}

// Moment of a spring about a turn of a ball joint from its rest.
void spring(const mjModel* m, mjData* d, int joint, double stiffness, const Quaterniond& towards) {
  const mjtNum* q = d->qpos + m->jnt_qposadr[joint];
  const Quaterniond now(q[0], q[1], q[2], q[3]);
  const Vector3d moment = -stiffness * rotationVector(towards.conjugate() * now);
  mju_copy3(d->qfrc_applied + m->jnt_dofadr[joint], moment.data());
}

}  // namespace

GirdleTurns girdleRhythm(double raised, double side) {
  const auto mirrored = [side](const Vector3d& v) {
    return Vector3d(side * v.x(), v.y(), side * v.z());
  };
  const double clavicle = ramp(raised - kClavicleOnset) - ramp(-kClavicleOnset);
  const double scapula = ramp(raised - kScapulaOnset) - ramp(-kScapulaOnset);
  const Quaterniond on_ribcage =
      turnBy(mirrored(clavicle * Vector3d(kElevation, -kPosterior, kRetraction)));
  const double c = std::cos(kScapularPlane), n = std::sin(kScapularPlane);
  const Vector3d turn =
      kUpward * Vector3d(c, -n, 0) - kTilt * Vector3d(n, c, 0) + kExternal * Vector3d::UnitZ();
  const Quaterniond scapula_on_ribcage = turnBy(mirrored(scapula * turn));
  return {on_ribcage, on_ribcage.conjugate() * scapula_on_ribcage};
}

Rhythm::Rhythm(const mjModel* torso, const mjModel* human) {
  const auto body = [&](const std::string& name) {
    return mj_name2id(torso, mjOBJ_BODY, name.c_str());
  };
  const auto joint = [&](const std::string& name) {
    return mj_name2id(torso, mjOBJ_JOINT, name.c_str());
  };
  const DataPtr d = makeData(torso);
  mj_kinematics(torso, d.get());
  ribcage_ = body("ribcage");
  head_ = body("head");
  t1_ = body("T1");
  head_joint_ = torso->body_jntadr[head_];
  head_rest_ = rotation(d.get(), head_).conjugate();
  t1_rest_ = rotation(d.get(), t1_).conjugate();
  const char* motions[] = {"_lateral_bending", "_flexion", "_axial_rotation"};
  for (int k = 0; k < 3; k++) {
    const double head = servoRange(human, std::string("head") + motions[k]);
    double neck = head;
    for (const char* disc : {"C7/T1", "C6/C7", "C5/C6", "C4/C5", "C3/C4"}) {
      neck += servoRange(human, std::string(disc) + motions[k]);
    }
    head_share_[k] = neck > 0 ? head / neck : 0;
  }
  for (int i = 0; i < 2; i++) {
    const std::string side = i == 0 ? "left_" : "right_";
    const int elbow = mj_name2id(human, mjOBJ_BODY, (side + "lower_arm").c_str());
    Vector3d shaft = -Vector3d::UnitZ();
    if (elbow >= 0) shaft = Eigen::Map<const Vector3d>(human->body_pos + 3 * elbow).normalized();
    shoulders_[i] = {i == 0 ? 1.0 : -1.0, body(side + "upper_arm"),
                     joint(side + "sternoclavicular"), joint(side + "acromioclavicular"), shaft};
  }
}

void Rhythm::apply(const mjModel* m, mjData* d) const {
  const Quaterniond head = rotation(d, head_) * head_rest_, t1 = rotation(d, t1_) * t1_rest_;
  const Vector3d neck = rotationVector(t1.conjugate() * head);
  // The head's frame has the standing axes at rest. Its share levels off towards the end of its
  // range, so that it does not run into the stop at speed: the others' shares rise smoothly.
  const Vector3d share = head_share_ * neck.array();
  const double most = m->jnt_range[2 * head_joint_ + 1];
  const double beyond = most > 0 ? std::pow(share.norm() / most, 4) : 0;
  spring(m, d, head_joint_, kRhythmStiffness.head, turnBy(share / std::pow(1 + beyond, 0.25)));

  for (const Shoulder& shoulder : shoulders_) {
    const Quaterniond ribcage = rotation(d, ribcage_);
    const Vector3d shaft = ribcage.conjugate() * (rotation(d, shoulder.humerus) * shoulder.shaft);
    const double raised = std::acos(std::clamp(-shaft.z(), -1.0, 1.0));
    const GirdleTurns turns = girdleRhythm(raised, shoulder.side);
    spring(m, d, shoulder.sternoclavicular, kRhythmStiffness.sternoclavicular,
           turns.sternoclavicular);
    spring(m, d, shoulder.acromioclavicular, kRhythmStiffness.acromioclavicular,
           turns.acromioclavicular);
  }
}

}  // namespace torso::tools
