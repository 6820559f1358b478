// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The left shoulder on the bench: rib cage clamped, with clavicle, scapula and arm.

#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include "model/anatomy.h"
#include "model/skeleton.h"
#include "tools/mujoco_support.h"
#include "tools/scapular_muscles.h"

namespace torso::tools {

// Angles are ISB's (Wu et al. 2005, J Biomech 38:981-992), against the rib cage [rad].
struct ShoulderPose {
  double time;       // [s]
  double elevation;  // of the humerus from straight down
  // Change since the arm hung at the side.
  double upward_rotation, posterior_tilt, external_rotation;  // of the scapula
  double clavicle_elevation, clavicle_retraction, clavicle_posterior_rotation;
  double gliding_distance;  // largest of the scapula's four points from its ellipsoid [m]
  double clearance;         // least between the meshes of scapula and rib cage, below 0 inside [m]
  double medial_border;     // largest distance of the scapula's medial border from the ribs [m]
  double inferior_angle;    // of its lower end from them [m]
  // Turns of sternoclavicular, acromioclavicular and glenohumeral joint, as in qpos.
  std::array<std::array<double, 4>, 3> joints;
};
// The joints' names, in that order: "left_sternoclavicular" ...
constexpr std::array<const char*, 3> kShoulderJoints = {
    "left_sternoclavicular", "left_acromioclavicular", "left_glenohumeral"};

// Ways to move the shoulder girdle with the arm hanging, by its servos.
enum class GirdleMotion { kElevation, kDepression, kProtraction, kRetraction };
constexpr GirdleMotion kGirdleMotions[] = {GirdleMotion::kElevation, GirdleMotion::kDepression,
                                           GirdleMotion::kProtraction, GirdleMotion::kRetraction};
const char* girdleMotionName(GirdleMotion motion);  // "elevation" ...

class ShoulderBench {
 public:
  // The bodies whose bones the skeleton must have.
  static std::vector<std::string> bodies();

  // Throws Error.
  ShoulderBench(const Anatomy& anatomy, const Skeleton& skeleton);

  // With the arm at the side, nothing pulling.
  ShoulderPose rest();

  // Raises the arm in the coronal plane to `top` [rad] within `seconds` and lowers it as slowly: a
  // couple between rib cage and humerus turns the shaft of the humerus, which may spin, and the
  // muscles pull at scapula and clavicle. No servos and no gravity: the rest of what the scapula
  // does comes of capsule, joints and the ellipsoid it glides on.
  // Poses at equal times, `count` on the way up and as many on the way down. Throws Error if MuJoCo
  // warns.
  std::vector<ShoulderPose> raiseArm(double top, double seconds, int count,
                                     const std::vector<ScapularMuscle>& muscles);

  // Where the servos of the sternoclavicular joint bring the girdle, the others held at rest, under
  // gravity: the pose at rest, then `count` poses on the way to the end of the servo's range.
  std::vector<ShoulderPose> moveGirdle(GirdleMotion motion, int count);

 private:
  void reset(bool servos);
  void step(const Eigen::Vector3d& shaft_target, const std::vector<ScapularMuscle>& muscles);
  void pull(const ScapularMuscle& muscle, double tension);  // adds to qfrc_applied
  double elevation() const;                                 // of the humerus [rad]
  ShoulderPose pose() const;
  Eigen::Matrix3d turned(int body) const;  // from rest to now, rib cage axes
  Eigen::Isometry3d placed(int body, const Eigen::Isometry3d& rest) const;

  const Anatomy& anatomy_;
  const Skeleton& skeleton_;
  ModelPtr m_;
  DataPtr d_;
  int ribcage_, scapula_, clavicle_, humerus_, ellipsoid_, points_[4];  // bodies; geoms
  std::vector<Eigen::Vector3d> border_;  // medial border, inferior angle last [m], standing body
  ShoulderPose rest_ = {};
};

}  // namespace torso::tools
