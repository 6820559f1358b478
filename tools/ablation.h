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

// The trunk bent forward until T1 has turned by kForwardBend against the pelvis, by moments that
// fall towards the head as those of its weight do.
struct ForwardBend {
  std::vector<double> levels;   // flexion of L5/S1 .. T1/T2 [rad]
  double moment;                // at L5/S1 [Nm]
  double largestShare() const;  // of the level that turns most
  int levelsForHalf() const;    // how many of them, the largest first, make up half
};
constexpr double kForwardBend = 65 * EIGEN_PI / 180;

struct SpineAblation {
  std::vector<double> l5_flexion;  // L5/S1 over all poses of the motions [rad]
  ForwardBend bend;
  std::vector<GapStatistics> gaps;  // by level
};

struct AblationReport {
  SpineAblation whole, without_ligaments, without_discs;  // the last one without a bend
};

// Each spine in the same motions: the pure voluntary ones (spine_load.h), to either side, and so
// many mixtures of them, in `kMotionSteps` poses each. progress: share done. Throws Error.
constexpr int kMotionSteps = 3;
AblationReport measureAblation(const Anatomy& anatomy, const Skeleton& skeleton, int mixtures,
                               unsigned seed, int threads,
                               const std::function<void(double)>& progress);

// Writes l5.csv, bend.csv, gaps.csv and ablation.gp, which draws ablation.png, into `folder`, which
// is made if need be. Throws Error.
void writeAblationPlots(const std::string& folder, const Anatomy& anatomy,
                        const AblationReport& report);

}  // namespace torso::tools
