// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/shoulder_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/body.h"
#include "model/facet_gap.h"
#include "model/rotation.h"
#include "tools/error.h"
#include "tools/mujoco_eigen.h"
#include "tools/torso_mjcf.h"

namespace torso::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// The couple on the arm follows its target as a spring and a damper: stiff against the capsule.
constexpr double kGuide = 300, kGuideDamping = 10;  // [Nm/rad], [Nms/rad]

Vector3d shaftAtRest(const Anatomy& a) {
  return (a.landmark("elbow") - a.landmark("glenohumeral_centre_GH")).normalized();
}

}  // namespace

const char* girdleMotionName(GirdleMotion motion) {
  constexpr const char* kNames[] = {"elevation", "depression", "protraction", "retraction"};
  return kNames[static_cast<int>(motion)];
}

std::vector<std::string> ShoulderBench::bodies() {
  // The plugin wants a disc: two vertebrae hang along.
  return {"T5",
          "T4",
          "ribcage",
          "left_clavicle",
          "left_scapula",
          "left_upper_arm",
          "left_lower_arm",
          "left_hand"};
}

ShoulderBench::ShoulderBench(const Anatomy& anatomy, const Skeleton& skeleton)
    : anatomy_(anatomy), skeleton_(skeleton) {
  MjcfOptions options;
  options.limbs = true;
  options.anchored = "ribcage";
  options.only = bodies();
  options.bones = false;
  options.skeleton = &skeleton;
  m_ = compileModel(mjcfText(anatomy, options), "shoulder");
  d_ = makeData(m_.get());
  const auto id = [&](mjtObj type, const std::string& name) {
    return mj_name2id(m_.get(), type, name.c_str());
  };
  ribcage_ = id(mjOBJ_BODY, "ribcage");
  scapula_ = id(mjOBJ_BODY, "left_scapula");
  clavicle_ = id(mjOBJ_BODY, "left_clavicle");
  humerus_ = id(mjOBJ_BODY, "left_upper_arm");
  ellipsoid_ = id(mjOBJ_GEOM, "scapulothoracic_left_ellipsoid");
  for (int k = 0; k < 4; k++) {
    points_[k] = id(mjOBJ_GEOM, fmt::format("scapulothoracic_left_point{}", k));
  }
  const Vector3d ts = anatomy.landmark("scapula_root_of_spine_TS");
  const Vector3d ai = anatomy.landmark("scapula_inferior_angle_AI");
  for (double share :
       {-0.4, 0.0, 0.25, 0.5, 0.75, 1.0}) {  // from the superior to the inferior angle
    border_.push_back(skeleton.bone("left_scapula").nearest(ts + share * (ai - ts)).point);
  }
}

Matrix3d ShoulderBench::turned(int body) const {
  // All three bones have the axes of the standing body at rest, as has the clamped rib cage.
  return matrix3(d_->xmat + 9 * body);
}

Isometry3d ShoulderBench::placed(int body, const Isometry3d& rest) const {
  Isometry3d X = Isometry3d::Identity(), R = Isometry3d::Identity();
  X.linear() = matrix3(d_->xmat + 9 * body);
  X.translation() = vector3(d_->xpos + 3 * body);
  R.translation() = vector3(d_->xpos + 3 * ribcage_);
  return bodyFrame(anatomy_, "ribcage") * R.inverse() * X * rest.inverse();
}

ShoulderPose ShoulderBench::pose() const {
  const auto landmark = [&](const char* name) { return anatomy_.landmark(name); };
  const Vector3d ts = landmark("scapula_root_of_spine_TS");
  const Vector3d spine = landmark("acromion_angle_AA") - ts;
  const Vector3d back = spine.cross(landmark("scapula_inferior_angle_AI") - ts);  // of the blade
  const Vector3d clavicle =
      landmark("acromioclavicular_joint_AC") - landmark("sternoclavicular_joint_SC");
  ShoulderPose p = {};
  p.time = d_->time;
  p.elevation = elevation();
  // ISB's sequence for the scapula: internal rotation, upward rotation, tilt.
  const Vector3d s = (turned(scapula_) * spine).normalized();
  const Vector3d normal = turned(scapula_) * back;
  const Vector3d level = Vector3d(-s.y(), s.x(), 0).normalized();
  p.upward_rotation = std::asin(s.z()) - rest_.upward_rotation;
  p.external_rotation = -std::atan2(s.x(), s.y()) - rest_.external_rotation;
  p.posterior_tilt =
      -std::atan2(normal.dot(s.cross(level)), normal.dot(level)) - rest_.posterior_tilt;
  const Vector3d c = (turned(clavicle_) * clavicle).normalized();
  p.clavicle_elevation = std::asin(c.z()) - rest_.clavicle_elevation;
  p.clavicle_retraction = std::atan2(-c.x(), c.y()) - rest_.clavicle_retraction;
  const Eigen::Quaterniond q(turned(clavicle_));
  p.clavicle_posterior_rotation = -2 * std::atan2(q.vec().dot(clavicle.normalized()), q.w()) -
                                  rest_.clavicle_posterior_rotation;

  const Vector3d radii = vector3(m_->geom_size + 3 * ellipsoid_);
  for (int point : points_) {
    const Vector3d place =
        matrix3(d_->geom_xmat + 9 * ellipsoid_).transpose() *
        (vector3(d_->geom_xpos + 3 * point) - vector3(d_->geom_xpos + 3 * ellipsoid_));
    // With no band the violation is the distance.
    p.gliding_distance =
        std::max(p.gliding_distance, std::abs(facetGap(place, radii, 0, place).violation));
  }
  const MeshTree& ribs = skeleton_.whole("ribcage");
  const Isometry3d X = placed(scapula_, bodyFrame(anatomy_, "left_scapula"));
  p.clearance = std::numeric_limits<double>::infinity();
  for (const Vector3d& v : skeleton_.bone("left_scapula").mesh().vertices) {
    p.clearance = std::min(p.clearance, ribs.signedDistance(X * v));
  }
  for (const Vector3d& v : border_) {
    p.inferior_angle = ribs.nearest(X * v).distance;
    p.medial_border = std::max(p.medial_border, p.inferior_angle);
  }
  for (std::size_t k = 0; k < kShoulderJoints.size(); k++) {
    const int joint = mj_name2id(m_.get(), mjOBJ_JOINT, kShoulderJoints[k]);
    std::copy_n(d_->qpos + m_->jnt_qposadr[joint], 4, p.joints[k].begin());
  }
  return p;
}

