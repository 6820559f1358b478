// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// What ligaments and discs are for: the whole spine with and without them, as in Lee et al. 2023,
// section "Ablations".

#include <functional>
#include <string>
#include <vector>

#include "tools/disc_gap.h"
#include "tools/spine_load.h"

namespace torso::tools {

// The lumbar spine, L5/S1 to T12/L1, under a moment of the hanging trunk's weight, which falls from
// level to level towards the head.
struct BentPose {
  double moment = 0;            // at L5/S1, of the forward bend, below 0 of the backward one [Nm]
  std::vector<double> levels;   // flexion of L5/S1 .. T12/L1 [rad]
  double flexion() const;       // T12 against the sacrum [rad]
  double largestShare() const;  // of the level that turns most
};
// Where it has bent by so much [rad], between the two poses next to that; the last one if it has
// not. Poses from the least bent on.
BentPose bentBy(const std::vector<BentPose>& poses, double flexion);
constexpr double kForwardBend = 65 * EIGEN_PI / 180;  // as in the paper

// In equal strides of the moment from standing to kHangingShare of the trunk's weight.
struct LumbarBends {
  std::vector<BentPose> forward, backward;
};

// In full flexion back muscles fall silent (Floyd and Silver 1955, J Physiol 129:184-203), and
// passive tissue bears the weight of the trunk: 120 Nm in men (Dolan et al. 1994, J Biomech
// 27:1077-1085), passive muscle and fascia included. The spine gets this share of the moment of the
// weight above (weightAbove); without ligaments more would crush the discs.
constexpr double kHangingShare = 1.0 / 3;
// Throws Error.
LumbarBends bendLumbarSpine(const Anatomy& anatomy, const Skeleton& skeleton, bool ligaments);

// Gaps of the whole spine, by level, in the pure voluntary motions (spine_load.h), to either side,
// and so many mixtures of them, in `kMotionSteps` poses each. progress: share done. Throws Error.
constexpr int kMotionSteps = 3;
std::vector<GapStatistics> measureGaps(const Anatomy& anatomy, const Skeleton& skeleton, bool discs,
                                       int mixtures, unsigned seed,
                                       const std::function<void(double)>& progress);

struct AblationReport {
  LumbarBends whole, without_ligaments;                 // may be empty
  std::vector<GapStatistics> gaps, gaps_without_discs;  // may be empty
};

// Of what the report has, writes bend.csv, hanging.csv, gaps.csv and ablation.gp, which draws
// ablation.png, into `folder`, which is made if need be. Throws Error.
void writeAblationPlots(const std::string& folder, const Anatomy& anatomy,
                        const AblationReport& report);

}  // namespace torso::tools
