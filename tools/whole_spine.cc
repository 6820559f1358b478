// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/whole_spine.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "model/body.h"
#include "tools/bone_files.h"
#include "tools/mujoco_eigen.h"
#include "tools/rest.h"
#include "tools/segment_bench.h"
#include "tools/torso_mjcf.h"

namespace torso::tools {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr Rest kRest = {5e-3, 3};  // [rad/s], [s]

// Equilibrium knows no masses, but the way there does: the spine with head and ribs as heavy as
// they are sways so slowly that it is degrees a region away from rest after a hold. The
// constraints' inverse inertias stay, so that ligaments and facets are as hard as before. With a
// thousandth instead, totals differ by 0.3 deg at most.
void lighten(mjModel* m) {
  constexpr double kMass = 0.01;
  mju_scl(m->body_mass, m->body_mass, kMass, m->nbody);
  mju_scl(m->body_subtreemass, m->body_subtreemass, kMass, m->nbody);
  mju_scl(m->body_inertia, m->body_inertia, kMass, 3 * m->nbody);
  mju_scl(m->dof_armature, m->dof_armature, kMass, m->nv);
}

}  // namespace

WholeSpine::WholeSpine(const Anatomy& whole, const Skeleton& skeleton, const SpineParts& parts) {
  Anatomy anatomy = whole;
  for (Disc& disc : anatomy.discs) {
    if (parts.discs) break;
    for (double* modulus : {&disc.material.annulus_modulus, &disc.material.fibre_modulus,
                            &disc.material.nucleus_modulus, &disc.material.nucleus_bulk_modulus}) {
      *modulus *= 1e-3;
    }
  }
  MjcfOptions options;
  options.anchored = "pelvis";
  options.only = spineBodies(anatomy);
  if (parts.ribcage && parts.levels == 0) options.only.push_back("ribcage");
  if (parts.levels > 0) {
    options.only = {options.anchored};
    anatomy.discs.resize(parts.levels);
    for (const Disc& disc : anatomy.discs) {
      options.only.push_back(bodyOfLevel(anatomy, disc.upper));
    }
  }
  options.bones = false;
  options.skeleton = &skeleton;
  m_ = compileModel(mjcfText(anatomy, options), "whole spine");
  mju_zero3(m_->opt.gravity);
  m_->opt.disableflags |= mjDSBL_ACTUATION;
  for (int i = 0; i < m_->ntendon && !parts.ligaments; i++) m_->tendon_limited[i] = 0;
  // A margin that no distance is below.
  for (int i = 0; i < m_->npair && !parts.facets; i++) m_->pair_margin[i] = -mjMAXVAL;
  // Without discs nothing would hold bodies so light against the jolts of their contacts.
  if (parts.discs) lighten(m_.get());
  d_ = makeData(m_.get());
  for (const Disc& disc : anatomy.discs) {
    const auto site = [&](const char* suffix) {
      return mj_name2id(m_.get(), mjOBJ_SITE, (disc.name + suffix).c_str());
    };
    const int lower = site("_lower"), upper = site("_upper");
    levels_.push_back(
        {lower, upper, m_->site_bodyid[lower], m_->site_bodyid[upper], 0, Matrix3d::Identity()});
  }
}

Matrix3d WholeSpine::relative(const Level& level) const {
  return matrix3(d_->site_xmat + 9 * level.lower_site).transpose() *
         matrix3(d_->site_xmat + 9 * level.upper_site);
}

void WholeSpine::apply(const SpineLoad& end, double share) {
  mjData* d = d_.get();
  const auto add = [&](int body, const Vector3d& force, const Vector3d& moment) {
    mju_addTo3(d->xfrc_applied + 6 * body, force.data());
    mju_addTo3(d->xfrc_applied + 6 * body + 3, moment.data());
  };
  mju_zero(d->xfrc_applied, 6 * m_->nbody);
  for (std::size_t i = 0; i < levels_.size(); i++) {
    const Level& level = levels_[i];
    const Vector3d moment = (1 - share) * start_load_[i].moment + share * end[i].moment;
    const double follower = (1 - share) * start_load_[i].follower + share * end[i].follower;
    // At one point, along the mean of the two bones' axes: a force that turns neither.
    const Vector3d point = vector3(d->site_xpos + 3 * level.upper_site) +
                           level.path * matrix3(d->site_xmat + 9 * level.upper_site).col(0);
    const Vector3d axis = matrix3(d->site_xmat + 9 * level.lower_site).col(2) +
                          matrix3(d->site_xmat + 9 * level.upper_site).col(2);
    const Vector3d force = -follower * axis.normalized();
    const auto arm = [&](int body) { return Vector3d(point - vector3(d->xipos + 3 * body)); };
    add(level.upper_body, force, moment + arm(level.upper_body).cross(force));
    add(level.lower_body, -force, -moment - arm(level.lower_body).cross(force));
  }
}

void WholeSpine::settle(const SpineLoad& end, double share) {
  stepToRest(m_.get(), d_.get(), kRest, "whole spine", [&] { apply(end, share); });
}

void WholeSpine::stand(const SpineLoad& load) {
  constexpr double kLevelTurns = 0.1 * EIGEN_PI / 180;  // [rad]
  constexpr int kLongestSearch = 10;
  mj_resetData(m_.get(), d_.get());
  mj_forward(m_.get(), d_.get());
  start_load_ = load;
  for (Level& level : levels_) {
    level.path = 0;
    level.start = relative(level);
  }
  settle(load, 0);
  for (int i = 0; i < kLongestSearch; i++) {
    const SpinePose now = pose();
    double largest = 0;
    for (std::size_t k = 0; k < levels_.size(); k++) {
      const double flexion = now.levels[k].y();
      if (load[k].follower > 0) largest = std::max(largest, std::abs(flexion));
      levels_[k].path -= followerPathBack(flexion, load[k].follower);
    }
    if (largest < kLevelTurns) break;
    settle(load, 0);
  }
  for (Level& level : levels_) level.start = relative(level);
  start_ = makeData(m_.get());
  mj_copyData(start_.get(), m_.get(), d_.get());
}

SpinePose WholeSpine::pose() const {
  SpinePose pose;
  for (const Level& level : levels_) {
    const Eigen::AngleAxisd rotation(Matrix3d(relative(level) * level.start.transpose()));
    pose.levels.push_back(rotation.angle() * rotation.axis());
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    X.linear() = relative(level);
    X.translation() = matrix3(d_->site_xmat + 9 * level.lower_site).transpose() *
                      (vector3(d_->site_xpos + 3 * level.upper_site) -
                       vector3(d_->site_xpos + 3 * level.lower_site));
    pose.placement.push_back(X);
  }
  return pose;
}

void WholeSpine::load(const SpineLoad& end, int steps,
                      const std::function<bool(const SpinePose&, double)>& visit) {
  mj_copyData(d_.get(), m_.get(), start_.get());
  for (int i = 1; i <= steps; i++) {
    const double share = static_cast<double>(i) / steps;
    settle(end, share);
    if (!visit(pose(), share)) return;
  }
}

std::vector<SpinePose> WholeSpine::load(const SpineLoad& end, int steps) {
  std::vector<SpinePose> poses;
  load(end, steps, [&](const SpinePose& pose, double) {
    poses.push_back(pose);
    return true;
  });
  return poses;
}

}  // namespace torso::tools
