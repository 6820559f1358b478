// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The lengths at which ligaments hold, from the range of motion that is published for each level.

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "model/anatomy.h"
#include "tools/segment_bench.h"
#include "tools/segment_reach.h"

namespace torso::tools {

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

struct IdentifyOptions {
  std::map<std::string, RangeOfMotion> targets;  // by disc; their means are used
  std::vector<std::string> discs;                // names; empty: all but C2/C3
  std::vector<std::string> order;                // ligaments ("ALL_mid") to tighten first
  int threads = 1;
};

// Turns each segment, without its ligaments, into its extreme poses (the mean of the targets in
// flexion, extension, bending and rotation to either side), or as far as the laboratory's moment
// turns it, and takes for each ligament the longest that it gets: any shorter, and it would stand
// between the segment and one of the poses. That is where the sequential shortening of Lee et al.
// 2023, section 5, ends for a ligament that alone holds a pose. With all ligaments the segment
// takes slightly other paths, so that some are left with slack; those are then shortened one after
// the other, as in the paper, until the segment would lose a pose: first those in `order`, then
// those that are longest in one pose by far, then the others as the tables have them. Left and
// right ligaments are alike. Deterministic, for any number of threads. progress: share done, 0 to
// 1, from any thread.
Identification identifyLigaments(const Anatomy& anatomy, const Skeleton& skeleton,
                                 const IdentifyOptions& options,
                                 const std::function<void(double)>& progress);

// The same with the lengths that the anatomy has.
Identification presentLengths(const Anatomy& anatomy, const Skeleton& skeleton,
                              const IdentifyOptions& options,
                              const std::function<void(double)>& progress);

// Anatomy with these lengths.
Anatomy withLengths(Anatomy anatomy, const std::vector<LigamentLength>& lengths);

struct FeasibilityOptions {
  int actions = 8;         // per pose, as SegmentReach has them
  std::uint64_t seed = 1;  // of the random ones
  double step = 0.02;      // by which a ligament is shortened, of its length at rest
  int threads = 1;
};

struct LevelFeasibility {
  std::string disc;
  std::vector<PoseReach> poses;  // with the lengths as they are
  struct Shortening {
    std::string ligament;
    std::optional<PoseReach> lost;  // the pose that one step shorter costs
    bool slack;                     // in all poses: inactive
  };
  std::vector<Shortening> shortenings;
};

// The test with which Lee et al. 2023 end their search: that each extreme pose (what disc and
// facets alone allow where that is less than the target) can be reached with the lengths, under
// random actions, and with any ligament a step shorter cannot. As identifyLigaments otherwise.
std::vector<LevelFeasibility> checkFeasibility(const Anatomy& anatomy, const Skeleton& skeleton,
                                               const Identification& found,
                                               const FeasibilityOptions& options,
                                               const std::function<void(double)>& progress);

}  // namespace torso::tools
