// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The lengths at which ligaments hold, from the range of motion that is published for each level.

#include <functional>
#include <string>
#include <vector>

#include "model/anatomy.h"
#include "tools/segment_bench.h"

namespace torso::tools {

// What held a ligament's length from being shorter.
struct LigamentLength {
  std::string disc, ligament;  // "L4/L5", "ALL_lat": left and right alike
  double rest, max;            // [m]
  Turn turn;                   // the extreme pose in which it is longest
};

struct LevelReach {  // how far the disc and the facets alone let a level turn
  std::string disc;
  Turn turn;
  double target, reached;  // [rad]; reached < target: the moment did not suffice
};

struct Identification {
  std::vector<LigamentLength> lengths;
  std::vector<LevelReach> reach;
};

// Turns each segment, without its ligaments, into its extreme poses (the mean of
// range_of_motion.csv in flexion, extension, bending and rotation to either side), or as far as the
// laboratory's moment turns it, and takes for each ligament the longest that it gets: any shorter,
// and it would stand between the segment and one of the poses. That is the end of the sequential
// shortening of Lee et al. 2023, section 5, without the search. Left and right ligaments are alike.
// Deterministic, for any number of threads. progress: share done, 0 to 1, from any thread.
Identification identifyLigaments(const Anatomy& anatomy, const Skeleton& skeleton,
                                 const std::vector<std::string>& discs, int threads,
                                 const std::function<void(double)>& progress);

// Anatomy with these lengths.
Anatomy withLengths(Anatomy anatomy, const std::vector<LigamentLength>& lengths);

}  // namespace torso::tools
