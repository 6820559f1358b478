// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/segment_bench.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "model/body.h"
#include "tools/mujoco_eigen.h"
#include "tools/rest.h"
#include "tools/torso_mjcf.h"

namespace torso::tools {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr Rest kRest = {1e-3, 2};  // [rad/s], [s]

}  // namespace

Vector3d turnAxis(Turn turn) {
  switch (turn) {
    case Turn::kFlexion:
      return Vector3d::UnitY();
    case Turn::kExtension:
      return -Vector3d::UnitY();
    case Turn::kLeftBending:
      return -Vector3d::UnitX();
    case Turn::kLeftRotation:
      return Vector3d::UnitZ();
  }
  return Vector3d::Zero();
}

double followerPathBack(double flexion, double force) {
  constexpr double kStiffness = 15;    // [Nm/rad]
  constexpr double kLeastForce = 150;  // [N], lest light loads have paths far away
  return kStiffness * flexion / std::max(force, kLeastForce);
}

double laboratoryMoment(Region region) {
  return region == Region::kLumbar ? 7.5 : region == Region::kThoracic ? 5 : 2;
}

SegmentBench::SegmentBench(const Anatomy& anatomy, const Skeleton& skeleton,
                           const std::string& disc_name, const SegmentParts& parts, double follower)
    : name_(disc_name), follower_(follower) {
  const Disc& disc = anatomy.disc(disc_name);
  MjcfOptions options;
  options.anchored = bodyOfLevel(anatomy, disc.lower);
  options.only = {options.anchored, bodyOfLevel(anatomy, disc.upper)};
  options.bones = false;
  options.skeleton = &skeleton;
  m_ = compileModel(mjcfText(anatomy, options), "segment");
  torsoOf(m_.get(), disc_name);
  mju_zero3(m_->opt.gravity);
  m_->opt.disableflags |= mjDSBL_ACTUATION;
  for (int i = 0; i < m_->ntendon; i++) {
    if (!parts.ligaments) m_->tendon_limited[i] = 0;
    const std::string tendon = nameOf(m_.get(), mjOBJ_TENDON, i);
    for (const Ligament& ligament : anatomy.ligaments) {
      if (ligament.name + "_" + disc_name == tendon) ligaments_.push_back(ligamentPair(ligament));
    }
  }
  // A margin that no distance is below.
  for (int i = 0; i < m_->npair && !parts.facets; i++) m_->pair_margin[i] = -mjMAXVAL;
  d_ = makeData(m_.get());
  const auto id = [&](mjtObj type, const std::string& name) {
    return mj_name2id(m_.get(), type, name.c_str());
  };
  upper_ = id(mjOBJ_BODY, options.only[1]);
  lower_site_ = id(mjOBJ_SITE, disc_name + "_lower");
  upper_site_ = id(mjOBJ_SITE, disc_name + "_upper");
}

std::vector<std::string> SegmentBench::taut(const SegmentPose& pose) const {
  constexpr double kTaut = 1e-5;  // [m]
  std::vector<std::string> names;
  for (int i = 0; i < m_->ntendon; i++) {
    if (pose.ligament_lengths[i] < m_->tendon_range[2 * i + 1] - kTaut) continue;
    if (std::find(names.begin(), names.end(), ligaments_[i]) == names.end()) {
      names.push_back(ligaments_[i]);
    }
  }
  return names;
}

void SegmentBench::setMaxLength(const std::string& ligament, double length) {
  for (int i = 0; i < m_->ntendon; i++) {
    if (ligaments_[i] == ligament) m_->tendon_range[2 * i + 1] = length;
  }
}

void SegmentBench::settle(const Vector3d& moment) {
  mjData* d = d_.get();
  stepToRest(m_.get(), d, kRest, "segment " + name_, [&] {
    // In the frame of the lower half of the disc, which does not move.
    const Matrix3d R = matrix3(d->site_xmat + 9 * lower_site_);
    const Vector3d force = -follower_ * R.col(2);
    const Vector3d point = vector3(d->site_xpos + 3 * upper_site_) +
                           path_ * matrix3(d->site_xmat + 9 * upper_site_).col(0);
    const Vector3d arm = point - vector3(d->xipos + 3 * upper_);
    const Vector3d torque = R * moment + arm.cross(force);
    mju_copy3(d->xfrc_applied + 6 * upper_, force.data());
    mju_copy3(d->xfrc_applied + 6 * upper_ + 3, torque.data());
  });
}

SegmentPose SegmentBench::pose(double moment, const Vector3d& axis) const {
  const mjData* d = d_.get();
  const Matrix3d R = matrix3(d->site_xmat + 9 * lower_site_);
  const Matrix3d turned = matrix3(d->site_xmat + 9 * upper_site_) * start_rotation_.transpose();
  const Eigen::AngleAxisd rotation(Matrix3d(R.transpose() * turned * R));
  SegmentPose pose;
  pose.moment = moment;
  pose.rotation = rotation.angle() * rotation.axis();
  pose.angle = pose.rotation.dot(axis);
  pose.shift = R.transpose() * (vector3(d->site_xpos + 3 * upper_site_) - start_position_);
  pose.ligament_lengths.assign(d->ten_length, d->ten_length + m_->ntendon);
  return pose;
}

std::vector<SegmentPose> SegmentBench::load(Turn turn, double moment, int steps) {
  return load(turnAxis(turn), moment, steps);
}

std::vector<SegmentPose> SegmentBench::load(const Vector3d& axis, double moment, int steps) {
  mj_resetData(m_.get(), d_.get());
  mj_forward(m_.get(), d_.get());
  start_rotation_ = matrix3(d_->site_xmat + 9 * upper_site_);
  if (follower_ > 0) {
    constexpr double kTurns = 0.05 * EIGEN_PI / 180;  // [rad]
    constexpr int kLongestSearch = 10;
    for (int i = 0; i < kLongestSearch; i++) {
      settle(Vector3d::Zero());
      const double flexion = pose(0, Vector3d::UnitY()).angle;
      if (std::abs(flexion) < kTurns) break;
      path_ -= followerPathBack(flexion, follower_);
    }
    start_rotation_ = matrix3(d_->site_xmat + 9 * upper_site_);
  }
  start_position_ = vector3(d_->site_xpos + 3 * upper_site_);
  std::vector<SegmentPose> poses = {pose(0, axis)};
  for (int i = 1; i <= steps; i++) {
    const double applied = moment * i / steps;
    settle(applied * axis);
    poses.push_back(pose(applied, axis));
  }
  return poses;
}

}  // namespace torso::tools
