// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Cost of mj_step for the whole body: falling from 0.2 m with random controls, as in `torso bench`,
// and on the floor 2 s later; for comparison with a fixed torso.
//
//   build/tests/benchmark/step_benchmark --benchmark_repetitions=5

#include <benchmark/benchmark.h>
#include <mujoco/mujoco.h>

#include <exception>
#include <iostream>
#include <string>

#include "tools/mujoco_support.h"
#include "tools/paths.h"
#include "tools/rollout.h"

namespace torso::tools {
namespace {

// Steps between two returns to the state that the measurement starts from.
constexpr int kSteps = 200;

void step(benchmark::State& state, const std::string& file, double rate, double warm_up) {
  const ModelPtr m = loadModel(mjcfFolder() + "/" + file);
  RolloutOptions options;
  options.control = Control::kRandom;
  options.lift = 0.2;
  configureModel(m.get(), options, 1 / rate);
  const DataPtr start = makeData(m.get()), d = makeData(m.get());
  startRun(m.get(), start.get(), options);
  ControlSignal warm_up_controls(m.get(), start.get(), options, 1);
  if (warm_up > 0) simulate(m.get(), start.get(), warm_up_controls, warm_up);

  for (auto _ : state) {
    state.PauseTiming();
    mj_copyData(d.get(), m.get(), start.get());
    ControlSignal controls(m.get(), d.get(), options, 1);
    state.ResumeTiming();
    for (int i = 0; i < kSteps; i++) {
      controls.apply(m.get(), d.get(), i);
      mj_step(m.get(), d.get());
    }
  }
  const auto steps = static_cast<double>(state.iterations() * kSteps);
  state.counters["step"] =
      benchmark::Counter(steps, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["realtime"] = benchmark::Counter(steps / rate, benchmark::Counter::kIsRate);
  const std::string warning = firstWarning(d.get());
  if (!warning.empty()) state.SkipWithError(warning.c_str());
}

BENCHMARK_CAPTURE(step, human_600hz_falling, "human.xml", 600, 0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(step, human_600hz_fallen, "human.xml", 600, 2)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(step, human_200hz_falling, "human.xml", 200, 0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(step, human_200hz_fallen, "human.xml", 200, 2)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(step, fixed_600hz_falling, "human_fixed.xml", 600, 0)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(step, fixed_600hz_fallen, "human_fixed.xml", 600, 2)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace torso::tools

int main(int argc, char** argv) {
  torso::tools::installHandlers();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  try {
    benchmark::RunSpecifiedBenchmarks();
  } catch (const std::exception& e) {
    std::cerr << "step_benchmark: " << e.what() << '\n';
    return 1;
  }
  benchmark::Shutdown();
}
