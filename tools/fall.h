// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// A body that falls on the floor: the force of the floor and the acceleration of the head.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "tools/mujoco_support.h"

namespace torso::tools {

struct FallOptions {
  double height = 2;                     // by which the body starts higher than it stands [m]
  double seconds = 3;                    // simulated time
  double rate = 2400;                    // steps per second
  double amplitude = 0.1;                // of the random controls, share of each actuator's range
  std::vector<double> frame_times = {};  // [s] after the first touch, in order; may be negative
};

struct Fall {
  std::uint64_t seed = 0;
  double interval = 0;                       // of the samples [s]
  double weight = 0;                         // of the body [N]
  std::vector<Eigen::Vector3d> floor_force;  // sum of all contacts with the world, world axes [N]
  std::vector<double> head_acceleration;     // of the head's centre of mass; 0 in free fall [g]
  double touch = -1;                         // first contact with the world [s], < 0: none
  double head_touch = -1;                    // of the head with the world [s], < 0: none
  std::vector<DataPtr> frames;               // at frame_times, mj_forward called
};

// Lets the model fall from qpos0 with small random controls of that seed. A sample is the mean over
// a step, exactly: the force, which MuJoCo holds for a step, and the change of velocity over it.
// Frames beyond the end of the run, or of a body that touches nothing, are left out. Throws Error
// "<path>: ..." if the model has no free body or no body "head", or if MuJoCo warns of anything.
Fall fall(const mjModel* model, const std::string& path, const FallOptions& options,
          std::uint64_t seed);

constexpr double kLanding = 0.1;  // the first touch and what follows at once [s]

struct FallPeaks {
  double force = 0;     // of the floor [N]
  double head = 0;      // acceleration of the head [g]
  double head_3ms = 0;  // exceeded for 3 ms in sum [g]
  double hic15 = 0;
};

FallPeaks peaksOf(const Fall& fall);         // in all the fall
FallPeaks landingPeaksOf(const Fall& fall);  // within kLanding of the first touch, 0 if none

}  // namespace torso::tools
