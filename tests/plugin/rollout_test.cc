// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// torso_rollout against loops of mj_step written out here.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/plugin/fixture.h"

namespace torso {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;

// A passive double pendulum with a motor and a filtered actuator, that is with act, and a mocap
// body.
const char kPendulum[] = R"(
<mujoco>
  <size nuserdata="3"/>
  <worldbody>
    <body name="hand" mocap="true" pos="0 0 2"/>
    <body pos="0 0 1"><joint name="a" axis="0 1 0"/><geom size=".05" pos="0 0 -.3"/>
      <body pos="0 0 -.5"><joint name="b" axis="0 1 0"/><geom size=".05" pos="0 0 -.3"/>
        <site name="tip" pos="0 0 -.3"/></body></body>
  </worldbody>
  <actuator>
    <motor joint="a"/>
    <general joint="b" dyntype="filter" dynprm="0.1"/>
  </actuator>
  <sensor><accelerometer site="tip"/><framepos objtype="xbody" objname="hand"/></sensor>
</mujoco>)";

constexpr int kRows = 3;  // trajectories

// A rollout of kRows trajectories with random controls, and its results.
struct Batch {
  torsoRollout r;
  std::vector<mjtNum> initial, control, state, sensordata, final_state, cost;
  std::vector<int> status, steps;
  int state_size, full_size;

  Batch(const mjModel* m, int nstep) {
    torso_defaultRollout(&r);
    state_size = torso_stateSize(m, TORSO_STATE_PHYSICS);
    full_size = torso_stateSize(m, TORSO_STATE_FULL);
    std::mt19937 random(5);
    std::normal_distribution<double> normal(0, 0.1);
    control.resize(kRows * nstep * m->nu);
    for (mjtNum& u : control) u = normal(random);
    const DataPtr d = makeData(m);
    for (int i = 0; i < kRows; i++) {
      for (int k = 0; k < m->nv; k++) d->qvel[k] = normal(random);
      d->time = 0.5 * i;
      initial.resize((i + 1) * full_size);
      torso_getState(m, d.get(), initial.data() + i * full_size, TORSO_STATE_FULL);
    }
    constexpr mjtNum kUntouched = -77;
    state.assign(kRows * nstep * state_size, kUntouched);
    sensordata.assign(kRows * nstep * m->nsensordata, kUntouched);
    final_state.assign(kRows * full_size, kUntouched);
    cost.assign(kRows, kUntouched);
    status.assign(kRows, -77);
    steps.assign(kRows, -77);
    r.ntrajectory = kRows;
    r.nstep = nstep;
    r.initial_state = initial.data();
    r.ninitial = kRows;
    r.control = control.data();
    r.state = state.data();
    r.sensordata = sensordata.data();
    r.final_state = final_state.data();
    r.cost = cost.data();
    r.status = status.data();
    r.steps = steps.data();
    r.step_cost = kineticCost;
  }
  Batch(const Batch&) = delete;

  static mjtNum kineticCost(const mjModel* m, mjData* d, int trajectory, int step, void*) {
    return mju_dot(d->qvel, d->qvel, m->nv) + 0.1 * trajectory + 0.01 * step;
  }

  int run(const mjModel* m, int threads) {
    std::vector<DataPtr> data;
    std::vector<mjData*> pointers;
    for (int i = 0; i < threads; i++) {
      data.push_back(makeData(m));
      // Whatever is left in the data of a thread must not matter.
      std::fill_n(data.back()->qpos, m->nq, 0.1);
      std::fill_n(data.back()->ctrl, m->nu, 0.3);
      std::fill_n(data.back()->xfrc_applied, 6 * m->nbody, 3);
      pointers.push_back(data.back().get());
    }
    return torso_rollout(m, pointers.data(), threads, &r);
  }
};

bool sameBits(const std::vector<mjtNum>& a, const std::vector<mjtNum>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(mjtNum)) == 0;
}

std::string lastError() {
  char text[500];
  torso_lastError(text, sizeof text);
  return text;
}

