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
      load_(m, human),
      momentum_(momentum),
      change_(m->nv) {
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
  rest();
}

void Equilibrium::hold(const std::vector<Isometry3d>& poses, const Vector3d& up) {
  const Isometry3d pelvis = bodyPose(d_.get(), pelvis_);
  up_ = pelvis.linear() * up;
  for (std::size_t i = 0; i < poses.size(); i++) {
    const Isometry3d X = pelvis * poses[i];
    const Quaterniond q(X.linear());
    mju_copy3(d_->mocap_pos + 3 * mocap_[i], X.translation().data());
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
  rhythm_.apply(m_, d);
  load_.apply(m_, d, up_);
  mj_step(m_, d);
  mju_addTo(change_.data(), d->qvel, m_->nv);
  double largest = 0;
  for (int j = 0; j < m_->njnt; j++) {
    const int rotation = m_->jnt_dofadr[j] + (m_->jnt_type[j] == mjJNT_FREE ? 3 : 0);
    largest = std::max(largest, h * mju_norm3(d->qvel + rotation));
  }
  return largest;
}

void Equilibrium::forward() {
  mju_zero(d_->qvel, m_->nv);
  mj_forward(m_, d_.get());
}

Isometry3d Equilibrium::pose(int body) const {
  return bodyPose(d_.get(), pelvis_).inverse() * bodyPose(d_.get(), body);
}

}  // namespace torso::tools
