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
  std::vector<LevelCurve> curves;    // level by level from below, all of kTurns each
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

// The lax zone of Crawford et al. 1998, J Spinal Disord 11:416-429, to one side [rad]: where the
// tangent at the curve's end meets the axis of no moment, 0 at least; before it, little resists the
// motion. (The neutral zone of Wilke et al. 1998, Eur Spine J 7:148-154, what is left at no load
// between loading and unloading, is nothing in poses at rest: discs here are viscous, but neither
// they nor ligaments and facets have friction.)
double laxZone(const std::vector<SegmentPose>& poses);

// Motion about another axis per motion about the moment's, at the curve's end; positive to the same
// side. Of lateral bending and axial rotation: one gives the other.
double coupledMotion(const LevelCurve& curve);

// Of segment_kinematics.csv.
struct PublishedKinematics {
  std::string disc, quantity;
  double value;  // [rad] for neutral zones, of coupled motions none
  std::string sources, provenance;
};
// Throws std::runtime_error that names the file, line and column at fault.
std::vector<PublishedKinematics> readPublishedKinematics(const std::string& path);

// What bounds a motion that is outside the published range: the angles [rad] of the bare disc, and
// with facets, and the ligaments that hold at its end.
struct MotionBounds {
  LevelMotion motion;
  double disc, disc_and_facets;
  std::vector<std::string> taut;
};
std::vector<MotionBounds> boundsOfMisses(const Anatomy& anatomy, const Skeleton& skeleton,
                                         const RomReport& report, int threads);
// In a sentence.
std::string reason(const MotionBounds& bounds);

}  // namespace torso::tools
