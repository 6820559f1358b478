// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Discs, ligaments, facets and servos act between bones: in space they move no centre of mass.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "tests/plugin/fixture.h"

namespace torso {
namespace {

using Eigen::Vector3d;

struct Wrench {
  Vector3d force = Vector3d::Zero(), moment = Vector3d::Zero();  // about the world's origin
};

Vector3d vector(const mjtNum* x) { return {x[0], x[1], x[2]}; }

// Resultant of generalised forces on a model whose trees all hang on free joints: the power of the
// forces under a common translation and rotation.
Wrench resultant(const mjModel* m, const mjData* d, const mjtNum* qfrc) {
  Wrench sum;
  for (int j = 0; j < m->njnt; j++) {
    if (m->jnt_type[j] != mjJNT_FREE) continue;
    const mjtNum* q = qfrc + m->jnt_dofadr[j];
    const int body = m->jnt_bodyid[j];
    const Vector3d force = vector(q);
    mjtNum moment[3];
    mju_rotVecMat(moment, q + 3, d->xmat + 9 * body);
    sum.force += force;
    sum.moment += vector(d->xpos + 3 * body).cross(force) + vector(moment);
  }
  return sum;
}

// Generalised force of the constraint rows of one kind, and the sum of the rows' magnitudes.
struct RowForces {
  std::vector<mjtNum> qfrc;
  double sum = 0;
};
template <typename Wanted>
RowForces rowForces(const mjModel* m, const mjData* d, Wanted wanted) {
  std::vector<mjtNum> force(d->nefc, 0);
  RowForces out;
  for (int i = 0; i < d->nefc; i++) {
    if (!wanted(d->efc_type[i])) continue;
    force[i] = d->efc_force[i];
    out.sum += std::abs(force[i]);
  }
  out.qfrc.resize(m->nv);
  mj_mulJacTVec(m, const_cast<mjData*>(d), out.qfrc.data(), force.data());
  return out;
}

class ConservationTest : public PluginTest {
 protected:
  struct Momentum {
    Vector3d linear, angular;                    // angular about the centre of mass
    double linear_scale = 0, angular_scale = 0;  // sums of the bodies' magnitudes
  };
  static Momentum momentum(const mjModel* m, mjData* d) {
    mj_kinematics(m, d);
    mj_comPos(m, d);
    mj_comVel(m, d);
    mj_subtreeVel(m, d);
    Momentum p;
    p.linear = m->body_subtreemass[0] * vector(d->subtree_linvel);
    p.angular = vector(d->subtree_angmom);
    for (int i = 1; i < m->nbody; i++) {
      mjtNum v[6];  // rotation, translation at the centre of mass
      mj_objectVelocity(m, d, mjOBJ_BODY, i, v, 0);
      const Vector3d at_com =
          vector(v + 3) + vector(v).cross(vector(d->xipos + 3 * i) - vector(d->xpos + 3 * i));
      const double magnitude = m->body_mass[i] * at_com.norm();
      p.linear_scale += magnitude;
      p.angular_scale += magnitude * (vector(d->xipos + 3 * i) - vector(d->subtree_com)).norm();
    }
    return p;
  }
};

// At every step of a violent motion, with the servos on.
TEST_F(ConservationTest, ForcesBetweenBonesCancel) {
  const ModelPtr m = loadModel("human.xml");
  leaveInSpace(m.get());
  mju_zero(m->jnt_stiffness, m->njnt);
  const DataPtr d = makeData(m.get());
  randomVelocities(m.get(), d.get(), 0.3, 1);
  randomControls(m.get(), d.get(), 1, 1);
  const torsoInfo info = torsoOf(m.get());
  double disc_sum = 0, ligament_sum = 0, facet_sum = 0;
  std::vector<mjtNum> expected(m->nv);
  for (int step = 0; step < 300; step++) {
    mj_step(m.get(), d.get());
    mj_forward(m.get(), d.get());
    ASSERT_FALSE(HasFailure()) << "before step " << step;

    double sum = 0, moments = 0;
    mju_zero(expected.data(), m->nv);
    for (int i = 0; i < info.ndisc; i++) {
      mjtNum f[3], t[3], p[3];
      int body[2];
      torso_discWrench(m.get(), d.get(), i, f, t, p);
      torso_discBodies(m.get(), i, body);
      mj_applyFT(m.get(), d.get(), f, t, p, body[1], expected.data());
      for (int k = 0; k < 3; k++) f[k] = -f[k], t[k] = -t[k];
      mj_applyFT(m.get(), d.get(), f, t, p, body[0], expected.data());
      sum += 2 * mju_norm3(f);
      moments += 2 * (mju_norm3(t) + vector(p).cross(vector(f)).norm());
    }
    for (int i = 0; i < m->nv; i++) expected[i] -= m->dof_damping[i] * d->qvel[i];
    const Wrench discs = resultant(m.get(), d.get(), d->qfrc_passive);
    EXPECT_LT(discs.force.norm(), 1e-9 * sum);
    EXPECT_LT(discs.moment.norm(), 1e-9 * moments);
    for (int i = 0; i < m->nv; i++) {
      ASSERT_NEAR(d->qfrc_passive[i], expected[i], 1e-9 * (sum + moments)) << "dof " << i;
    }
    disc_sum += sum;

    const double reach = 2;  // no force acts further than this from the world's origin [m]
    const RowForces ligaments =
        rowForces(m.get(), d.get(), [](int type) { return type == mjCNSTR_LIMIT_TENDON; });
    Wrench w = resultant(m.get(), d.get(), ligaments.qfrc.data());
    EXPECT_LE(w.force.norm(), 1e-9 * ligaments.sum);
    EXPECT_LE(w.moment.norm(), 1e-9 * reach * ligaments.sum);
    ligament_sum += ligaments.sum;

    const RowForces facets =
        rowForces(m.get(), d.get(), [](int type) { return type == mjCNSTR_CONTACT_FRICTIONLESS; });
    w = resultant(m.get(), d.get(), facets.qfrc.data());
    EXPECT_LE(w.force.norm(), 1e-9 * facets.sum);
    EXPECT_LE(w.moment.norm(), 1e-9 * reach * facets.sum);
    facet_sum += facets.sum;

    const RowForces welds =
        rowForces(m.get(), d.get(), [](int type) { return type == mjCNSTR_EQUALITY; });
    w = resultant(m.get(), d.get(), welds.qfrc.data());
    EXPECT_LE(w.force.norm(), 1e-9 * welds.sum);
    EXPECT_LE(w.moment.norm(), 1e-9 * reach * welds.sum);

    const Wrench servos = resultant(m.get(), d.get(), d->qfrc_actuator);
    double torque = 0;
    for (int i = 0; i < m->nu; i++) torque += std::abs(d->actuator_force[i]);
    EXPECT_LE(servos.force.norm(), 1e-9 * torque);
    EXPECT_LE(servos.moment.norm(), 1e-9 * torque);
  }
  EXPECT_GT(disc_sum, 0);
  EXPECT_GT(ligament_sum, 0) << "some ligament was taut";
  EXPECT_GT(facet_sum, 0) << "some facet acted";
}

// MuJoCo's integrators keep the linear momentum of a free body exactly only if its frame is at its
// centre of mass and nothing hangs on it. With the masses gathered so, all forces of the torso are
// at work, and anything they leak in a second shows.
TEST_F(ConservationTest, LinearMomentumIsKept) {
  for (bool servos : {false, true}) {
    const ModelPtr m = loadModel("human.xml");
    leaveInSpace(m.get());
    if (!servos) m->opt.disableflags |= mjDSBL_ACTUATION;
    mju_zero(m->body_ipos, 3 * m->nbody);
    for (int i = 1; i < m->nbody; i++) {
      if (m->body_rootid[i] == i) continue;
      m->body_mass[m->body_rootid[i]] += m->body_mass[i];
      m->body_mass[i] = 0;
      mju_zero3(m->body_inertia + 3 * i);
    }
    mj_setConst(m.get(), makeData(m.get()).get());
    const DataPtr d = makeData(m.get());
    randomVelocities(m.get(), d.get(), 0.1, 2);
    const Momentum before = momentum(m.get(), d.get());
    while (d->time < 1) mj_step(m.get(), d.get());
    const Momentum after = momentum(m.get(), d.get());
    EXPECT_LT((after.linear - before.linear).norm(), 1e-9 * before.linear_scale)
        << (servos ? "servos on" : "servos off");
  }
}

// What remains of the real body's drift belongs to the integrator, and goes with the step.
TEST_F(ConservationTest, DriftOfMomentumShrinksWithTheStep) {
  const ModelPtr m = loadModel("human.xml");
  leaveInSpace(m.get());
  for (bool servos : {false, true}) {
    m->opt.disableflags = servos ? 0 : mjDSBL_ACTUATION;
    double linear = 0, angular = 0;
    for (int k : {1, 2, 4}) {
      m->opt.timestep = 1.0 / (600 * k);
      const DataPtr d = makeData(m.get());
      randomVelocities(m.get(), d.get(), 0.1, 2);
      const Momentum before = momentum(m.get(), d.get());
      for (int i = 0; i < 150 * k; i++) mj_step(m.get(), d.get());
      const Momentum after = momentum(m.get(), d.get());
      const double linear_drift = (after.linear - before.linear).norm() / before.linear_scale;
      const double angular_drift = (after.angular - before.angular).norm() / before.angular_scale;
      std::printf("servos %s, h = 1/%d s, 0.25 s: drift of momentum %.1e linear, %.1e angular\n",
                  servos ? "on" : "off", 600 * k, linear_drift, angular_drift);
      if (k == 1) {
        EXPECT_LT(linear_drift, 2e-4);
        EXPECT_LT(angular_drift, 2e-4);
      } else {
        EXPECT_LT(linear_drift, 0.55 * linear);
        EXPECT_LT(angular_drift, 0.55 * angular);
      }
      linear = linear_drift;
      angular = angular_drift;
    }
  }
}

// The discs know nothing of where the body is.
TEST_F(ConservationTest, RigidMotionTurnsDiscWrenchesWithIt) {
  const ModelPtr m = loadModel("human.xml");
  leaveInSpace(m.get());
  const DataPtr d = makeData(m.get());
  randomVelocities(m.get(), d.get(), 0.3, 3);
  for (int i = 0; i < 60; i++) mj_step(m.get(), d.get());

  const DataPtr moved = copyData(m.get(), d.get());
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(2.1, Vector3d(0.3, -0.7, 0.6).normalized()));
  const Vector3d shift(3, -2, 5);
  const mjtNum turn_wxyz[4] = {turn.w(), turn.x(), turn.y(), turn.z()};
  for (int j = 0; j < m->njnt; j++) {
    if (m->jnt_type[j] != mjJNT_FREE) continue;
    mjtNum *q = moved->qpos + m->jnt_qposadr[j], *v = moved->qvel + m->jnt_dofadr[j];
    Eigen::Map<Vector3d> position(q), velocity(v);
    position = shift + turn * Vector3d(position);
    velocity = turn * Vector3d(velocity);
    mjtNum rotation[4];
    mju_mulQuat(rotation, turn_wxyz, q + 3);
    mju_copy4(q + 3, rotation);
  }
  mj_forward(m.get(), d.get());
  mj_forward(m.get(), moved.get());
  double error = 0, moment_error = 0, largest = 0, largest_moment = 0;
  for (int i = 0; i < torsoOf(m.get()).ndisc; i++) {
    Vector3d f[2], t[2], p[2];
    torso_discWrench(m.get(), d.get(), i, f[0].data(), t[0].data(), p[0].data());
    torso_discWrench(m.get(), moved.get(), i, f[1].data(), t[1].data(), p[1].data());
    error = std::max(error, (turn.conjugate() * f[1] - f[0]).norm());
    moment_error = std::max(moment_error, (turn.conjugate() * t[1] - t[0]).norm());
    largest = std::max(largest, f[0].norm());
    largest_moment = std::max(largest_moment, t[0].norm());
    EXPECT_LT((turn.conjugate() * (p[1] - shift) - p[0]).norm(), 1e-12);
  }
  EXPECT_GT(largest, 10) << "the discs were at work [N]";
  EXPECT_LT(error, 1e-5 * largest);
  EXPECT_LT(moment_error, 1e-5 * largest_moment);
}

}  // namespace
}  // namespace torso
