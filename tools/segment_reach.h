// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Whether a segment, with its disc, facets and ligaments, reaches extreme poses: the feasibility
// test of Lee et al. 2023, section 5.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "model/anatomy.h"
#include "tools/segment_bench.h"

namespace torso::tools {

struct ExtremePose {
  Turn turn;
  double target;  // [rad]
};

struct PoseReach {
  ExtremePose pose;
  double reached;  // furthest about the pose's axis that any action turned the segment [rad]
  bool feasible() const;
};

// A pose counts as reached from this close [rad]: how well the bench's rest is known.
constexpr double kReachTolerance = 0.03 * EIGEN_PI / 180;

class SegmentReach {
 public:
  // Actions are moments on the upper bone: for each pose the laboratory's moment about its axis,
  // and actions - 1 random ones of 0.8 to 1 times that about axes near by (15 deg of standard
  // deviation about each axis across). The skeleton has the segment's bones. Throws Error.
  SegmentReach(const Anatomy& anatomy, const Skeleton& skeleton, const Disc& disc,
               const std::vector<ExtremePose>& poses, int actions = 1, std::uint64_t seed = 0);

  // A ligament, left and right alike: "ALL_lat".
  void setMaxLength(const std::string& pair, double length);  // [m]

  std::vector<PoseReach> poses();
  // A pose that is not feasible, if there is one; the pose `first` is tried before the others.
  std::optional<PoseReach> lost(Turn first);
  // The ligament's longest in any extreme pose so far [m].
  double longest(const std::string& pair) const;

 private:
  struct Action {
    Eigen::Vector3d axis;  // unit
    double moment;         // [Nm]
  };

  double furthest(std::size_t pose, double enough);

  SegmentBench bench_;
  std::vector<ExtremePose> poses_;
  std::vector<std::vector<Action>> actions_;  // of each pose
  std::vector<double> longest_;               // of the bench's ligaments [m]
};

}  // namespace torso::tools