class RolloutTest : public PluginTest {
 protected:
  // The same by hand: fills state, sensordata, final_state and cost.
  static void expectPlainStepping(const mjModel* m, const Batch& batch) {
    const int n = batch.r.nstep;
    const DataPtr d = makeData(m);
    for (int i = 0; i < kRows; i++) {
      mj_resetData(m, d.get());
      const mjtNum* start = batch.initial.data() + i * batch.full_size;
      d->time = start[0];
      mju_copy(d->qpos, start + 1, m->nq);
      mju_copy(d->qvel, start + 1 + m->nq, m->nv);
      mju_copy(d->act, start + 1 + m->nq + m->nv, m->na);
      mju_copy(d->userdata, start + batch.state_size, m->nuserdata);
      mju_copy(d->qacc_warmstart, start + batch.state_size + m->nuserdata, m->nv);
      mjtNum cost = 0;
      std::vector<mjtNum> row;
      for (int k = 0; k < n; k++) {
        mju_copy(d->ctrl, batch.control.data() + (i * n + k) * m->nu, m->nu);
        mj_step(m, d.get());
        cost += mju_dot(d->qvel, d->qvel, m->nv) + 0.1 * i + 0.01 * k;
        row.assign(1, d->time);
        row.insert(row.end(), d->qpos, d->qpos + m->nq);
        row.insert(row.end(), d->qvel, d->qvel + m->nv);
        row.insert(row.end(), d->act, d->act + m->na);
        const int at = i * n + k;
        ASSERT_EQ(std::memcmp(row.data(), batch.state.data() + at * batch.state_size,
                              row.size() * sizeof(mjtNum)),
                  0)
            << "trajectory " << i << ", step " << k;
        ASSERT_EQ(std::memcmp(d->sensordata, batch.sensordata.data() + at * m->nsensordata,
                              m->nsensordata * sizeof(mjtNum)),
                  0)
            << "trajectory " << i << ", step " << k;
      }
      row.insert(row.end(), d->userdata, d->userdata + m->nuserdata);
      row.insert(row.end(), d->qacc_warmstart, d->qacc_warmstart + m->nv);
      ASSERT_EQ(row.size(), static_cast<std::size_t>(batch.full_size));
      EXPECT_EQ(std::memcmp(row.data(), batch.final_state.data() + i * batch.full_size,
                            row.size() * sizeof(mjtNum)),
                0);
      EXPECT_EQ(cost, batch.cost[i]);
      EXPECT_EQ(batch.status[i], TORSO_OK);
      EXPECT_EQ(batch.steps[i], n);
    }
  }

  static void expectSame(const Batch& a, const Batch& b) {
    EXPECT_TRUE(sameBits(a.state, b.state));
    EXPECT_TRUE(sameBits(a.sensordata, b.sensordata));
    EXPECT_TRUE(sameBits(a.final_state, b.final_state));
    EXPECT_TRUE(sameBits(a.cost, b.cost));
    EXPECT_EQ(a.status, b.status);
    EXPECT_EQ(a.steps, b.steps);
  }
};

TEST_F(RolloutTest, IsPlainSteppingForAnyNumberOfThreads) {
  for (const bool torso : {false, true}) {
    const ModelPtr m = torso ? loadModel("torso.xml") : loadText(kPendulum);
    const int steps = torso ? 6 : 200;
    Batch one(m.get(), steps), two(m.get(), steps), three(m.get(), steps), many(m.get(), steps);
    ASSERT_EQ(one.run(m.get(), 1), 0) << lastError();
    ASSERT_EQ(two.run(m.get(), 2), 0) << lastError();
    ASSERT_EQ(three.run(m.get(), 3), 0) << lastError();
    ASSERT_EQ(many.run(m.get(), kRows + 2), 0) << lastError();
    expectPlainStepping(m.get(), one);
    expectSame(one, two);
    expectSame(one, three);
    expectSame(one, many);
  }
}

TEST_F(RolloutTest, RungeKuttaAndReusedDataAreNoDifferent) {
  const ModelPtr m = loadText(kPendulum);
  m->opt.integrator = mjINT_RK4;
  Batch batch(m.get(), 50);
  const DataPtr d = makeData(m.get());
  mjData* data = d.get();
  for (int repetition = 0; repetition < 2; repetition++) {
    ASSERT_EQ(torso_rollout(m.get(), &data, 1, &batch.r), 0);
    expectPlainStepping(m.get(), batch);
  }
}

