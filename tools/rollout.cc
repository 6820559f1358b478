// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/rollout.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "model/fnv1a.h"
#include "tools/clock.h"
#include "tools/mujoco_support.h"
#include "tools/random.h"

namespace torso::tools {
namespace {

constexpr double kControlInterval = 0.1;  // [s]

std::uint64_t stateHash(const mjModel* m, const mjData* d) {
  Fnv1a hash;
  hash.add(d->qpos, m->nq * sizeof(mjtNum));
  hash.add(d->qvel, m->nv * sizeof(mjtNum));
  hash.add(d->act, m->na * sizeof(mjtNum));
  hash.add(d->userdata, m->nuserdata * sizeof(mjtNum));
  return hash.value();
}

bool isFinite(const mjModel* m, const mjData* d) {
  const auto bad = [](mjtNum x) { return mju_isBad(x) != 0; };
  return std::none_of(d->qpos, d->qpos + m->nq, bad) && std::none_of(d->qvel, d->qvel + m->nv, bad);
}

// A ligament is a spatial tendon with an upper limit of its length.
std::vector<int> findLigaments(const mjModel* m) {
  std::vector<int> ligaments;
  for (int i = 0; i < m->ntendon; i++) {
    if (m->tendon_limited[i] && m->wrap_type[m->tendon_adr[i]] != mjWRAP_JOINT) {
      ligaments.push_back(i);
    }
  }
  return ligaments;
}

// The first plane of the world body.
int findFloor(const mjModel* m) {
  for (int g = 0; g < m->ngeom; g++) {
    if (m->geom_bodyid[g] == 0 && m->geom_type[g] == mjGEOM_PLANE) return g;
  }
  return -1;
}

double heightAboveFloor(const mjData* d, int floor, const mjtNum point[3]) {
  const mjtNum* R = d->geom_xmat + 9 * floor;
  const mjtNum normal[3] = {R[2], R[5], R[8]};
  mjtNum r[3];
  mju_sub3(r, point, d->geom_xpos + 3 * floor);
  return mju_dot3(normal, r);
}

// What all runs share: read only once made.
struct Setting {
  Setting(const mjModel* model, const RolloutOptions& rollout_options)
      : m(model), options(rollout_options), ligaments(findLigaments(m)), floor(findFloor(m)) {
    torso_info(m, &torso, nullptr, 0);
    if (floor < 0) return;
    const DataPtr d = makeData(m);
    mj_kinematics(m, d.get());
    mj_comPos(m, d.get());
    standing_height = heightAboveFloor(d.get(), floor, d->subtree_com);
    for (int b = 1; b < m->nbody; b++) {
      if (m->body_jntnum[b] && m->jnt_type[m->body_jntadr[b]] == mjJNT_FREE) {
        free_bodies.push_back(b);
        standing_heights.push_back(heightAboveFloor(d.get(), floor, d->xipos + 3 * b));
      }
    }
  }

  const mjModel* m;
  const RolloutOptions& options;
  torsoInfo torso = {};
  std::vector<int> ligaments;
  int floor;                             // geom, -1: none
  double standing_height = 0;            // of the centre of mass in qpos0 [m]
  std::vector<int> free_bodies;          // their ids
  std::vector<double> standing_heights;  // of their centres of mass in qpos0 [m]
};

// A run ends on the floor if the centre of mass of all bodies is below 0.6 of its height in qpos0
// and slower than 1.5 m/s, and each free body is below its own height in qpos0, but at most 5 cm
// below the floor. The speed tells a body that lies and goes on moving its limbs (up to 0.9 m/s
// seen) from one on its way down (2.7 m/s after a fall by 0.4 of a human's height).
bool endsOnFloor(const Setting& setting, mjData* d) {
  const mjModel* m = setting.m;
  if (setting.floor < 0) return false;
  mj_kinematics(m, d);
  mj_comPos(m, d);
  mj_comVel(m, d);
  mj_subtreeVel(m, d);
  if (heightAboveFloor(d, setting.floor, d->subtree_com) > 0.6 * setting.standing_height ||
      mju_norm3(d->subtree_linvel) > 1.5) {
    return false;
  }
  for (std::size_t i = 0; i < setting.free_bodies.size(); i++) {
    const double height = heightAboveFloor(d, setting.floor, d->xipos + 3 * setting.free_bodies[i]);
    if (height > setting.standing_heights[i] || height < -0.05) return false;
  }
  return true;
}

// Takes the quantities that the last mj_step computed; allocates nothing.
class Monitor {
 public:
  Monitor(const Setting& setting, RunResult& result, Violations& violations)
      : setting_(setting), result_(result), violations_(violations) {}