double ShoulderBench::elevation() const {
  return std::acos(std::clamp(-(turned(humerus_) * shaftAtRest(anatomy_)).z(), -1.0, 1.0));
}

void ShoulderBench::reset(bool servos) {
  mjModel* m = m_.get();
  mj_resetData(m, d_.get());
  m->opt.gravity[2] = servos ? -9.81 : 0;
  m->opt.disableflags = servos ? 0 : mjDSBL_ACTUATION;
  mj_forward(m, d_.get());
  rest_ = {};
  rest_ = pose();
}

ShoulderPose ShoulderBench::rest() {
  reset(false);
  return pose();
}

void ShoulderBench::pull(const ScapularMuscle& muscle, double tension) {
  const int body = muscle.on_clavicle ? clavicle_ : scapula_;
  const auto now = [&](int b, const char* name, const Vector3d& standing) {
    const Vector3d local = standing - bodyFrame(anatomy_, name).translation();
    return Vector3d(vector3(d_->xpos + 3 * b) + matrix3(d_->xmat + 9 * b) * local);
  };
  const Vector3d end = now(body, muscle.on_clavicle ? "left_clavicle" : "left_scapula",
                           anatomy_.landmark(muscle.landmark));
  const Vector3d force = tension * (now(ribcage_, "ribcage", muscle.other) - end).normalized();
  const Vector3d torque = Vector3d::Zero();
  mj_applyFT(m_.get(), d_.get(), force.data(), torque.data(), end.data(), body, d_->qfrc_applied);
}

void ShoulderBench::step(const Vector3d& shaft_target, const std::vector<ScapularMuscle>& muscles) {
  mjModel* m = m_.get();
  mjData* d = d_.get();
  const Vector3d shaft = turned(humerus_) * shaftAtRest(anatomy_);
  const Eigen::AngleAxisd error(leastRotation(shaft, shaft_target));
  mjtNum velocity[6];
  mj_objectVelocity(m, d, mjOBJ_BODY, humerus_, velocity, 0);
  const Vector3d w = vector3(velocity);
  const Vector3d couple =
      kGuide * error.angle() * error.axis() - kGuideDamping * (w - shaft * shaft.dot(w));
  mju_copy3(d->xfrc_applied + 6 * humerus_ + 3, couple.data());
  mju_zero(d->qfrc_applied, m->nv);
  for (const ScapularMuscle& muscle : muscles) pull(muscle, tensionAt(muscle, elevation()));
  mj_step(m, d);
  const std::string warning = firstWarning(d);
  if (!warning.empty()) throw Error(fmt::format("shoulder: {}", warning));
}

std::vector<ShoulderPose> ShoulderBench::raiseArm(double top, double seconds, int count,
                                                  const std::vector<ScapularMuscle>& muscles) {
  reset(false);
  const Vector3d rest = shaftAtRest(anatomy_);
  const double start = std::acos(-rest.z());
  std::vector<ShoulderPose> poses;
  const int steps = static_cast<int>(std::ceil(seconds / count / m_->opt.timestep));
  for (int i = 0; i < 2 * count; i++) {
    for (int k = 1; k <= steps; k++) {
      const double done = (i + static_cast<double>(k) / steps) / count;
      const double share = done < 1 ? done : 2 - done;
      const double angle = start + share * (top - start);
      // At rest the arm hangs a little forward; it gets into the coronal plane within 15 degrees.
      const double forward = rest.x() * std::max(0.0, 1 - 10 * share);
      step(Vector3d(forward, std::sin(angle), -std::cos(angle)).normalized(), muscles);
    }
    poses.push_back(pose());
  }
  return poses;
}

std::vector<ShoulderPose> ShoulderBench::moveGirdle(GirdleMotion motion, int count) {
  reset(true);
  mjModel* m = m_.get();
  mjData* d = d_.get();
  const bool lift = motion == GirdleMotion::kElevation || motion == GirdleMotion::kDepression;
  const bool up = motion == GirdleMotion::kElevation || motion == GirdleMotion::kProtraction;
  const int servo =
      mj_name2id(m, mjOBJ_ACTUATOR,
                 lift ? "left_sternoclavicular_elevation" : "left_sternoclavicular_protraction");
  const double end = m->actuator_ctrlrange[2 * servo + (up ? 1 : 0)];
  constexpr double kSettle = 1, kStride = 0.5;  // [s], before and at each pose
  std::vector<ShoulderPose> poses;
  const auto run = [&](double seconds) {
    for (double t = 0; t < seconds; t += m->opt.timestep) mj_step(m, d);
    const std::string warning = firstWarning(d);
    if (!warning.empty()) throw Error(fmt::format("shoulder: {}", warning));
  };
  run(kSettle);
  rest_ = {};
  rest_ = pose();
  poses.push_back(pose());
  for (int i = 1; i <= count; i++) {
    d->ctrl[servo] = end * i / count;
    run(kStride);
    poses.push_back(pose());
  }
  return poses;
}

}  // namespace torso::tools
