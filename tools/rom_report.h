// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Range of motion of the segments on the bench, beside what is published.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "model/anatomy.h"
#include "tools/segment_bench.h"

namespace torso::tools {

struct LevelMotion {
  std::string disc;
  Motion motion;
  double angle;       // [rad], at the laboratory's moment
  MotionRange range;  // published
  bool inside() const { return angle >= range.low && angle <= range.high; }
};

struct LevelCurve {
  std::string disc;
  Turn turn;
  std::vector<SegmentPose> poses;  // moment rises in equal steps
};

struct RomReport {
  std::vector<LevelMotion> motions;  // level by level from below, all five each
  std::vector<LevelCurve> curves;
};

// Compression that follows the spine's curve [N], as studies put on segments of a region:
// Patwardhan et al. 1999, Spine 24:1003-1009 (lumbar, 400 of 1200 N), Sis et al. 2016, J Biomech
// 49:510-514 (thoracic, 400), Miura et al. 2002, J Spinal Disord Tech 15:355-360 (cervical, 100).
double followerLoad(Region region);

// discs: names; empty: all 23. progress: share done, from any thread. Throws Error.
RomReport measureRom(const Anatomy& anatomy, const Skeleton& skeleton,
                     const std::vector<std::string>& discs, const SegmentParts& parts,
                     bool follower, int threads, const std::function<void(double)>& progress);

// Sum over a region's segments, those whose upper bone lies in it.
double regionSum(const Anatomy& anatomy, const RomReport& report, Region region, Motion motion);

}  // namespace torso::tools