  void sample(const mjData* d, double time) {
    const mjModel* m = setting_.m;
    Extremes& e = result_.extremes;
    time_ = time;
    result_.constraints += d->nefc;
    for (int i = 0; i < setting_.torso.ndisc; i++) {
      larger(e.max_disc_pressure, torso_discPressure(m, d, i), i);
      mjtNum ratio[3];  // thinnest column, mean, thickest
      if (torso_discThickness(m, d, i, ratio) != 0) continue;
      smaller(e.min_disc_column, ratio[0], i);
      smaller(e.min_disc_thickness, ratio[1], i);
      larger(e.max_disc_thickness, ratio[1], i);
      larger(e.max_disc_column, ratio[2], i);
    }
    for (int i : setting_.ligaments) {
      const double violation = d->ten_length[i] - m->tendon_range[2 * i + 1];
      if (violation <= 0) continue;
      larger(e.max_ligament_violation, violation, i);
      violations_.ligament.add(violation);
    }
    for (int i = 0; i < setting_.torso.nfacet; i++) {
      const double violation = torso_facetViolation(m, d, i);
      if (violation <= 0) continue;
      larger(e.max_facet_violation, violation, i);
      violations_.facet.add(violation);
    }
  }

 private:
  void larger(Extreme& extreme, double value, int id) const {
    if (value > extreme.value) extreme = {value, id, time_, result_.seed};
  }
  void smaller(Extreme& extreme, double value, int id) const {
    if (value < extreme.value) extreme = {value, id, time_, result_.seed};
  }

  const Setting& setting_;
  RunResult& result_;
  Violations& violations_;
  double time_ = 0;
};

void mergeLarger(Extreme& all, const Extreme& one) {
  if (one.value > all.value) all = one;
}

void mergeSmaller(Extreme& all, const Extreme& one) {
  if (one.value < all.value) all = one;
}

void merge(Extremes& all, const Extremes& one) {
  mergeLarger(all.max_disc_pressure, one.max_disc_pressure);
  mergeSmaller(all.min_disc_thickness, one.min_disc_thickness);
  mergeLarger(all.max_disc_thickness, one.max_disc_thickness);
  mergeSmaller(all.min_disc_column, one.min_disc_column);
  mergeLarger(all.max_disc_column, one.max_disc_column);
  mergeLarger(all.max_ligament_violation, one.max_ligament_violation);
  mergeLarger(all.max_facet_violation, one.max_facet_violation);
}

// Calls the observers that are due at the state in d.
class ObserverClock {
 public:
  ObserverClock(const mjModel* m, const std::vector<Observer>& observers)
      : m_(m), observers_(observers), calls_(observers.size(), 0) {
    if (!observers.empty()) copy_ = makeData(m);
  }

  void tick(const mjData* d, double time) {
    bool forwarded = false;
    for (std::size_t i = 0; i < observers_.size(); i++) {
      const std::vector<double>& times = observers_[i].times;
      if (!times.empty() && calls_[i] >= static_cast<std::int64_t>(times.size())) continue;
      const double due = times.empty() ? calls_[i] / observers_[i].rate : times[calls_[i]];
      if (time < due - 1e-9) continue;
      calls_[i]++;
      if (!forwarded) {
        // On a copy: mj_forward on d itself would change the warm start of the next step.
        mj_copyData(copy_.get(), m_, d);
        mj_forward(m_, copy_.get());
        forwarded = true;
      }
      observers_[i].observe(m_, copy_.get());
    }
  }

 private:
  const mjModel* m_;
  const std::vector<Observer>& observers_;
  std::vector<std::int64_t> calls_;
  DataPtr copy_;
};

long countWarnings(const mjData* d) {
  long count = 0;
  for (const mjWarningStat& warning : d->warning) count += warning.number;
  return count;
}

std::int64_t stepsOf(const mjModel* m, double seconds) {
  return std::max<std::int64_t>(1, std::llround(seconds / m->opt.timestep));
}

// One thread's part of a rollout.
struct Worker {
  DataPtr d;
  Violations run_violations, violations;  // of the run at hand, and of all of this worker
  std::exception_ptr error;

