// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <cmath>
#include <string>

#include "tests/plugin/fixture.h"

namespace torso {
namespace {

using ServoTest = PluginTest;
using Eigen::Quaterniond;
using Eigen::Vector3d;

std::vector<double> lengths(const mjModel* m, const mjData* d) {
  return {d->actuator_length, d->actuator_length + m->nu};
}

// Servos read the rotation between two bones: none at rest, and the same however the body lies.
TEST_F(ServoTest, ReadTheSameAnglesInABodyThatIsTurned) {
  const ModelPtr m = loadModel("human.xml");
  const DataPtr d = makeData(m.get());
  mj_forward(m.get(), d.get());
  for (int i = 0; i < m->nu; i++) {
    EXPECT_NEAR(d->actuator_length[i], 0, 1e-6) << mj_id2name(m.get(), mjOBJ_ACTUATOR, i);
  }
  randomVelocities(m.get(), d.get(), 0.05, 1);
  mj_integratePos(m.get(), d->qpos, d->qvel, 1);  // another posture
  mj_forward(m.get(), d.get());
  const std::vector<double> before = lengths(m.get(), d.get());
  const Quaterniond turn(Eigen::AngleAxisd(2.1, Vector3d(1, -2, 0.5).normalized()));
  for (int j = 0; j < m->njnt; j++) {
    if (m->jnt_type[j] != mjJNT_FREE) continue;
    mjtNum* q = d->qpos + m->jnt_qposadr[j];
    const Vector3d position = turn * Vector3d(q[0], q[1], q[2]);
    mju_copy3(q, position.data());
    const Quaterniond turned = turn * Quaterniond(q[3], q[4], q[5], q[6]);
    q[3] = turned.w(), q[4] = turned.x(), q[5] = turned.y(), q[6] = turned.z();
  }
  mj_forward(m.get(), d.get());
  const std::vector<double> after = lengths(m.get(), d.get());
  double largest = 0;
  for (int i = 0; i < m->nu; i++) {
    EXPECT_NEAR(after[i], before[i], 1e-9) << mj_id2name(m.get(), mjOBJ_ACTUATOR, i);
    largest = std::max(largest, std::abs(before[i]));
  }
  EXPECT_GT(largest, 0.05);
}

// A servo's reading changes by the angle about its axis of the disc, one for one.
TEST_F(ServoTest, FlexionReadsTheAngleOfTheDisc) {
  const ModelPtr m = loadModel("torso.xml");
  const DataPtr d = makeData(m.get());
  mj_forward(m.get(), d.get());
  const int servo = mj_name2id(m.get(), mjOBJ_ACTUATOR, "L2/L3_lateral_bending");
  ASSERT_GE(servo, 0);
  mjtNum pos[3], mat[9];
  const int disc = torso_discId(m.get(), "L2/L3");
  ASSERT_EQ(torso_discFrame(m.get(), d.get(), disc, pos, mat), 0);
  int bodies[2];
  ASSERT_EQ(torso_discBodies(m.get(), disc, bodies), 0);
  mjtNum* q = d->qpos + m->jnt_qposadr[m->body_jntadr[bodies[1]]];
  const Vector3d axis(mat[0], mat[3], mat[6]);  // forward
  const Quaterniond tilted =
      Quaterniond(Eigen::AngleAxisd(0.1, axis)) * Quaterniond(q[3], q[4], q[5], q[6]);
  q[3] = tilted.w(), q[4] = tilted.x(), q[5] = tilted.y(), q[6] = tilted.z();
  mj_forward(m.get(), d.get());
  EXPECT_NEAR(std::abs(d->actuator_length[servo]), 0.1, 1e-6);
  EXPECT_NEAR(d->actuator_length[mj_name2id(m.get(), mjOBJ_ACTUATOR, "L2/L3_flexion")], 0, 1e-6);
}

}  // namespace
}  // namespace torso
