// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/step_cost.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "plugin/passive.h"
#include "plugin/registry.h"
#include "tools/clock.h"
#include "tools/error.h"
#include "tools/mujoco_support.h"

namespace torso::tools {
namespace {

mjtNum microseconds() { return 1e6 * threadSeconds(); }

// The callbacks as they are found; the destructor puts them back.
struct Callbacks {
  mjfTime time = mjcb_time;
  mjfGeneric passive = mjcb_passive;
  Callbacks() = default;
  Callbacks(const Callbacks&) = delete;
  Callbacks& operator=(const Callbacks&) = delete;
  ~Callbacks() {
    mjcb_time = time;
    mjcb_passive = passive;
  }
};

// Global, because mjcb_passive has no user data.
const Callbacks* found = nullptr;
double callback_us = 0;       // in the callback that was found
double disc_us = 0;           // in the discs alone
double with_discs_us = 0;     // in callbackAfterDiscs
std::vector<mjtNum> passive;  // (nv) qfrc_passive before the discs

void timedCallback(const mjModel* m, mjData* d) {
  const double start = microseconds();
  if (found->passive) found->passive(m, d);
  callback_us += microseconds() - start;
}

// Solves the discs once more, and first: the callback then finds their memory in the cache, so it
// is not timed here. What they compute is the same again, see applyDiscs.
void callbackAfterDiscs(const mjModel* m, mjData* d) {
  const double start = microseconds();
  if (const plugin::Instance* instance = plugin::findInstance(m)) {
    std::copy_n(d->qfrc_passive, m->nv, passive.begin());
    const double disc_start = microseconds();
    plugin::applyDiscs(m, d, *instance);
    disc_us += microseconds() - disc_start;
    std::copy_n(passive.begin(), m->nv, d->qfrc_passive);
  }
  if (found->passive) found->passive(m, d);
  with_discs_us += microseconds() - start;
}

// Number of steps of a run; *spent: processor time of all [us].
double run(const mjModel* m, mjData* d, const RolloutOptions& options, std::uint64_t seed,
           double* spent) {
  startRun(m, d, options);
  ControlSignal controls(m, d, options, seed);
  const double start = microseconds();
  const auto steps = static_cast<double>(simulate(m, d, controls, options.seconds));
  *spent = microseconds() - start;
  const std::string warning = firstWarning(d);
  if (!warning.empty()) {
    throw Error(fmt::format("seed {} at {:.0f} Hz is not worth measuring: {}", seed,
                            1 / m->opt.timestep, warning));
  }
  return steps;
}

}  // namespace

double stepMicroseconds(const mjModel* m, mjData* d, const RolloutOptions& options,
                        std::uint64_t seed) {
  double spent;
  const double steps = run(m, d, options, seed, &spent);
  return spent / steps;
}

StepParts stepParts(const mjModel* m, mjData* d, const RolloutOptions& options,
                    std::uint64_t seed) {
  const Callbacks callbacks;
  found = &callbacks;
  passive.resize(m->nv);
  callback_us = disc_us = with_discs_us = 0;
  double spent;

  mjcb_passive = timedCallback;
  run(m, d, options, seed, &spent);
  mjcb_passive = callbackAfterDiscs;
  mjcb_time = microseconds;
  const double steps = run(m, d, options, seed, &spent);

  const auto timer = [&](mjtTimer i) { return d->timer[i].duration; };
  StepParts parts;
  parts[kKinematics] = timer(mjTIMER_POS_KINEMATICS);
  parts[kInertia] = timer(mjTIMER_POS_INERTIA);
  parts[kCollision] = timer(mjTIMER_POS_COLLISION);
  parts[kConstraint] = timer(mjTIMER_POS_MAKE) + timer(mjTIMER_POS_PROJECT);
  parts[kDisc] = disc_us;
  parts[kRows] = callback_us - disc_us;
  parts[kVelocity] = timer(mjTIMER_VELOCITY) - with_discs_us;
  parts[kActuation] = timer(mjTIMER_ACTUATION) + timer(mjTIMER_ACCELERATION);
  parts[kSolver] = timer(mjTIMER_CONSTRAINT);
  parts[kSensor] = timer(mjTIMER_FORWARD) - timer(mjTIMER_POSITION) - timer(mjTIMER_VELOCITY) -
                   timer(mjTIMER_ACTUATION) - timer(mjTIMER_ACCELERATION) -
                   timer(mjTIMER_CONSTRAINT);
  parts[kIntegration] = timer(mjTIMER_STEP) - timer(mjTIMER_FORWARD);
  // Two runs differ by the noise of the clock, and a part may be next to nothing.
  for (double& part : parts) part = std::max(part, 0.0) / steps;
  return parts;
}

}  // namespace torso::tools
