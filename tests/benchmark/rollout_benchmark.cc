// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// torso_rollout on the whole body, on the same body with a fixed torso and on MuJoCo's humanoid:
// trajectories of 0.1 s per second on 1 and 2 threads, and what it costs beyond loops of mj_step.
//
//   build/tests/benchmark/rollout_benchmark --benchmark_repetitions=5
//
// `overhead_percent` is processor time over that of plain loops, less 100 %. Both go through the
// same trajectories in turn, one by one, so that what else the machine does hits them alike; it is
// the median over those pairs.

#include <benchmark/benchmark.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "model/median.h"
#include "tools/clock.h"
#include "tools/mujoco_support.h"
#include "tools/paths.h"
#include "tools/rollout.h"

namespace torso::tools {
namespace {

constexpr int kTrajectories = 8;
constexpr double kSeconds = 0.1;  // of each

// Trajectories from a standing body 0.2 m above the floor, with the random controls of `torso run`.
struct Batch {
  ModelPtr m;
  DataPtr d;
  int nstep;
  std::vector<mjtNum> start, control, state, sensordata, final_state;
  torsoRollout r;

  explicit Batch(const std::string& path) : m(loadModel(path)), d(makeData(m.get())) {
    RolloutOptions options;
    options.control = Control::kRandom;
    options.lift = 0.2;
    nstep = static_cast<int>(kSeconds / m->opt.timestep + 0.5);
    startRun(m.get(), d.get(), options);
    const int physics = torso_stateSize(m.get(), TORSO_STATE_PHYSICS);
    const int full = torso_stateSize(m.get(), TORSO_STATE_FULL);
    start.resize(full);
    torso_getState(m.get(), d.get(), start.data(), TORSO_STATE_FULL);
    for (int i = 0; i < kTrajectories; i++) {
      startRun(m.get(), d.get(), options);
      ControlSignal signal(m.get(), d.get(), options, i);
      for (int k = 0; k < nstep; k++) {
        signal.apply(m.get(), d.get(), k);
        control.insert(control.end(), d->ctrl, d->ctrl + m->nu);
      }
    }
    state.resize(kTrajectories * nstep * physics);
    sensordata.resize(kTrajectories * nstep * m->nsensordata);
    final_state.resize(kTrajectories * full);
    torso_defaultRollout(&r);
    r.ntrajectory = kTrajectories;
    r.nstep = nstep;
    r.initial_state = start.data();
    r.ninitial = 1;
    r.control = control.data();
    r.state = state.data();
    r.sensordata = sensordata.data();
    r.final_state = final_state.data();
  }

  // Part of the batch that is trajectory i.
  torsoRollout trajectory(int i) const {
    torsoRollout one = r;
    one.ntrajectory = 1;
    one.control += i * nstep * m->nu;
    one.state += i * nstep * torso_stateSize(m.get(), TORSO_STATE_PHYSICS);
    one.sensordata += i * nstep * m->nsensordata;
    one.final_state += i * torso_stateSize(m.get(), TORSO_STATE_FULL);
    return one;
  }
};

void rollout(benchmark::State& state, const std::string& path) {
  Batch batch(path);
  std::vector<DataPtr> data;
  std::vector<mjData*> pointers;
  for (int t = 0; t < state.range(0); t++) {
    data.push_back(makeData(batch.m.get()));
    pointers.push_back(data.back().get());
  }
  for (auto _ : state) {
    if (torso_rollout(batch.m.get(), pointers.data(), state.range(0), &batch.r) != 0) {
      state.SkipWithError("a trajectory failed");
      break;
    }
  }
  state.counters["trajectories"] = benchmark::Counter(
      static_cast<double>(state.iterations() * kTrajectories), benchmark::Counter::kIsRate);
}

// What torso_rollout is to replace: the least that a caller would write.
void plainLoop(const Batch& batch, int trajectory) {
  const mjModel* m = batch.m.get();
  mjData* d = batch.d.get();
  torso_setState(m, d, batch.start.data(), TORSO_STATE_FULL);
  const mjtNum* control = batch.control.data() + trajectory * batch.nstep * m->nu;
  for (int k = 0; k < batch.nstep; k++) {
    mju_copy(d->ctrl, control + k * m->nu, m->nu);
    mj_step(m, d);
  }
}

void overhead(benchmark::State& state, const std::string& path) {
  Batch batch(path);
  const DataPtr d = makeData(batch.m.get());
  mjData* const data = d.get();
  std::vector<double> ratio;
  for (auto _ : state) {
    for (int i = 0; i < kTrajectories; i++) {
      const torsoRollout one = batch.trajectory(i);
      double plain = 0, rolled = 0;
      for (int turn = 0; turn < 2; turn++) {
        const double start = threadSeconds();
        if ((turn + i) % 2) {
          plainLoop(batch, i);
          plain = threadSeconds() - start;
        } else {
          if (torso_rollout(batch.m.get(), &data, 1, &one) != 0) state.SkipWithError("failed");
          rolled = threadSeconds() - start;
        }
      }
      ratio.push_back(rolled / plain);
    }
  }
  state.counters["overhead_percent"] = 100 * (median(ratio) - 1);
}

void add(const std::string& name, const std::string& path) {
  benchmark::RegisterBenchmark(("rollout/" + name + "/threads").c_str(), rollout, path)
      ->Arg(1)
      ->Arg(2)
      ->Unit(benchmark::kMillisecond)
      ->UseRealTime();
  benchmark::RegisterBenchmark(("overhead/" + name).c_str(), overhead, path)
      ->Unit(benchmark::kMillisecond)
      ->MinTime(3);
}

}  // namespace
}  // namespace torso::tools

int main(int argc, char** argv) {
  using namespace torso::tools;
  installHandlers();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  try {
    add("human", mjcfFolder() + "/human.xml");
    add("human_fixed", mjcfFolder() + "/human_fixed.xml");
    add("humanoid", "/usr/share/mujoco/model/humanoid/humanoid.xml");
    benchmark::RunSpecifiedBenchmarks();
  } catch (const std::exception& e) {
    std::cerr << "rollout_benchmark: " << e.what() << '\n';
    return 1;
  }
  benchmark::Shutdown();
}
