// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Loads that bring the whole spine to its extremes.

#include "tools/segment_bench.h"
#include "tools/whole_spine.h"

namespace torso::tools {

// What the body above each level weighs [N] and the moment of that weight about the level if the
// trunk leans until it is level [Nm]; L5/S1 .. C2/C3. The arms weigh at the shoulders.
struct WeightAbove {
  double force, moment;
};
std::vector<WeightAbove> weightAbove(const Anatomy& anatomy);

// The laboratory's pure moments (laboratoryMoment) along an axis [unit, axes of SpineLoad].
SpineLoad laboratoryLoad(const Anatomy& anatomy, const Eigen::Vector3d& axis);

// A standing person: each level carries the weight above it, and the lumbar ones 500 N (Rohlmann et
// al. 2009, Eur Spine J 18:1206-1212: the follower load that gives the motions and disc pressures
// of living people who stand).
SpineLoad standingLoad(const Anatomy& anatomy);

// A person at the extreme of a voluntary motion.
// Lumbar: the loads with which specimens and models do what was measured in living people: flexion
// 7.5 Nm and 1175 N, extension 7.5 Nm and 500 N (Rohlmann et al. 2009, J Biomech 42:884-890),
// lateral bending 7.8 Nm and 700 N (Dreischarf et al. 2012, Med Eng Phys 34:777-780), axial
// rotation 5.5 Nm and 720 N (Dreischarf et al. 2011, J Biomech 44:2323-2327).
// Thorax: weight bends the spine the less the higher; the moment is the lumbar one times
// weightAbove over that at L5/S1. A torque about the long axis goes through the trunk undiminished.
// Both are near the 2 and 5 Nm at which whole thoraces are tested (Liebsch et al. 2017, PLoS ONE
// 12:e0178733; Mannen et al. 2015, J Biomech 48:2060-2066). Compression: the weight above.
// Neck, which has muscles of its own: the laboratory's moment, under the head's weight.
SpineLoad voluntaryLoad(const Anatomy& anatomy, Turn turn);

// A mixture of voluntary motions with these weights, taken to the length 1: flexion (below 0:
// extension), bending to the left, rotation to the left; compressions with the weights' squares.
SpineLoad mixedLoad(const Anatomy& anatomy, const Eigen::Vector3d& weights);

// So many weights of random directions, the same for a seed.
std::vector<Eigen::Vector3d> randomWeights(int count, unsigned seed);

}  // namespace torso::tools