// Half a rollout and another from where it ended are one whole rollout.
TEST_F(RolloutTest, ContinuedFromTheFinalStateIsOneLongRollout) {
  for (const bool torso : {false, true}) {
    const ModelPtr m = torso ? loadModel("torso.xml") : loadText(kPendulum);
    const int half = torso ? 4 : 100;
    Batch whole(m.get(), 2 * half), first(m.get(), half), second(m.get(), half);
    const int row = half * m->nu;
    for (int i = 0; i < kRows; i++) {
      const mjtNum* u = whole.control.data() + 2 * i * row;
      std::copy(u, u + row, first.control.data() + i * row);
      std::copy(u + row, u + 2 * row, second.control.data() + i * row);
    }
    ASSERT_EQ(whole.run(m.get(), 2), 0);
    first.initial = whole.initial;
    ASSERT_EQ(first.run(m.get(), 1), 0);
    second.r.initial_state = first.final_state.data();
    ASSERT_EQ(second.run(m.get(), 2), 0);
    EXPECT_TRUE(sameBits(whole.final_state, second.final_state));
    // The parts beyond the physics matter: without them the bits differ.
    if (!torso) continue;
    std::vector<mjtNum> physics(kRows * first.state_size);
    for (int i = 0; i < kRows; i++) {
      mju_copy(physics.data() + i * first.state_size,
               first.final_state.data() + i * first.full_size, first.state_size);
    }
    Batch other(m.get(), half);
    other.control = second.control;
    other.r.initial_state = physics.data();
    other.r.initial_spec = TORSO_STATE_PHYSICS;
    ASSERT_EQ(other.run(m.get(), 2), 0);
    EXPECT_FALSE(sameBits(other.state, second.state));
  }
}

TEST_F(RolloutTest, OneInitialStateIsForAll) {
  const ModelPtr m = loadText(kPendulum);
  Batch each(m.get(), 20), shared(m.get(), 20);
  for (int i = 0; i < kRows; i++) {
    mju_copy(each.initial.data() + i * each.full_size, shared.initial.data(), each.full_size);
  }
  shared.r.ninitial = 1;
  ASSERT_EQ(each.run(m.get(), 2), 0);
  ASSERT_EQ(shared.run(m.get(), 2), 0);
  expectSame(each, shared);
}

TEST_F(RolloutTest, WithoutInputsTheModelStartsAtRestAndItsControlsAreZero) {
  const ModelPtr m = loadText(kPendulum);
  Batch batch(m.get(), 20);
  batch.r.initial_state = nullptr;
  batch.r.control = nullptr;
  ASSERT_EQ(batch.run(m.get(), 2), 0);
  const DataPtr d = makeData(m.get());
  for (int k = 0; k < 20; k++) mj_step(m.get(), d.get());
  for (int i = 0; i < kRows; i++) {
    const mjtNum* end = batch.final_state.data() + i * batch.full_size;
    EXPECT_EQ(end[0], d->time);
    EXPECT_EQ(std::memcmp(end + 1, d->qpos, m->nq * sizeof(mjtNum)), 0);
  }
}

TEST_F(RolloutTest, ADivergingTrajectoryLeavesTheOthersAlone) {
  const ModelPtr m = loadModel("torso.xml");
  Batch sound(m.get(), 6), batch(m.get(), 6);
  batch.control[(1 * 6 + 3) * m->nu + 7] = std::numeric_limits<double>::quiet_NaN();
  ASSERT_EQ(sound.run(m.get(), 2), 0);
  ASSERT_EQ(batch.run(m.get(), 2), 1);
  EXPECT_EQ(batch.status, (std::vector<int>{TORSO_OK, TORSO_WARNING + mjWARN_BADCTRL, TORSO_OK}));
  EXPECT_EQ(batch.steps, (std::vector<int>{6, 3, 6}));
  EXPECT_STREQ(torso_statusText(batch.status[1]), "a number in ctrl is not finite, or huge");
  EXPECT_THAT(takeWarnings(), HasSubstr("CTRL"));
  const auto rows = [&](const std::vector<mjtNum>& all, int trajectory, int from, int to) {
    const int width = static_cast<int>(all.size()) / (kRows * 6);
    const auto begin = all.begin() + trajectory * 6 * width;
    return std::vector<mjtNum>(begin + from * width, begin + to * width);
  };
  for (int i = 0; i < kRows; i++) {
    const int end = i == 1 ? 3 : 6;
    EXPECT_TRUE(sameBits(rows(batch.state, i, 0, end), rows(sound.state, i, 0, end)));
    EXPECT_TRUE(sameBits(rows(batch.sensordata, i, 0, end), rows(sound.sensordata, i, 0, end)));
    EXPECT_THAT(rows(batch.state, i, end, 6), Each(-77));
    EXPECT_THAT(rows(batch.sensordata, i, end, 6), Each(-77));
  }
}