  void run(const Setting& setting, const std::vector<Observer>& observers, RunResult& result,
           std::atomic<std::int64_t>& steps_done, const std::atomic<bool>& stop) {
    const mjModel* m = setting.m;
    const std::int64_t steps = stepsOf(m, setting.options.seconds);
    startRun(m, d.get(), setting.options);
    if (setting.options.replay) setting.options.replay(d.get(), 0);
    ControlSignal controls(m, d.get(), setting.options, result.seed);
    ObserverClock clock(m, observers);
    run_violations = {};
    Monitor monitor(setting, result, run_violations);
    const long warnings_before = threadWarnings();
    try {
      while (result.steps < steps) {
        if (stop) return;
        const double time = result.steps * m->opt.timestep;
        clock.tick(d.get(), time);
        controls.apply(m, d.get(), result.steps);
        const double start = threadSeconds();
        if (setting.options.replay) {
          d->time += m->opt.timestep;
          setting.options.replay(d.get(), d->time);
          mj_forward(m, d.get());
        } else {
          mj_step(m, d.get());
        }
        result.core_seconds += threadSeconds() - start;
        result.steps++;
        steps_done++;
        // mjData counts MuJoCo's own warnings; those of callbacks come to the handler only.
        result.warnings = std::max(countWarnings(d.get()), threadWarnings() - warnings_before);
        if (result.warnings) {
          std::string what = firstWarning(d.get());
          if (what.empty()) what = "a warning from a callback";
          result.failure = fmt::format("{} (at {:.3f} s)", what, time);
          break;
        }
        monitor.sample(d.get(), time);
      }
      if (result.failure.empty() && !isFinite(m, d.get())) {
        result.failure = "the last step left a number that is not finite";
      }
      if (result.failure.empty()) {
        clock.tick(d.get(), steps * m->opt.timestep);
        result.state_hash = stateHash(m, d.get());
        result.on_floor = endsOnFloor(setting, d.get());
      }
    } catch (const std::exception& e) {
      result.failure = fmt::format("{} (at {:.3f} s)", e.what(), result.steps * m->opt.timestep);
    }
    steps_done += steps - result.steps;
    violations.merge(run_violations);
    result.done = true;
  }
};

}  // namespace

void configureModel(mjModel* m, const RolloutOptions& options, double timestep) {
  if (timestep > 0) m->opt.timestep = timestep;
  if (options.control == Control::kNone) m->opt.disableflags |= mjDSBL_ACTUATION;
}

void startRun(const mjModel* m, mjData* d, const RolloutOptions& options) {
  if (options.keyframe >= 0) {
    mj_resetDataKeyframe(m, d, options.keyframe);
  } else {
    mj_resetData(m, d);
  }
  for (int j = 0; j < m->njnt; j++) {
    if (m->jnt_type[j] == mjJNT_FREE) d->qpos[m->jnt_qposadr[j] + 2] += options.lift;
  }
}

ControlSignal::ControlSignal(const mjModel* m, const mjData* d, const RolloutOptions& options,
                             std::uint64_t seed)
    : control_(options.control),
      amplitude_(options.amplitude),
      seed_(seed),
      from_(d->ctrl, d->ctrl + m->nu),
      to_(from_) {
  if (control_ == Control::kRandom) drawTargets(m, 0);
}

void ControlSignal::drawTargets(const mjModel* m, std::int64_t interval) {
  interval_ = interval;
  for (int i = 0; i < m->nu; i++) {
    const mjtNum* range = m->actuator_ctrlrange + 2 * i;
    const double low = m->actuator_ctrllimited[i] ? range[0] : -1;
    const double high = m->actuator_ctrllimited[i] ? range[1] : 1;
    const double rest = std::clamp(0., low, high);
    const double target = low + (high - low) * uniform(seed_, interval, i);
    to_[i] = rest + amplitude_ * (target - rest);
  }
}

void ControlSignal::apply(const mjModel* m, mjData* d, std::int64_t step) {
  if (control_ != Control::kRandom) return;
  const double position = step * m->opt.timestep / kControlInterval;
  while (interval_ < static_cast<std::int64_t>(position)) {
    from_ = to_;
    drawTargets(m, interval_ + 1);
  }
  const double s = position - interval_;
  const double blend = s * s * (3 - 2 * s);
  for (int i = 0; i < m->nu; i++) d->ctrl[i] = from_[i] + blend * (to_[i] - from_[i]);
}

std::int64_t simulate(const mjModel* m, mjData* d, ControlSignal& controls, double seconds) {
  const std::int64_t steps = stepsOf(m, seconds);
  for (std::int64_t step = 0; step < steps; step++) {
    controls.apply(m, d, step);
    mj_step(m, d);
  }
  return steps;
}

RolloutSummary rollout(const mjModel* m, const RolloutOptions& options,
                       const std::vector<Observer>& observers,
                       const std::function<void(double)>& progress, const std::atomic<bool>& stop,
                       const RunObserver& done) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const Setting setting(m, options);

