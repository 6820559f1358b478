// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Threads that meet a model at the same moment; worth most under ThreadSanitizer.

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <thread>

#include "tests/plugin/fixture.h"

namespace torso {
namespace {

class ThreadTest : public PluginTest {
 protected:
  // Runs the same work on all threads, which start together.
  static void together(int count, const std::function<void(int)>& work) {
    std::atomic<int> waiting{count};
    std::vector<std::thread> threads;
    for (int i = 0; i < count; i++) {
      threads.emplace_back([&, i] {
        waiting--;
        while (waiting > 0) std::this_thread::yield();
        work(i);
      });
    }
    for (std::thread& t : threads) t.join();
  }
};

TEST_F(ThreadTest, FirstCallsRaceForOneModel) {
  const ModelPtr m = loadModel("torso.xml");
  torso_uninstall();  // forgets the instance that loading made
  torso_install();
  constexpr int kThreads = 2;
  DataPtr d[kThreads];
  for (DataPtr& x : d) x = makeData(m.get());
  together(kThreads, [&](int i) {
    for (int step = 0; step < 10; step++) mj_step(m.get(), d[i].get());
  });
  EXPECT_EQ(differences(m.get(), d[0].get(), d[1].get()), "");
  EXPECT_GT(torso_discPressure(m.get(), d[0].get(), 0), 0);
}

TEST_F(ThreadTest, FirstCallsRaceForTwoModels) {
  const ModelPtr m[2] = {loadModel("torso.xml"), loadModel("human.xml")};
  torso_uninstall();
  torso_install();
  together(4, [&](int i) {
    const mjModel* model = m[i / 2].get();
    const DataPtr d = makeData(model);
    mj_step(model, d.get());
    torsoInfo info;
    ASSERT_EQ(torso_info(model, &info, nullptr, 0), 1);
    EXPECT_EQ(info.ndisc, 23);
  });
}

TEST_F(ThreadTest, LastErrorBelongsToItsThread) {
  const ModelPtr m = loadModel("torso.xml");
  together(2, [&](int i) {
    for (int k = 0; k < 1000; k++) {
      EXPECT_EQ(torso_discName(m.get(), 100 + i), nullptr);
      char error[100];
      torso_lastError(error, sizeof error);
      ASSERT_EQ(error, "disc " + std::to_string(100 + i) + " does not exist, there are 23");
    }
  });
}

}  // namespace
}  // namespace torso
