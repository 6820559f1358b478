// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// What a simulation step costs, as a whole and by part.

#include <mujoco/mujoco.h>

#include <array>
#include <cstdint>

#include "tools/rollout.h"

namespace torso::tools {

enum StepPart {
  kKinematics,  // positions of bodies, tendons, cameras and lights
  kInertia,     // composite inertia and its factor
  kCollision,   // with the facets' collision function
  kConstraint,  // constraint rows and actuators' moment arms
  kDisc,        // the torso plugin's disc solver
  kRows,        // the rest of mjcb_passive: the plugin rewrites rows of welds, ligaments and facets
  kVelocity,    // velocities, passive and bias forces, reference accelerations
  kActuation,   // actuator forces and the unconstrained acceleration
  kSolver,      // the constraint solver
  kSensor,      // sensors
  kIntegration,  // the integrator, and checks of the state
  kNumParts
};
inline constexpr const char* kPartNames[kNumParts] = {
    "kinematics", "inertia",   "collision", "constraint", "disc",       "rows",
    "velocity",   "actuation", "solver",    "sensor",     "integration"};

using StepParts = std::array<double, kNumParts>;  // [us] a step

// Mean processor time [us] of a step with its controls, in the run of that seed. Throws Error if
// MuJoCo warns of anything in the run. Any number of threads may call it.
double stepMicroseconds(const mjModel* m, mjData* d, const RolloutOptions& options,
                        std::uint64_t seed);

// The same by part, from two more runs of that seed. They set mjcb_time and mjcb_passive and put
// back what was there, so no other thread may use MuJoCo meanwhile.
StepParts stepParts(const mjModel* m, mjData* d, const RolloutOptions& options, std::uint64_t seed);

}  // namespace torso::tools
