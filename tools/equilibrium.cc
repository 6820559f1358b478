// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/equilibrium.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "tools/graft_xml.h"

namespace torso::tools {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

Isometry3d bodyPose(const mjData* d, int body) {
  const mjtNum *p = d->xpos + 3 * body, *q = d->xquat + 4 * body;
  return isometry(Quaterniond(q[0], q[1], q[2], q[3]), Vector3d(p[0], p[1], p[2]));
}

}  // namespace

Equilibrium::Equilibrium(const mjModel* m, const mjModel* human, double momentum)
    : m_(m),
      d_(makeData(m)),
      rhythm_(m, human),
      spine_(m),
      load_(m, human),
      lead_(m),
      momentum_(momentum),
      change_(m->nv),
      descent_(m->nv),
      start_(m->nq) {
  pelvis_ = mj_name2id(m, mjOBJ_BODY, "pelvis");
  for (const std::string bone : kHeldBones) {
    held_.push_back(mj_name2id(m, mjOBJ_BODY, bone.c_str()));
    mocap_.push_back(m->body_mocapid[mj_name2id(m, mjOBJ_BODY, ("hold:" + bone).c_str())]);
  }
  reset();
  for (int body : held_) rest_poses_.push_back(pose(body));
}

void Equilibrium::reset() {
  mj_resetData(m_, d_.get());
  mj_forward(m_, d_.get());
  std::fill(change_.begin(), change_.end(), 0);
  std::fill(descent_.begin(), descent_.end(), 0);
  share_ = 1;
}

std::vector<mjtNum> Equilibrium::state() const {
  std::vector<mjtNum> state(d_->qpos, d_->qpos + m_->nq);
  state.insert(state.end(), d_->userdata, d_->userdata + m_->nuserdata);
  return state;
}

void Equilibrium::setState(const std::vector<mjtNum>& state) {
  reset();
  mju_copy(d_->qpos, state.data(), m_->nq);
  mju_copy(d_->userdata, state.data() + m_->nq, m_->nuserdata);
  mj_forward(m_, d_.get());
}

void Equilibrium::hold(const std::vector<Isometry3d>& poses, const Vector3d& up) {
  const Isometry3d pelvis = bodyPose(d_.get(), pelvis_);
  up_ = pelvis.linear() * up;
  for (std::size_t i = 0; i < poses.size(); i++) {
    const Isometry3d bone = bodyPose(d_.get(), held_[i]), goal = pelvis * poses[i];
    const Vector3d way = goal.translation() - bone.translation();
    const Quaterniond turned(bone.linear());
    const double angle = turned.angularDistance(Quaterniond(goal.linear()));
    const Vector3d x = bone.translation() + way * std::min(1.0, kHoldReach / (way.norm() + 1e-9));
    const Quaterniond q =
        turned.slerp(std::min(1.0, kHoldTurn / (angle + 1e-9)), Quaterniond(goal.linear()));
    mju_copy3(d_->mocap_pos + 3 * mocap_[i], x.data());
    mjtNum* quat = d_->mocap_quat + 4 * mocap_[i];
    quat[0] = q.w();
    quat[1] = q.x();
    quat[2] = q.y();
    quat[3] = q.z();
  }
}

double Equilibrium::step() {
  mjData* d = d_.get();
  const double h = m_->opt.timestep;
  mju_scl(change_.data(), change_.data(), momentum_, m_->nv);
  mj_integratePos(m_, d->qpos, change_.data(), h);
  mju_zero(d->qvel, m_->nv);
  mju_copy(start_.data(), d->qpos, m_->nq);
  rhythm_.apply(m_, d);
  spine_.apply(d);
  if (lead_goal_.cols() > 0) lead_.apply(m_, d, lead_goal_);
  load_.apply(m_, d, up_);
  mj_step(m_, d);

  double turn = 0, along = 0;  // largest turn; product with the last step's
  for (int j = 0; j < m_->njnt; j++) {
    const int dof = m_->jnt_dofadr[j] + (m_->jnt_type[j] == mjJNT_FREE ? 3 : 0);
    turn = std::max(turn, h * mju_norm3(d->qvel + dof));
    along += mju_dot3(d->qvel + dof, descent_.data() + dof);
  }
  constexpr double kSteady = 1e-3, kLongest = 0.05;  // [rad]: too small to matter, too large
  if (along < 0 && turn > kSteady) {
    share_ = std::max(0.5 * share_, 0.05);
    std::fill(change_.begin(), change_.end(), 0);
  } else {
    share_ = std::min(1.1 * share_, 1.0);
  }
  mju_copy(descent_.data(), d->qvel, m_->nv);
  const double share = std::min(share_, kLongest / std::max(turn, 1e-12));
  if (share < 1) {
    mju_scl(d->qvel, d->qvel, share, m_->nv);
    mju_copy(d->qpos, start_.data(), m_->nq);
    mj_integratePos(m_, d->qpos, d->qvel, h);
  }
  mju_addTo(change_.data(), d->qvel, m_->nv);
  return turn;
}

void Equilibrium::forward() {
  mju_zero(d_->qvel, m_->nv);
  mj_forward(m_, d_.get());
}

Isometry3d Equilibrium::pose(int body) const {
  return bodyPose(d_.get(), pelvis_).inverse() * bodyPose(d_.get(), body);
}

}  // namespace torso::tools
