// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/joint_lead.h"

#include <string>

#include "tools/error.h"
#include "tools/posture.h"
#include "tools/retrofit_model.h"

namespace torso::tools {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// Of the lead's springs over what leads these joints already (SpineRhythm, Rhythm): stiff enough
// that they outweigh what makes a neck snap from one posture to another, and softer than the holds.
// Assumed; with 10 in their place jumps and held errors of six takes were the same within a tenth.
constexpr double kLevels = 4, kBalls = 4;

// Of the springs of a ball joint that Rhythm leads, from the inertia that stands for it
// (retrofit_model.cc).
double stiffness(const mjModel* m, int joint) {
  return m->dof_armature[m->jnt_dofadr[joint]] / (m->opt.timestep * m->opt.timestep);
}

Quaterniond turnOf(const mjModel* m, const mjData* d, int joint) {
  const mjtNum* q = d->qpos + m->jnt_qposadr[joint];
  return {q[0], q[1], q[2], q[3]};
}

}  // namespace

JointLead::JointLead(const mjModel* m) {
  for (int i = 0; i < m->nu; i += 3) {
    const std::string servo = nameOf(m, mjOBJ_ACTUATOR, i);
    names_.push_back(servo.substr(0, servo.find('_')));
    servos_.push_back(i);
  }
  for (const char* name : {"head", "left_sternoclavicular", "left_acromioclavicular",
                           "right_sternoclavicular", "right_acromioclavicular"}) {
    names_.push_back(name);
    balls_.push_back(mj_name2id(m, mjOBJ_JOINT, name));
  }
}

bool JointLead::isOneOfTwo(const std::string& name) {
  return name == "C2/C3" || name.find('/') == std::string::npos;
}

ModelPtr JointLead::ledModel(const mjModel* torso) {
  ModelPtr m(mj_copyModel(nullptr, torso));
  if (!m) throw Error("there is not enough memory");
  for (int i = 0; i < m->nu; i++) {
    m->actuator_gainprm[mjNGAIN * i] *= 1 + kLevels;
    m->actuator_biasprm[mjNBIAS * i + 1] *= 1 + kLevels;
  }
  for (int joint : JointLead(torso).balls_) {
    for (int k = 0; k < 3; k++) m->dof_armature[m->jnt_dofadr[joint] + k] *= 1 + kBalls;
  }
  return m;
}

Eigen::Matrix3Xd JointLead::turns(const mjModel* m, mjData* d) const {
  mj_kinematics(m, d);
  mj_comPos(m, d);
  mj_transmission(m, d);
  Eigen::Matrix3Xd turns(3, names_.size());
  int column = 0;
  for (int i : servos_) turns.col(column++) = Eigen::Map<const Vector3d>(d->actuator_length + i);
  for (int joint : balls_) turns.col(column++) = rotationVector(turnOf(m, d, joint));
  return turns;
}

void JointLead::apply(const mjModel* m, mjData* d, const Eigen::Matrix3Xd& goal) const {
  int column = 0;
  for (int i : servos_) {
    Eigen::Map<Vector3d> ctrl(d->ctrl + i);
    ctrl = (ctrl + kLevels * goal.col(column++)) / (1 + kLevels);
  }
  for (int joint : balls_) {
    const Vector3d to = goal.col(column++);
    const double angle = to.norm();
    const Quaterniond towards(Eigen::AngleAxisd(angle, angle > 0 ? Vector3d(to / angle) : to));
    const double k = stiffness(m, joint) * kBalls / (1 + kBalls);
    const Vector3d moment = -k * rotationVector(towards.conjugate() * turnOf(m, d, joint));
    mju_addTo3(d->qfrc_applied + m->jnt_dofadr[joint], moment.data());
  }
}

}  // namespace torso::tools
