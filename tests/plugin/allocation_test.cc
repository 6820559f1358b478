// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// No allocation in a step. This program's malloc counts, for all libraries in it.

#include <dlfcn.h>
#include <errno.h>
#include <gtest/gtest.h>

#include <atomic>

#include "tests/plugin/fixture.h"

extern "C" {
void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);
}

namespace {
std::atomic<long> allocations{0};
void* counted(void* p) {
  allocations++;
  return p;
}
}  // namespace

extern "C" {
void* malloc(size_t size) { return counted(__libc_malloc(size)); }
void* calloc(size_t n, size_t size) { return counted(__libc_calloc(n, size)); }
void* realloc(void* p, size_t size) { return counted(__libc_realloc(p, size)); }
void* memalign(size_t alignment, size_t size) { return counted(__libc_memalign(alignment, size)); }
void* aligned_alloc(size_t alignment, size_t size) {
  return counted(__libc_memalign(alignment, size));
}
int posix_memalign(void** p, size_t alignment, size_t size) {
  *p = counted(__libc_memalign(alignment, size));
  return *p ? 0 : ENOMEM;
}
}

namespace torso {
namespace {

class AllocationTest : public PluginTest {};

TEST_F(AllocationTest, CounterSeesMujocosAndOurs) {
  const ModelPtr m = loadModel("torso.xml");
  long before = allocations;
  const DataPtr d = makeData(m.get());
  EXPECT_GT(allocations, before) << "mj_makeData allocates";
  torso_uninstall();
  torso_install();
  before = allocations;
  mj_forward(m.get(), d.get());
  EXPECT_GT(allocations, before) << "the first call builds the disc solvers";
}

TEST_F(AllocationTest, StepsAllocateNothing) {
  const ModelPtr m = loadModel("human.xml");
  const DataPtr d = makeData(m.get());
  randomControls(m.get(), d.get(), 0.5, 7);
  mj_step(m.get(), d.get());
  const long before = allocations;
  for (int i = 0; i < 300; i++) mj_step(m.get(), d.get());
  EXPECT_EQ(allocations, before);
}

TEST_F(AllocationTest, ReadOutAllocatesNothing) {
  const ModelPtr m = loadModel("torso.xml");
  const DataPtr d = makeData(m.get());
  mj_step(m.get(), d.get());
  std::vector<mjtNum> nodes(3 * 1000);
  mjtNum force[3], moment[3], point[3];
  const long before = allocations;
  for (int i = 0; i < 23; i++) {
    torso_discWrench(m.get(), d.get(), i, force, moment, point);
    torso_discNodes(m.get(), d.get(), i, nodes.data());
    torso_discPressure(m.get(), d.get(), i);
    torso_discThickness(m.get(), d.get(), i, force);
  }
  for (int i = 0; i < 74; i++) torso_facetForce(m.get(), d.get(), i, force);
  EXPECT_EQ(allocations, before);
}

// On one thread: a rollout allocates for its other threads only.
TEST_F(AllocationTest, RolloutsAllocateNothing) {
  const ModelPtr m = loadModel("torso.xml");
  const DataPtr d = makeData(m.get());
  mjData* const data = d.get();
  constexpr int kTrajectories = 5, kSteps = 3;
  std::vector<mjtNum> full(kTrajectories * torso_stateSize(m.get(), TORSO_STATE_FULL));
  std::vector<mjtNum> state(kTrajectories * kSteps * torso_stateSize(m.get(), TORSO_STATE_FULL));
  std::vector<mjtNum> sensordata(kTrajectories * kSteps * m->nsensordata);
  torsoRollout r;
  torso_defaultRollout(&r);
  r.ntrajectory = kTrajectories;
  r.nstep = kSteps;
  r.state = state.data();
  r.state_spec = TORSO_STATE_FULL;
  r.sensordata = sensordata.data();
  r.final_state = full.data();
  mj_step(m.get(), d.get());
  const long before = allocations;
  EXPECT_EQ(torso_rollout(m.get(), &data, 1, &r), 0);
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace torso