TEST_F(RolloutTest, NumbersThatAreNotFiniteAreFoundAtTheirStep) {
  const ModelPtr m = loadText(kPendulum);
  Batch batch(m.get(), 4);
  batch.initial[1 * batch.full_size + 1] = std::nan("");  // qpos[0] of the second
  batch.control[(2 * 4 + 3) * m->nu] = 1e9;               // in the last step of the third
  // On one thread: MuJoCo writes the text of its warnings into a buffer that threads share.
  EXPECT_EQ(batch.run(m.get(), 1), 2);
  EXPECT_EQ(batch.status[1], TORSO_WARNING + mjWARN_BADQPOS);
  EXPECT_EQ(batch.steps[1], 0);
  EXPECT_EQ(batch.status[2], TORSO_WARNING + mjWARN_BADQACC);
  EXPECT_EQ(batch.steps[2], 3);
  takeWarnings();
  // Below MuJoCo's limit for qacc, beyond its limit for qvel once integrated: no step would warn.
  m->opt.timestep = 100;
  m->opt.disableflags |= mjDSBL_GRAVITY;
  Batch last(m.get(), 1);
  mju_zero(last.control.data(), kRows * m->nu);
  last.control[0] = 5e7;
  EXPECT_EQ(last.run(m.get(), 1), 1);
  EXPECT_EQ(last.status[0], TORSO_NOT_FINITE);
  EXPECT_EQ(last.steps[0], 0);
  EXPECT_EQ(last.final_state[0], -77);
}

TEST_F(RolloutTest, ACancelledRolloutHasWholeTrajectoriesOnly) {
  const ModelPtr m = loadText(kPendulum);
  Batch whole(m.get(), 20), batch(m.get(), 20);
  ASSERT_EQ(whole.run(m.get(), 1), 0);
  static int cancel;
  cancel = 0;
  batch.r.cancel = &cancel;
  batch.r.step_cost = [](const mjModel* model, mjData* d, int i, int k, void* user) {
    if (i == 1 && k == 4) __atomic_store_n(&cancel, 1, __ATOMIC_RELAXED);
    return Batch::kineticCost(model, d, i, k, user);
  };
  EXPECT_EQ(batch.run(m.get(), 1), 2);
  EXPECT_EQ(batch.status, (std::vector<int>{TORSO_OK, TORSO_CANCELLED, TORSO_CANCELLED}));
  EXPECT_EQ(batch.steps, (std::vector<int>{20, 5, 0}));
  const int row = 20 * batch.state_size;
  EXPECT_EQ(std::memcmp(batch.state.data(), whole.state.data(),
                        (row + 5 * batch.state_size) * sizeof(mjtNum)),
            0);
  EXPECT_EQ(batch.state[row + 5 * batch.state_size], -77);
  EXPECT_EQ(batch.cost[0], whole.cost[0]);
  EXPECT_EQ(batch.final_state[batch.full_size], -77) << "that is for whole trajectories";

  // On two threads: which trajectories are done depends on the race, what is done does not.
  cancel = 0;
  Batch race(m.get(), 20);
  race.r.cancel = &cancel;
  race.r.step_cost = batch.r.step_cost;
  EXPECT_GT(race.run(m.get(), 2), 0);
  for (int i = 0; i < kRows; i++) {
    EXPECT_EQ(race.status[i] == TORSO_OK, race.steps[i] == 20);
    EXPECT_TRUE(race.status[i] == TORSO_OK || race.status[i] == TORSO_CANCELLED);
    EXPECT_EQ(std::memcmp(race.state.data() + i * row, whole.state.data() + i * row,
                          race.steps[i] * race.state_size * sizeof(mjtNum)),
              0);
  }
}

TEST_F(RolloutTest, InputCallbackClosesTheLoop) {
  const ModelPtr m = loadText(kPendulum);
  Batch batch(m.get(), 100);
  mjtNum gain = 2;
  batch.r.user = &gain;
  batch.r.input = [](const mjModel*, mjData* d, int, int step, void* user) {
    d->ctrl[0] -= *static_cast<mjtNum*>(user) * d->qpos[0];
    d->mocap_pos[2] = 2 + 0.01 * step;
  };
  ASSERT_EQ(batch.run(m.get(), 2), 0);
  const DataPtr d = makeData(m.get());
  const int i = 1;
  torso_setState(m.get(), d.get(), batch.initial.data() + i * batch.full_size, TORSO_STATE_FULL);
  for (int k = 0; k < 100; k++) {
    mju_copy(d->ctrl, batch.control.data() + (i * 100 + k) * m->nu, m->nu);
    d->ctrl[0] -= 2 * d->qpos[0];
    mj_step(m.get(), d.get());
  }
  EXPECT_EQ(batch.final_state[i * batch.full_size + 1], d->qpos[0]);
  EXPECT_EQ(batch.sensordata[((i + 1) * 100 - 1) * m->nsensordata + 5], 2 + 0.01 * 99);
}

