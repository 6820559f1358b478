// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Simulations of one model from many seeds on several threads, and what they tell about discs,
// ligaments and facets. No input or output here.

#include <mujoco/mujoco.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "tools/histogram.h"

namespace torso::tools {

// What drives the actuators:
// kNone    nothing: actuation is switched off
// kHold    the controls of the start state, for good (0, or those of the keyframe)
// kRandom  every 0.1 s a new target, uniform in each actuator's control range ([-1, 1] if it has
//          none) shrunk by the amplitude towards 0 or what is nearest to it, and reached smoothly.
//          A function of seed, actuator and time alone
enum class Control { kNone, kHold, kRandom };

struct RolloutOptions {
  double seconds = 5;  // simulated time of each run [s]
  int seeds = 1;       // number of runs
  std::uint64_t seed0 = 0;
  int threads = 1;
  Control control = Control::kHold;
  double amplitude = 0.5;             // of random controls, as a share of the control range, 0 to 1
  double lift = 0;                    // every free body starts that much higher [m]
  int keyframe = -1;                  // start state, -1: qpos0 at rest
  std::set<std::uint64_t> skip = {};  // seeds that are not run
  // Instead of stepping: sets qpos and qvel for a time [s]. Forces are those of mj_forward.
  std::function<void(mjData*, double time)> replay = {};
};

// Set in the model what a rollout needs there: the time step [s], if positive, and actuation.
void configureModel(mjModel* m, const RolloutOptions& options, double timestep);

// Reset d to the start state of a run: discs at rest, free bodies lifted.
void startRun(const mjModel* m, mjData* d, const RolloutOptions& options);

// Controls of one run.
class ControlSignal {
 public:
  // d: just after startRun.
  ControlSignal(const mjModel* m, const mjData* d, const RolloutOptions& options,
                std::uint64_t seed);
  // Set d->ctrl (nu) for the time of step number `step`.
  void apply(const mjModel* m, mjData* d, std::int64_t step);

 private:
  void drawTargets(const mjModel* m, std::int64_t interval);

  Control control_;
  double amplitude_;
  std::uint64_t seed_;
  std::int64_t interval_ = 0;      // of 0.1 s, counted from the start
  std::vector<mjtNum> from_, to_;  // (nu) controls at its beginning and at its end
};

// Simulate `seconds` from the state that startRun has left in d. Returns the number of steps.
std::int64_t simulate(const mjModel* m, mjData* d, ControlSignal& controls, double seconds);

// Called for the run of seed0 at times 0, 1/rate, 2/rate, ..., on whichever thread simulates it,
// with a copy of the state for which mj_forward was called.
struct Observer {
  double rate;  // [1/s]
  std::function<void(const mjModel*, const mjData*)> observe;
  std::vector<double> times = {};  // [s] in order; if there are any, only then
};

// A largest or smallest value and where it stood.
struct Extreme {
  double value;
  int id = -1;  // disc, tendon or facet; -1: there was none
  double time = 0;
  std::uint64_t seed = 0;
};

// Pressures in Pa, violations in m, thickness as a share of that at rest.
struct Extremes {
  Extreme max_disc_pressure = {0};
  Extreme min_disc_thickness = {1}, max_disc_thickness = {1};  // of a disc's mean column
  Extreme min_disc_column = {1}, max_disc_column = {1};        // of any single column of nodes
  Extreme max_ligament_violation = {0};                        // beyond the upper length limit
  Extreme max_facet_violation = {0};                           // beyond the band
};

struct RunResult {
  std::uint64_t seed = 0;
  bool done = false;    // false only if the rollout was stopped before
  std::string failure;  // what went wrong and when; "" if nothing did
  long warnings = 0;
  std::int64_t steps = 0;
  std::int64_t constraints = 0;  // active constraint rows, sum over steps
  double core_seconds = 0;       // processor time of its thread in mj_step
  bool on_floor = false;
  std::uint64_t state_hash = 0;  // FNV-1a of the bits of qpos, qvel, act and userdata at the end
  Extremes extremes;
};

// Of all limited spatial tendons longer than their limit, and of all facets out of their band, at
// every step.
struct Violations {
  LengthHistogram ligament, facet;
  void merge(const Violations& other) {
    ligament.merge(other.ligament);
    facet.merge(other.facet);
  }
};

struct RolloutSummary {
  std::vector<RunResult> runs;  // of the seeds that were done, in their order
  int failed = 0;               // runs with a warning, an exception or a number that is not finite
  long warnings = 0;
  double simulated_seconds = 0, core_seconds = 0, wall_seconds = 0;
  double mean_constraints = 0;
  bool has_floor = false;
  double on_floor = 0;  // share of the runs, see endsOnFloor in rollout.cc
  std::uint64_t state_hash = 0;
  Extremes extremes;
  Violations violations;  // of all runs
};

// What runs tell together. They are put in the order of their seeds; violations: of all of them.
RolloutSummary summarise(const mjModel* m, std::vector<RunResult> runs,
                         const Violations& violations);

// Told of each run that is done, by one thread at a time.
using RunObserver = std::function<void(const RunResult&, const Violations&)>;

// Simulate the seeds seed0 .. seed0 + seeds - 1 on a model that configureModel has seen. The runs
// do not depend on the number of threads, bit for bit. A run that fails ends at that step. progress
// is called now and then on the calling thread with the share that is done; setting stop ends the
// rollout early. Observers, progress and done may be empty. Throws Error if memory is short, and
// what `done` throws.
//
// Not by torso_rollout, which this agrees with bit for bit (see the tests): observers want the
// moment before a step, and runs their own processor time, violations and MuJoCo's message.
RolloutSummary rollout(const mjModel* m, const RolloutOptions& options,
                       const std::vector<Observer>& observers,
                       const std::function<void(double)>& progress, const std::atomic<bool>& stop,
                       const RunObserver& done = nullptr);

}  // namespace torso::tools
