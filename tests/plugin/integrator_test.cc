// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// All of MuJoCo's integrators, solvers and Jacobians, and its finite differences, work on the
// torso.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/plugin/fixture.h"

namespace torso {
namespace {

class IntegratorTest : public PluginTest, public ::testing::WithParamInterface<int> {};

// Dropped on the floor with the servos at work. The fixture fails on warnings, which is how MuJoCo
// reports an unstable simulation.
TEST_P(IntegratorTest, RunsASecond) {
  const ModelPtr m = loadModel("human.xml");
  m->opt.integrator = GetParam();
  const DataPtr d = makeData(m.get());
  randomControls(m.get(), d.get(), 0.3, 4);
  double least = 1, most = 1;
  while (d->time < 1) {
    mj_step(m.get(), d.get());
    for (int i = 0; i < 23; i++) {
      mjtNum ratio[3];
      ASSERT_EQ(torso_discThickness(m.get(), d.get(), i, ratio), 0);
      least = std::min(least, ratio[0]);
      most = std::max(most, ratio[2]);
    }
  }
  std::printf("discs %.2f to %.2f of their rest thickness\n", least, most);
  EXPECT_GT(least, 0.2);
  EXPECT_LT(most, 3);
  for (int i = 0; i < m->nq; i++) ASSERT_TRUE(std::isfinite(d->qpos[i]));
}

INSTANTIATE_TEST_SUITE_P(All, IntegratorTest,
                         ::testing::Values(mjINT_EULER, mjINT_RK4, mjINT_IMPLICIT),
                         [](const auto& info) {
                           return info.param == mjINT_EULER ? "Euler"
                                  : info.param == mjINT_RK4 ? "RK4"
                                                            : "Implicit";
                         });

class DerivativeTest : public PluginTest {
 protected:
  static DataPtr busyData(const mjModel* m) {
    DataPtr d = makeData(m);
    randomControls(m, d.get(), 0.3, 5);
    for (int i = 0; i < 50; i++) mj_step(m, d.get());
    return d;
  }
};

// mjd_transitionFD against differences of whole steps from copies. It takes two short cuts: in
// MuJoCo 2.2.2 it lets time run on from one evaluation to the next, and it detects no collisions
// while it varies velocities.
class TransitionTest : public DerivativeTest {
 protected:
  enum Kind { kVelocity, kPosition, kControl };
  // Largest relative error of some columns, in the rows of velocities.
  static double worstError(const mjModel* m, Kind kind) {
    const DataPtr start = busyData(m), d = copyData(m, start.get());
    const int n = 2 * m->nv + m->na;
    const double eps = 1e-5;
    std::vector<mjtNum> A(n * n), B(n * m->nu);
    mjd_transitionFD(m, d.get(), eps, 1, A.data(), B.data(), nullptr, nullptr);
    for (mjtNum x : A) EXPECT_TRUE(std::isfinite(x));
    for (mjtNum x : B) EXPECT_TRUE(std::isfinite(x));
    const auto step = [&](int column, double change) {
      DataPtr copy = copyData(m, start.get());
      std::vector<mjtNum> direction(m->nv, 0);
      if (kind != kControl) direction[column] = 1;
      if (kind == kPosition) mj_integratePos(m, copy->qpos, direction.data(), change);
      if (kind == kVelocity) copy->qvel[column] += change;
      if (kind == kControl) copy->ctrl[column] += change;
      mj_step(m, copy.get());
      return copy;
    };
    double worst = 0;
    for (int k = 0; k < 12; k++) {
      const int columns = kind == kControl ? m->nu : m->nv, column = k * columns / 12;
      const DataPtr plus = step(column, eps), minus = step(column, -eps);
      double error = 0, scale = 0;
      for (int i = 0; i < m->nv; i++) {
        const double expected = (plus->qvel[i] - minus->qvel[i]) / (2 * eps);
        const double got = kind == kControl
                               ? B[(m->nv + i) * m->nu + column]
                               : A[(m->nv + i) * n + (kind == kVelocity ? m->nv : 0) + column];
        error = std::max(error, std::abs(got - expected));
        scale = std::max(scale, std::abs(expected));
      }
      EXPECT_GT(scale, 0);

      worst = std::max(worst, error / scale);
    }
    return worst;
  }
};

TEST_F(TransitionTest, VelocitiesAndControlsAreExactWithoutFacets) {
  const ModelPtr m = loadModel("torso.xml");
  m->opt.disableflags |= mjDSBL_CONTACT;
  EXPECT_LT(worstError(m.get(), kVelocity), 1e-5);
  EXPECT_LT(worstError(m.get(), kControl), 1e-5);
}

// The disc solver takes one iteration from the last shape, and time runs on in mjd_transitionFD
// (see below), so that the shapes that it starts from differ.
TEST_F(TransitionTest, PositionsWithinAFifth) {
  const ModelPtr m = loadModel("torso.xml");
  EXPECT_LT(worstError(m.get(), kPosition), 0.2);
}

// The normals of facet contacts stay those of the last collision detection.
TEST_F(TransitionTest, VelocitiesWithFacets) {
  const ModelPtr m = loadModel("torso.xml");
  EXPECT_LT(worstError(m.get(), kVelocity), 0.2);
}

// Time runs on, as said above, and the discs' shapes with it; a caller who puts these back has lost
// nothing.
TEST_F(TransitionTest, LeavesNoTraceButTimeAndShapes) {
  const ModelPtr m = loadModel("torso.xml");
  m->opt.disableflags |= mjDSBL_WARMSTART;
  const DataPtr plain = busyData(m.get());
  const DataPtr differentiated = copyData(m.get(), plain.get());
  const int n = 2 * m->nv + m->na;
  std::vector<mjtNum> A(n * n);
  mjd_transitionFD(m.get(), differentiated.get(), 1e-6, 0, A.data(), nullptr, nullptr, nullptr);
  for (int i = 0; i < m->nq; i++) ASSERT_EQ(differentiated->qpos[i], plain->qpos[i]);
  for (int i = 0; i < m->nv; i++) ASSERT_EQ(differentiated->qvel[i], plain->qvel[i]);
  differentiated->time = plain->time;
  mju_copy(differentiated->userdata, plain->userdata, m->nuserdata);
  for (int i = 0; i < 10; i++) {
    mj_step(m.get(), plain.get());
    mj_step(m.get(), differentiated.get());
  }
  EXPECT_EQ(differences(m.get(), plain.get(), differentiated.get()), "");
}

// mj_fwdVelocity alone runs the callback again on constraint rows that it has rewritten already.
TEST_F(DerivativeTest, CallbackMayRunAgainOnItsOwnRows) {
  const ModelPtr m = loadModel("torso.xml");
  m->opt.disableflags |= mjDSBL_WARMSTART;
  const DataPtr d = busyData(m.get());
  mj_forward(m.get(), d.get());
  const DataPtr once = copyData(m.get(), d.get());
  mj_forwardSkip(m.get(), d.get(), mjSTAGE_POS, 0);
  EXPECT_EQ(differences(m.get(), once.get(), d.get()), "");
}

TEST_F(DerivativeTest, InverseDynamicsReturnsTheAppliedForces) {
  const ModelPtr m = loadModel("torso.xml");
  const DataPtr d = busyData(m.get());
  for (int i = 0; i < m->nv; i++) d->qfrc_applied[i] = std::sin(i);
  m->opt.enableflags |= mjENBL_FWDINV;
  mj_forward(m.get(), d.get());
  // Norms of the differences in constraint force and applied force.
  EXPECT_LT(d->solver_fwdinv[0], 1e-4);
  EXPECT_LT(d->solver_fwdinv[1], 1e-4);
}

// One state, solved in other ways.
class SolverTest : public DerivativeTest {
 protected:
  // Largest difference of accelerations over the largest acceleration.
  static double difference(const mjModel* m, const mjData* one, const mjData* two) {
    double error = 0, scale = 0;
    for (int i = 0; i < m->nv; i++) {
      error = std::max(error, std::abs(one->qacc[i] - two->qacc[i]));
      scale = std::max(scale, std::abs(one->qacc[i]));
    }
    return error / scale;
  }
};

TEST_F(SolverTest, DenseJacobianGivesTheSameAccelerations) {
  const ModelPtr m = loadModel("torso.xml");
  const DataPtr sparse = busyData(m.get());
  mj_forward(m.get(), sparse.get());
  m->opt.jacobian = mjJAC_DENSE;
  const DataPtr dense = makeData(m.get());
  mju_copy(dense->qpos, sparse->qpos, m->nq);
  mju_copy(dense->qvel, sparse->qvel, m->nv);
  mju_copy(dense->ctrl, sparse->ctrl, m->nu);
  mju_copy(dense->userdata, sparse->userdata, m->nuserdata);
  dense->time = sparse->time;
  mj_forward(m.get(), dense.get());
  EXPECT_EQ(dense->nefc, sparse->nefc);
  EXPECT_LT(difference(m.get(), sparse.get(), dense.get()), 1e-6);
}

TEST_F(SolverTest, ConjugateGradientGivesTheSameAccelerations) {
  const ModelPtr m = loadModel("torso.xml");
  const DataPtr newton = busyData(m.get());
  const DataPtr cg = copyData(m.get(), newton.get());
  mj_forward(m.get(), newton.get());
  m->opt.solver = mjSOL_CG;
  m->opt.iterations = 3000;
  m->opt.tolerance = 0;
  mj_forward(m.get(), cg.get());
  EXPECT_LT(difference(m.get(), newton.get(), cg.get()), 1e-3);
}

}  // namespace
}  // namespace torso
