// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Cost of the disc solvers: a whole spine's 23 discs per instruction set, the parts of an
// iteration, and how many iterations the constant metric and Newton's method need.

#include <benchmark/benchmark.h>

#include <algorithm>

#include "model/disc_group.h"
#include "model/disc_reference.h"
#include "tests/model/disc_test_util.h"

namespace torso {
namespace {

using Eigen::Vector3d;

std::vector<DiscBatch::Disc> spine() {
  std::vector<DiscBatch::Disc> discs;
  for (int i = 0; i < 23; ++i) {
    const double t = i / 22.0;
    discs.push_back({makeDiscMesh({0.017 + 0.033 * t, 0.015 + 0.020 * t, 0.005 + 0.008 * t,
                                   0.0045 + 0.005 * t}),
                     kDiscMaterial});
  }
  return discs;
}

const DiscKernels* const kKernels[] = {&kDiscKernelsPortable, &kDiscKernelsAvx2,
                                       &kDiscKernelsAvx512};

// One iteration of all discs, bent by range(1) degrees about an oblique axis.
void evaluate(benchmark::State& state) {
  const DiscKernels& kernels = *kKernels[state.range(0)];
  state.SetLabel(kernels.name);
  const std::string best = DiscBatch::instructionSet();
  if (!DiscBatch::setInstructionSet(kernels.name)) {
    state.SkipWithError("not on this machine");
    return;
  }
  BatchRun run(spine());
  DiscBatch::Options options;
  options.max_iterations = 1;
  // To and fro by a 1/600 of the angle, as in a motion of 1 Hz: discs that stand still cost
  // nothing.
  int step = 0;
  const auto move = [&] {
    const double degrees = static_cast<double>(state.range(1)) * (1 + (++step % 2) / 600.0);
    const DiscPose pose = discPose(degrees * Vector3d(0.3, 1, 0.3).normalized(), {0, 0, 0});
    std::fill(run.poses.begin(), run.poses.end(), pose);
    run.evaluate(options);
  };
  for (int i = 0; i < 20; ++i) move();
  for (auto _ : state) move();
  DiscBatch::setInstructionSet(best);
}
BENCHMARK(evaluate)
    ->ArgNames({"set", "degrees"})
    ->ArgsProduct({{0, 1, 2}, {1, 3, 5, 10}})
    ->Unit(benchmark::kMicrosecond);

// The parts of an iteration, for one group of 8 discs.
enum Part { kPredict, kForces, kWrench, kSolve, kNucleus };

void part(benchmark::State& state) {
  const char* names[] = {"predict", "local step", "wrench", "solve", "nucleus"};
  const DiscKernels& kernels = *kKernels[state.range(1)];
  state.SetLabel(std::string(names[state.range(0)]) + ", " + kernels.name);
  const std::string best = DiscBatch::instructionSet();
  if (!DiscBatch::setInstructionSet(kernels.name)) {
    state.SkipWithError("not on this machine");
    return;
  }
  DiscBatch::setInstructionSet(best);
  const auto discs = spine();
  std::vector<DiscElasticity> elasticities;
  std::vector<const DiscElasticity*> elasticity_pointers;
  std::vector<const DiscMesh*> meshes;
  elasticities.reserve(kLanes);
  for (int i = 0; i < kLanes; ++i) {
    elasticities.emplace_back(discs[i].mesh, discs[i].material);
    elasticity_pointers.push_back(&elasticities.back());
    meshes.push_back(&discs[i].mesh);
  }
  const DiscGroup group(meshes, elasticity_pointers, kernels);
  const DiscGroupView& view = group.view();
  const LaneArray u(3 * view.nnode), f(3 * view.nnode), d(3 * view.nnode), change(6), out(6),
      correction(6), pressure(1), keep(1), work(group.workSize() / kLanes);
  const LaneArray old_state(2 * 3 * view.nfree);  // zeros, as many as that many doubles
  for (int i = 0; i < 3 * view.nnode; ++i) {
    for (int lane = 0; lane < kLanes; ++lane) {
      u(i, lane) = 2e-5f * static_cast<float>(i * 37 % 11 - 5);
      f(i, lane) = static_cast<float>(i * 17 % 13 - 6);
    }
  }
  for (auto _ : state) {
    switch (state.range(0)) {
      case kPredict:
        kernels.predict(view, reinterpret_cast<const double*>(old_state.data()), keep.data(),
                        change.data(), u.data());
        break;
      case kForces:
        kernels.forces(view, u.data(), f.data(), pressure.data(), work.data());
        break;
      case kWrench:
        kernels.wrench(view, u.data(), f.data(), out.data(), correction.data());
        break;
      case kSolve:
        kernels.solve(view, f.data(), d.data());
        break;
      case kNucleus:
        kernels.nucleus(view, work.data(), view.nucleus_response, d.data(), pressure.data(),
                        out.data());
        break;
    }
    benchmark::ClobberMemory();
  }
  state.counters["blocks"] = group.blocks();
}
BENCHMARK(part)
    ->ArgNames({"part", "set"})
    ->ArgsProduct({{kPredict, kForces, kWrench, kSolve, kNucleus}, {0, 1, 2}})
    ->Unit(benchmark::kMicrosecond);

// One iteration of one disc with the plain solver.
void reference(benchmark::State& state) {
  ReferenceDisc disc(makeDiscMesh(kLumbarShape), kDiscMaterial);
  const DiscPose pose = discPose({0, 3, 0}, {0, 0, 0});
  for (auto _ : state) {
    disc.reset();
    benchmark::DoNotOptimize(disc.solve(pose, 1, 0));
  }
}
BENCHMARK(reference)->Unit(benchmark::kMicrosecond);

// Flexion stiffness after so many iterations from rest at 3 degrees, as a counter [Nm/deg].
void convergence(benchmark::State& state) {
  const bool newton = state.range(0) == 1;
  state.SetLabel(newton ? "Newton" : "constant metric");
  ReferenceDisc disc(
      makeDiscMesh(kLumbarShape), kDiscMaterial,
      newton ? ReferenceDisc::Method::kNewton : ReferenceDisc::Method::kConstantMetric);
  const DiscPose pose = discPose({0, 3, 0}, {0, 0, 0});
  for (auto _ : state) {
    disc.reset();
    disc.solve(pose, static_cast<int>(state.range(1)), 1e-6);
  }
  state.counters["Nm/deg"] = -disc.wrench().moment.y() / 3;
}
BENCHMARK(convergence)
    ->ArgNames({"method", "iterations"})
    ->ArgsProduct({{0, 1}, {1, 2, 3, 10, 50, 300}})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

// Building a spine's batch.
void construction(benchmark::State& state) {
  const auto discs = spine();
  for (auto _ : state) {
    const DiscBatch batch(discs);
    benchmark::DoNotOptimize(batch.stateSize());
  }
}
BENCHMARK(construction)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace torso

BENCHMARK_MAIN();
