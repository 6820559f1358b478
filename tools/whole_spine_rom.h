// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Range of motion of the whole spine and of its regions, beside what is published.

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "tools/spine_load.h"

namespace torso::tools {

// Angle of each level at the end of a pure motion, about the axis of the motion [rad].
using TurnAngles = std::array<std::vector<double>, 4>;  // by Turn; L5/S1 .. C2/C3

// Sum over the levels of a region in a motion: flexion and extension together, or one side.
double regionMotion(const TurnAngles& angles, int first, int last, Motion motion);

struct SpineRegion {
  std::string name;  // as in region_motion.csv: "C3-T1"
  int first, last;   // levels
};
// Of the 23 levels from below.
const std::vector<SpineRegion>& spineRegions();

struct PublishedMotion {  // a row of region_motion.csv
  std::string region, loading;
  Motion motion;
  double value;  // [rad]; for loading "ribcage_removed" a share: 0.4
  std::string source, provenance;
};
// Throws std::runtime_error that names the file and the line.
std::vector<PublishedMotion> readRegionMotion(const std::string& path);

// What the paper takes of its motions: from least to largest angle without the outer 5 %.
struct LevelSpread {
  double flexion_extension, lateral_bending, axial_rotation;  // [rad], the last two halved
  double of(Motion motion) const {                            // one of these three
    return motion == kFlexionExtension ? flexion_extension
           : motion == kLateralBending ? lateral_bending
                                       : axial_rotation;
  }
};
// angles: by pose, turns about the axes of SpinePose::levels [rad].
LevelSpread levelSpread(const std::array<std::vector<double>, 3>& angles);

struct WholeSpineReport {
  TurnAngles voluntary, laboratory, laboratory_without_ribcage;
  std::vector<LevelSpread> spread;  // by level; empty without random motions
};

// Pure motions under voluntaryLoad and laboratoryLoad, and so many random mixtures of voluntary
// ones, the same for a seed. progress: share done, from any thread. Throws Error.
WholeSpineReport measureWholeSpine(const Anatomy& anatomy, const Skeleton& skeleton, int mixtures,
                                   unsigned seed, int threads,
                                   const std::function<void(double)>& progress);

// torso rom --whole: measures, prints a table or JSON, and plots into a folder unless it is "".
void romWhole(bool json, const std::string& plot_folder, int mixtures);

}  // namespace torso::tools