TEST_F(RolloutTest, AnExceptionEndsItsTrajectoryOnly) {
  const ModelPtr m = loadText(kPendulum);
  Batch batch(m.get(), 10);
  batch.r.input = [](const mjModel*, mjData*, int trajectory, int step, void*) {
    if (trajectory == 0 && step == 5) throw std::runtime_error("test");
  };
  EXPECT_EQ(batch.run(m.get(), 2), 1);
  EXPECT_EQ(batch.status, (std::vector<int>{TORSO_ERROR, TORSO_OK, TORSO_OK}));
  EXPECT_EQ(batch.steps, (std::vector<int>{5, 10, 10}));
}

TEST_F(RolloutTest, AnyResultMayBeLeftOut) {
  const ModelPtr m = loadText(kPendulum);
  Batch all(m.get(), 10);
  ASSERT_EQ(all.run(m.get(), 1), 0);
  const auto without = [&](const auto& leaveOut) {
    Batch batch(m.get(), 10);
    leaveOut(batch.r);
    EXPECT_EQ(batch.run(m.get(), 2), 0);
    int same = sameBits(batch.state, all.state) + sameBits(batch.sensordata, all.sensordata) +
               sameBits(batch.final_state, all.final_state) + sameBits(batch.cost, all.cost) +
               (batch.status == all.status) + (batch.steps == all.steps);
    return same;
  };
  EXPECT_EQ(without([](torsoRollout& r) { r.state = nullptr; }), 5);
  EXPECT_EQ(without([](torsoRollout& r) { r.sensordata = nullptr; }), 5);
  EXPECT_EQ(without([](torsoRollout& r) { r.final_state = nullptr; }), 5);
  EXPECT_EQ(without([](torsoRollout& r) { r.cost = nullptr; }), 5);
  EXPECT_EQ(without([](torsoRollout& r) { r.status = nullptr; }), 5);
  EXPECT_EQ(without([](torsoRollout& r) { r.steps = nullptr; }), 5);
  EXPECT_EQ(without([](torsoRollout& r) {
              r.state = r.sensordata = r.final_state = r.cost = nullptr;
              r.status = r.steps = nullptr;
            }),
            0);
}

TEST_F(RolloutTest, PartsOfTheStateStandInTheirOrder) {
  const ModelPtr m = loadText(kPendulum);
  EXPECT_EQ(torso_stateSize(m.get(), TORSO_STATE_PHYSICS), 1 + 2 + 2 + 1);
  EXPECT_EQ(torso_stateSize(m.get(), TORSO_STATE_USERDATA), 3);
  EXPECT_EQ(torso_stateSize(m.get(), TORSO_STATE_WARMSTART), 2);
  EXPECT_EQ(torso_stateSize(m.get(), TORSO_STATE_FULL), 11);
  std::vector<mjtNum> in = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}, out(11), part(5);
  const DataPtr d = makeData(m.get());
  ASSERT_EQ(torso_setState(m.get(), d.get(), in.data(), TORSO_STATE_FULL), 0);
  EXPECT_EQ(d->time, 1);
  EXPECT_EQ(d->qpos[1], 3);
  EXPECT_EQ(d->qvel[0], 4);
  EXPECT_EQ(d->act[0], 6);
  EXPECT_EQ(d->userdata[2], 9);
  EXPECT_EQ(d->qacc_warmstart[1], 11);
  ASSERT_EQ(torso_getState(m.get(), d.get(), out.data(), TORSO_STATE_FULL), 0);
  EXPECT_EQ(in, out);
  torso_getState(m.get(), d.get(), part.data(), TORSO_STATE_USERDATA | TORSO_STATE_WARMSTART);
  EXPECT_EQ(part, (std::vector<mjtNum>{7, 8, 9, 10, 11}));
  EXPECT_EQ(torso_stateSize(m.get(), 8), -1);
  EXPECT_EQ(torso_getState(m.get(), nullptr, out.data(), TORSO_STATE_FULL), -1);
  EXPECT_EQ(lastError(), "the data are null");
  EXPECT_EQ(torso_setState(m.get(), d.get(), nullptr, TORSO_STATE_FULL), -1);
  EXPECT_EQ(lastError(), "the state is null");
  EXPECT_EQ(torso_setState(m.get(), d.get(), in.data(), 0), -1);
  EXPECT_THAT(lastError(), HasSubstr("spec is 0, it must be an or of TORSO_STATE_PHYSICS"));
}

