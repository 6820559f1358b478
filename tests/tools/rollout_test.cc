// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/rollout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "tests/tools/model_from_text.h"
#include "tools/mujoco_support.h"

namespace torso::tools {
namespace {

const char kHumanoid[] = "/usr/share/mujoco/model/humanoid/humanoid.xml";

const std::atomic<bool> kGoOn = false;

TEST(LengthHistogram, QuantilesAreThoseOfTheSortedSamples) {
  std::mt19937 random(1);
  std::lognormal_distribution<double> length(std::log(1e-3), 1.5);
  LengthHistogram one, other;
  std::vector<double> samples;
  for (int i = 0; i < 20000; i++) {
    samples.push_back(length(random));
    (i % 3 ? one : other).add(samples.back());
  }
  one.merge(other);
  std::sort(samples.begin(), samples.end());
  EXPECT_EQ(one.total(), 20000);
  for (double p : {0.01, 0.5, 0.99, 1.0}) {
    const double exact = samples[static_cast<std::size_t>(std::ceil(p * 20000)) - 1];
    EXPECT_NEAR(one.quantile(p) / exact, 1, 0.005) << p;
  }
  EXPECT_EQ(LengthHistogram().quantile(0.99), 0);
}

TEST(ControlSignal, StaysInTheScaledRangeMovesSmoothlyAndReachesMostOfIt) {
  const ModelPtr m = modelFromText(
      "<option timestep='0.002'/><worldbody><body><joint name='j'/>"
      "<geom size='1'/></body></worldbody><actuator>"
      "<motor joint='j' ctrllimited='true' ctrlrange='-1 3'/>"
      "<motor joint='j' ctrllimited='true' ctrlrange='2 3'/>"
      "<motor joint='j'/></actuator>");
  const DataPtr d = makeData(m.get());
  RolloutOptions options;
  options.control = Control::kRandom;
  options.amplitude = 0.8;
  startRun(m.get(), d.get(), options);
  ControlSignal controls(m.get(), d.get(), options, 42);
  const double low[3] = {-0.8, 2, -0.8}, high[3] = {2.4, 2.8, 0.8};
  std::vector<double> smallest(3, 1e9), largest(3, -1e9), before(3, 0);
  for (int step = 0; step < 10000; step++) {
    controls.apply(m.get(), d.get(), step);
    for (int i = 0; i < 3; i++) {
      // The first 0.1 s lead from rest into the range; a smooth step's slope is at most 1.5 times
      // the straight one's.
      EXPECT_LE(std::abs(d->ctrl[i] - before[i]), 1.5 * 3.2 * 0.002 / 0.1 + 1e-12);
      before[i] = d->ctrl[i];
      if (step < 50) continue;
      smallest[i] = std::min(smallest[i], d->ctrl[i]);
      largest[i] = std::max(largest[i], d->ctrl[i]);
    }
  }
  for (int i = 0; i < 3; i++) {
    EXPECT_GE(smallest[i], low[i] - 1e-12);
    EXPECT_LE(largest[i], high[i] + 1e-12);
    EXPECT_GT(largest[i] - smallest[i], 0.9 * (high[i] - low[i]));
  }
}

TEST(StartRun, LiftsEveryFreeBody) {
  const ModelPtr m = modelFromText(
      "<worldbody><body pos='0 0 1'><freejoint/><geom size='.1'/><body pos='0 0 .3'>"
      "<joint type='slide' axis='0 0 1'/><geom size='.1'/></body></body>"
      "<body pos='1 0 2'><freejoint/><geom size='.1'/></body></worldbody>");
  const DataPtr d = makeData(m.get());
  RolloutOptions options;
  options.lift = 0.75;
  startRun(m.get(), d.get(), options);
  mj_kinematics(m.get(), d.get());
  EXPECT_NEAR(d->xpos[3 * 1 + 2], 1.75, 1e-12);
  EXPECT_NEAR(d->xpos[3 * 2 + 2], 2.05, 1e-12);
  EXPECT_NEAR(d->xpos[3 * 3 + 2], 2.75, 1e-12);
}

TEST(Rollout, ObserversDoNotChangeTheBits) {
  const ModelPtr m = loadModel(kHumanoid);
  RolloutOptions options;
  options.seconds = 1;
  options.seeds = 2;
  options.control = Control::kRandom;
  const RolloutSummary plain = rollout(m.get(), options, {}, nullptr, kGoOn);
  std::vector<double> times;
  const RolloutSummary watched = rollout(
      m.get(), options, {{100, [&](const mjModel*, const mjData* d) { times.push_back(d->time); }}},
      nullptr, kGoOn);
  EXPECT_EQ(plain.state_hash, watched.state_hash);
  ASSERT_EQ(times.size(), 101u);
  for (int i = 0; i < 101; i++) EXPECT_NEAR(times[i], 0.01 * i, 1e-9);
}

// The loop of the library against one written out here.
TEST(Rollout, IsPlainSteppingFromTheStart) {
  const ModelPtr m = loadModel(kHumanoid);
  RolloutOptions options;
  options.seconds = 0.5;
  options.lift = 0.3;
  const DataPtr d = makeData(m.get());
  d->qpos[2] += 0.3;
  for (int i = 0; i < 100; i++) mj_step(m.get(), d.get());
  std::vector<mjtNum> qpos;
  rollout(m.get(), options,
          {{2, [&](const mjModel* model,
                   const mjData* data) { qpos.assign(data->qpos, data->qpos + model->nq); }}},
          nullptr, kGoOn);
  EXPECT_EQ(qpos, std::vector<mjtNum>(d->qpos, d->qpos + m->nq));
}

// The two ways to roll out, on the same controls.
TEST(Rollout, AgreesWithThePluginsRolloutBitForBit) {
  const ModelPtr m = loadModel(kHumanoid);
  RolloutOptions options;
  options.seconds = 0.5;
  options.seeds = 3;
  options.threads = 2;
  options.lift = 0.3;
  options.control = Control::kRandom;
  const RolloutSummary summary = rollout(m.get(), options, {}, nullptr, kGoOn);

  constexpr int kSteps = 100;
  const DataPtr d = makeData(m.get()), second = makeData(m.get());
  startRun(m.get(), d.get(), options);
  const int full = torso_stateSize(m.get(), TORSO_STATE_FULL);
  const int physics = torso_stateSize(m.get(), TORSO_STATE_PHYSICS);
  std::vector<mjtNum> start(full), control, end(3 * full);
  torso_getState(m.get(), d.get(), start.data(), TORSO_STATE_FULL);
  for (int seed = 0; seed < 3; seed++) {
    startRun(m.get(), d.get(), options);
    ControlSignal signal(m.get(), d.get(), options, seed);
    for (int step = 0; step < kSteps; step++) {
      signal.apply(m.get(), d.get(), step);
      control.insert(control.end(), d->ctrl, d->ctrl + m->nu);
    }
  }
  torsoRollout r;
  torso_defaultRollout(&r);
  r.ntrajectory = 3;
  r.nstep = kSteps;
  r.initial_state = start.data();
  r.ninitial = 1;
  r.control = control.data();
  r.final_state = end.data();
  mjData* const data[] = {d.get(), second.get()};
  ASSERT_EQ(torso_rollout(m.get(), data, 2, &r), 0);
  ASSERT_EQ(summary.runs.size(), 3u);
  for (int i = 0; i < 3; i++) {
    // FNV-1a of qpos, qvel, act and userdata, which follow the time.
    std::uint64_t hash = 0xcbf29ce484222325;
    const auto* bytes = reinterpret_cast<const unsigned char*>(&end[i * full + 1]);
    const std::size_t size = (physics - 1 + m->nuserdata) * sizeof(mjtNum);
    for (std::size_t k = 0; k < size; k++) hash = (hash ^ bytes[k]) * 0x100000001b3;
    EXPECT_EQ(summary.runs[i].state_hash, hash) << "seed " << i;
  }
}

// A pendulum on a string that is 1 cm shorter than the bob is far: the first violation is known.
TEST(Rollout, MeasuresHowFarATendonIsBeyondItsLimit) {
  const ModelPtr m = modelFromText(
      "<worldbody><site name='a'/><body pos='0 0 -1'><freejoint/>"
      "<geom size='.1'/><site name='b'/></body></worldbody><tendon>"
      "<spatial limited='true' range='0 0.99'><site site='a'/>"
      "<site site='b'/></spatial></tendon>");
  RolloutOptions options;
  options.seconds = m->opt.timestep;
  const RolloutSummary summary = rollout(m.get(), options, {}, nullptr, kGoOn);
  EXPECT_NEAR(summary.extremes.max_ligament_violation.value, 0.01, 1e-12);
  EXPECT_EQ(summary.extremes.max_ligament_violation.id, 0);
  EXPECT_EQ(summary.violations.ligament.total(), 1);
  EXPECT_NEAR(summary.violations.ligament.quantile(0.99), 0.01, 5e-5);
  EXPECT_EQ(summary.mean_constraints, 1);
}

TEST(Rollout, StopEndsItEarly) {
  const ModelPtr m = loadModel(kHumanoid);
  RolloutOptions options;
  options.seeds = 100000;
  std::atomic<bool> stop = false;
  const RolloutSummary summary = rollout(
      m.get(), options, {}, [&](double) { stop = true; }, stop);
  EXPECT_LT(summary.runs.size(), 100000u);
}

TEST(Handlers, AnErrorInMujocoIsAnException) {
  installHandlers();
  EXPECT_THROW(mju_error("test"), std::runtime_error);
  mju_user_error = nullptr;
  mju_user_warning = nullptr;
}

}  // namespace
}  // namespace torso::tools
