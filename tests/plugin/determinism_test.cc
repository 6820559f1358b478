// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Same state in, same bits out.

#include <gtest/gtest.h>

#include <thread>

#include "tests/plugin/fixture.h"

namespace torso {
namespace {

class DeterminismTest : public PluginTest {
 protected:
  // A body in mid-fall: every part of the state differs from rest.
  DataPtr busyData(const mjModel* m, int steps) const {
    DataPtr d = makeData(m);
    randomControls(m, d.get(), 0.5, 1);
    for (int i = 0; i < steps; i++) mj_step(m, d.get());
    return d;
  }
};

TEST_F(DeterminismTest, OneStepTwiceFromCopies) {
  const ModelPtr m = loadModel("human.xml");
  const DataPtr d = busyData(m.get(), 100);
  const DataPtr one = copyData(m.get(), d.get()), two = copyData(m.get(), d.get());
  EXPECT_EQ(differences(m.get(), one.get(), d.get()), "");
  mj_step(m.get(), one.get());
  mj_step(m.get(), two.get());
  EXPECT_EQ(differences(m.get(), one.get(), two.get()), "");
  EXPECT_NE(differences(m.get(), one.get(), d.get()), "") << "the step did something";
}

TEST_F(DeterminismTest, CopyMadeMidRunContinues) {
  const ModelPtr m = loadModel("human.xml");
  const DataPtr d = busyData(m.get(), 100);
  const DataPtr copy = copyData(m.get(), d.get());
  for (int i = 0; i < 100; i++) mj_step(m.get(), d.get());
  for (int i = 0; i < 100; i++) mj_step(m.get(), copy.get());
  EXPECT_EQ(differences(m.get(), d.get(), copy.get()), "");
}

// A copy made between mj_step1 and mj_step2 holds the shapes of a half-done step.
TEST_F(DeterminismTest, CopyMadeMidStepContinues) {
  const ModelPtr m = loadModel("torso.xml");
  const DataPtr d = busyData(m.get(), 50);
  mj_step1(m.get(), d.get());
  const DataPtr copy = copyData(m.get(), d.get());
  for (mjData* x : {d.get(), copy.get()}) {
    mj_step2(m.get(), x);
    for (int i = 0; i < 20; i++) mj_step(m.get(), x);
  }
  EXPECT_EQ(differences(m.get(), d.get(), copy.get()), "");
}

TEST_F(DeterminismTest, ResetIsANewStart) {
  const ModelPtr m = loadModel("torso.xml");
  const DataPtr used = busyData(m.get(), 50);
  mj_resetData(m.get(), used.get());
  randomControls(m.get(), used.get(), 0.5, 1);
  for (int i = 0; i < 50; i++) mj_step(m.get(), used.get());
  const DataPtr fresh = busyData(m.get(), 50);
  EXPECT_EQ(differences(m.get(), used.get(), fresh.get()), "");
}

TEST_F(DeterminismTest, TorsoResetPutsDiscsBackToRest) {
  const ModelPtr m = loadModel("torso.xml");
  const DataPtr d = busyData(m.get(), 50);
  torso_reset(m.get(), d.get());
  for (int i = 0; i < m->nuserdata; i++) ASSERT_EQ(d->userdata[i], 0);
  mj_resetData(m.get(), d.get());
  const DataPtr fresh = makeData(m.get());
  mj_step(m.get(), d.get());
  mj_step(m.get(), fresh.get());
  EXPECT_EQ(differences(m.get(), d.get(), fresh.get()), "");
}

// mj_forward on the same state. MuJoCo itself moves two things at each call: quaternions are
// normalised anew, which may turn their last bit, and the solver's warm start goes to the solution.
// So qpos is put back and the warm start is off.
void forwardAgain(const mjModel* m, mjData* d) {
  const std::vector<mjtNum> qpos(d->qpos, d->qpos + m->nq);
  mj_forward(m, d);
  std::copy(qpos.begin(), qpos.end(), d->qpos);
}

TEST_F(DeterminismTest, ForwardRepeated) {
  const ModelPtr m = loadModel("human.xml");
  m->opt.disableflags |= mjDSBL_WARMSTART;
  const DataPtr d = busyData(m.get(), 100);
  forwardAgain(m.get(), d.get());
  const DataPtr first = copyData(m.get(), d.get());
  for (int i = 0; i < 3; i++) forwardAgain(m.get(), d.get());
  EXPECT_EQ(differences(m.get(), d.get(), first.get()), "");
}

// Extra evaluations between steps, as a viewer or an optimiser makes them, leave no trace.
TEST_F(DeterminismTest, ForwardBetweenStepsLeavesNoTrace) {
  const ModelPtr m = loadModel("torso.xml");
  m->opt.disableflags |= mjDSBL_WARMSTART;
  const DataPtr plain = busyData(m.get(), 50);
  const DataPtr disturbed = copyData(m.get(), plain.get());
  for (int i = 0; i < 20; i++) {
    forwardAgain(m.get(), disturbed.get());
    mj_step(m.get(), disturbed.get());
    mj_step(m.get(), plain.get());
  }
  EXPECT_EQ(differences(m.get(), plain.get(), disturbed.get()), "");
}

TEST_F(DeterminismTest, OneAndFourThreads) {
  const ModelPtr m = loadModel("human.xml");
  constexpr int kRuns = 4, kSteps = 100;
  const auto run = [&](int seed) {
    DataPtr d = makeData(m.get());
    randomControls(m.get(), d.get(), 0.5, seed);
    for (int i = 0; i < kSteps; i++) mj_step(m.get(), d.get());
    return d;
  };
  DataPtr alone[kRuns], together[kRuns];
  for (int i = 0; i < kRuns; i++) alone[i] = run(i);
  std::vector<std::thread> threads;
  for (int i = 0; i < kRuns; i++) threads.emplace_back([&, i] { together[i] = run(i); });
  for (std::thread& t : threads) t.join();
  for (int i = 0; i < kRuns; i++) {
    EXPECT_EQ(differences(m.get(), alone[i].get(), together[i].get()), "") << "run " << i;
  }
  EXPECT_NE(differences(m.get(), alone[0].get(), alone[1].get()), "") << "runs differ";
}

}  // namespace
}  // namespace torso