  std::vector<RunResult> runs;
  for (int i = 0; i < options.seeds; i++) {
    const std::uint64_t seed = options.seed0 + i;
    if (options.skip.count(seed)) continue;
    runs.emplace_back();
    runs.back().seed = seed;
  }
  const int n = static_cast<int>(runs.size());

  std::vector<Worker> workers(std::clamp(options.threads, 1, std::max(n, 1)));
  for (Worker& worker : workers) worker.d = makeData(m);

  std::atomic<int> next = 0;
  std::atomic<std::int64_t> steps_done = 0;
  std::mutex mutex, done_mutex;
  std::condition_variable finished;
  std::size_t idle = 0;
  std::vector<std::thread> threads;
  for (Worker& worker : workers) {
    threads.emplace_back([&] {
      try {
        for (int i; !stop && (i = next++) < n;) {
          const bool observed = runs[i].seed == options.seed0;
          worker.run(setting, observed ? observers : std::vector<Observer>(), runs[i], steps_done,
                     stop);
          if (!done || !runs[i].done) continue;
          const std::lock_guard<std::mutex> lock(done_mutex);
          done(runs[i], worker.run_violations);
        }
      } catch (...) {
        worker.error = std::current_exception();
        next = n;
      }
      const std::lock_guard<std::mutex> lock(mutex);
      idle++;
      finished.notify_one();
    });
  }
  {
    const double all_steps = static_cast<double>(stepsOf(m, options.seconds)) * std::max(n, 1);
    std::unique_lock<std::mutex> lock(mutex);
    while (!finished.wait_for(lock, std::chrono::milliseconds(100),
                              [&] { return idle == workers.size(); })) {
      if (progress) progress(steps_done / all_steps);
    }
  }
  for (std::thread& thread : threads) thread.join();
  const double wall_seconds = std::chrono::duration<double>(Clock::now() - start).count();

  Violations violations;
  for (const Worker& worker : workers) {
    if (worker.error) std::rethrow_exception(worker.error);
    violations.merge(worker.violations);
  }
  runs.erase(std::remove_if(runs.begin(), runs.end(), [](const RunResult& r) { return !r.done; }),
             runs.end());
  RolloutSummary summary = summarise(m, std::move(runs), violations);
  summary.wall_seconds = wall_seconds;
  return summary;
}

RolloutSummary summarise(const mjModel* m, std::vector<RunResult> runs,
                         const Violations& violations) {
  std::sort(runs.begin(), runs.end(),
            [](const RunResult& a, const RunResult& b) { return a.seed < b.seed; });
  RolloutSummary summary;
  summary.violations = violations;
  summary.has_floor = findFloor(m) >= 0;
  Fnv1a hash;
  std::int64_t steps = 0, constraints = 0, on_floor = 0;
  for (const RunResult& run : runs) {
    summary.failed += !run.failure.empty();
    summary.warnings += run.warnings;
    summary.core_seconds += run.core_seconds;
    steps += run.steps;
    constraints += run.constraints;
    on_floor += run.on_floor;
    hash.add(&run.state_hash, sizeof(run.state_hash));
    merge(summary.extremes, run.extremes);
  }
  summary.state_hash = hash.value();
  summary.simulated_seconds = steps * m->opt.timestep;
  if (steps > 0) summary.mean_constraints = static_cast<double>(constraints) / steps;
  if (!runs.empty()) summary.on_floor = static_cast<double>(on_floor) / runs.size();
  summary.runs = std::move(runs);
  return summary;
}

}  // namespace torso::tools
