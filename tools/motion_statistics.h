// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// What Lee et al. 2023 tell of their retrofitted motions: how far each level turns, how near
// vertebral bodies come, and both without ligaments or discs.

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "model/anatomy.h"
#include "model/skeleton.h"
#include "tools/disc_gap.h"
#include "tools/whole_spine_rom.h"

namespace torso::tools {

struct MotionStatisticsOptions {
  int every = 3;        // of the frames that are solved again, and of those whose gaps are measured
  bool without = true;  // also solve them without ligaments, and without discs
  int threads = 1;
};

// All frames of all clips with one kind of spine.
struct SpineMotions {
  // By level, L5/S1 first: the components of Posture's rotation vector over the frames [rad].
  std::vector<std::array<std::vector<double>, 3>> turns;
  std::vector<LevelSpread> spread;  // the paper's range of motion, by level
  std::vector<GapStatistics> gaps;  // by level, at the tables' size
};

struct MotionStatistics {
  std::vector<std::string> clips;
  double seconds = 0;                                    // of motion
  SpineMotions whole, without_ligaments, without_discs;  // the last two empty, if not asked for
  std::vector<std::string> errors;                       // of clips that could not be used
};

// Of the clips in a folder that `torso retrofit` has written and marked as done. Head, upper arms
// and pelvis are held where the retrofitted motion has them while the spine finds another
// equilibrium; such motions are kept as <folder>/without_discs/<clip>.bin and the like, and not
// solved again while newer than the clip's. skeleton: of the tables' size, with the bones of the
// spine. progress: share done, from any thread. Throws Error if there is no clip.
MotionStatistics measureMotions(const Anatomy& anatomy, const Skeleton& skeleton,
                                const std::string& folder, const MotionStatisticsOptions& options,
                                const std::function<void(double)>& progress);

// Writes rom.csv, gaps.csv, l5.csv and stats.gp, which draws motion_rom.png, motion_gaps.png and
// motion_l5.png, into a folder, which is made if need be. Throws Error.
void writeMotionPlots(const std::string& folder, const Anatomy& anatomy,
                      const MotionStatistics& statistics);

}  // namespace torso::tools
