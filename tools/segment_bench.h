// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// A motion segment on the laboratory's bench: two neighbouring bones with the disc, the ligaments
// and the facets between them, cut out of the body, the lower bone clamped, without gravity.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "model/anatomy.h"
#include "model/skeleton.h"
#include "tools/mujoco_support.h"

namespace torso::tools {

struct SegmentParts {
  bool ligaments = true, facets = true;
};

// A way to turn the upper bone: moment and rotation are about this axis of the disc's frame.
enum class Turn { kFlexion, kExtension, kLeftBending, kLeftRotation };
constexpr Turn kTurns[] = {Turn::kFlexion, Turn::kExtension, Turn::kLeftBending,
                           Turn::kLeftRotation};
Eigen::Vector3d turnAxis(Turn turn);  // unit, x forward, y left, z up

// Where the segment has come to rest under a load.
struct SegmentPose {
  double moment;             // [Nm]
  double angle;              // of the upper bone about the axis of the moment [rad]
  Eigen::Vector3d rotation;  // rotation vector from the pose without moment, disc frame [rad]
  Eigen::Vector3d shift;     // of the upper bone's point at the disc's centre, disc frame [m]
  std::vector<double> ligament_lengths;  // [m], in the order of SegmentBench::ligaments
};

class SegmentBench {
 public:
  // The skeleton has the bones that the segment is made of. disc: name, "L4/L5". follower:
  // compression along the disc's axis [N], there before the moment, on the path before or behind
  // the disc's centre on which it does not turn the segment. Throws Error.
  SegmentBench(const Anatomy& anatomy, const Skeleton& skeleton, const std::string& disc,
               const SegmentParts& parts = {}, double follower = 0);

  // The ligaments, left ones and right ones, without level and side: "ALL_lat" twice.
  const std::vector<std::string>& ligaments() const { return ligaments_; }

  // Poses under pure moments of constant axis, from none to `moment` [Nm] in equal steps, each held
  // until the segment is at rest. Throws Error if MuJoCo warns.
  std::vector<SegmentPose> load(Turn turn, double moment, int steps);
  // The same about any axis (unit, disc frame); the poses' angles are about it.
  std::vector<SegmentPose> load(const Eigen::Vector3d& axis, double moment, int steps);

  // Which of them hold in a pose: those that are at their largest length, each once.
  std::vector<std::string> taut(const SegmentPose& pose) const;

  // From now on these ligaments hold at `length` [m], left and right.
  void setMaxLength(const std::string& ligament, double length);

 private:
  void settle(const Eigen::Vector3d& moment);
  SegmentPose pose(double moment, const Eigen::Vector3d& axis) const;

  std::string name_;
  ModelPtr m_;
  DataPtr d_;
  int upper_;                       // body
  int lower_site_, upper_site_;     // frames of the disc
  Eigen::Matrix3d start_rotation_;  // of the upper site without moment
  Eigen::Vector3d start_position_;
  double follower_;
  double path_ = 0;  // of the follower load in front of the disc's centre [m]
  std::vector<std::string> ligaments_;
};

// How far back [m] to move the path of a follower load [N] that has flexed a level by so much
// [rad]: by what would hold a level softer than any. A few rounds of this find the path on which
// compression turns nothing (Patwardhan et al. 1999, Spine 24:1003-1009).
double followerPathBack(double flexion, double force);

// Moment at which laboratories compare segments of a region [Nm]: Wilke et al. 1998, Eur Spine J
// 7:148-154, recommend 7.5 for lumbar, 5 for thoracic and 2.5 or less for cervical segments.
double laboratoryMoment(Region region);

}  // namespace torso::tools