TEST_F(RolloutTest, WrongArgumentsAreNamedAndNothingIsDone) {
  const ModelPtr m = loadText(kPendulum), other = loadModel("torso.xml");
  const DataPtr d = makeData(m.get()), second = makeData(m.get()), of_other = makeData(other.get());
  const auto refused = [&](const auto& change, std::vector<mjData*> data, int threads = 1,
                           const mjModel* model = nullptr) {
    Batch batch(m.get(), 5);
    change(batch.r);
    EXPECT_EQ(torso_rollout(model ? model : m.get(), data.data(), threads, &batch.r), -1);
    EXPECT_THAT(batch.state, Each(-77));
    EXPECT_THAT(batch.status, Each(-77));
    return lastError();
  };
  mjData* const p = d.get();
  const auto none = [](torsoRollout&) {};
  EXPECT_EQ(torso_rollout(nullptr, &p, 1, nullptr), -1);
  EXPECT_EQ(lastError(), "the model is null");
  EXPECT_EQ(torso_rollout(m.get(), &p, 1, nullptr), -1);
  EXPECT_EQ(lastError(), "the rollout is null");
  EXPECT_EQ(refused([](torsoRollout& r) { r.nstep = -1; }, {p}),
            "ntrajectory is 3 and nstep -1, neither may be negative");
  EXPECT_EQ(refused([](torsoRollout& r) { r.ntrajectory = -2; }, {p}),
            "ntrajectory is -2 and nstep 5, neither may be negative");
  EXPECT_EQ(refused(none, {p}, 0), "nthread is 0, it must be at least 1");
  EXPECT_EQ(refused(none, {}), "the data are null; give an array of nthread pointers");
  EXPECT_EQ(refused(none, {p, nullptr}, 2),
            "data 1 is null; give one mjData for each of the threads");
  EXPECT_EQ(refused(none, {p, second.get(), p}, 3),
            "data 2 is given twice; each thread needs an mjData of its own");
  EXPECT_EQ(refused(none, {of_other.get()}),
            "data 0 belongs to another model; make it with mj_makeData of this one");
  EXPECT_EQ(refused([](torsoRollout& r) { r.ninitial = 2; }, {p}),
            "ninitial is 2, it must be 1 or ntrajectory, which is 3");
  EXPECT_THAT(refused([](torsoRollout& r) { r.initial_spec = 0; }, {p}),
              HasSubstr("initial_spec is 0"));
  EXPECT_THAT(refused([](torsoRollout& r) { r.state_spec = 9; }, {p}),
              HasSubstr("state_spec is 9"));
  EXPECT_EQ(refused([](torsoRollout& r) { r.step_cost = nullptr; }, {p}),
            "cost is wanted, but step_cost is null");

  // A torso that is damaged after it was loaded.
  const int numeric = mj_name2id(other.get(), mjOBJ_NUMERIC, "mujoco_torso");
  other->numeric_data[other->numeric_adr[numeric]] = 99;
  torso_uninstall();
  torso_install();
  EXPECT_THAT(refused(none, {of_other.get()}, 1, other.get()), HasSubstr("format 99 is not known"));
}

TEST_F(RolloutTest, NothingToDoIsNoError) {
  const ModelPtr m = loadText(kPendulum);
  const DataPtr d = makeData(m.get());
  mjData* const data = d.get();
  torsoRollout r;
  torso_defaultRollout(&r);
  EXPECT_EQ(torso_rollout(m.get(), &data, 1, &r), 0);
  r.ntrajectory = 2;
  int status[2] = {-77, -77};
  r.status = status;
  EXPECT_EQ(torso_rollout(m.get(), &data, 1, &r), 0);
  EXPECT_EQ(status[1], TORSO_OK);
}

}  // namespace
}  // namespace torso
