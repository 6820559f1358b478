// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Actuators that bend several levels of the spine.

#include "tests/tools/graft_fixture.h"

namespace torso::tools {
namespace {

class GraftActuators : public GraftFixture {
 protected:
  ModelPtr grafted(const std::string& text, bool groups) {
    GraftOptions o = options(write("in.xml", text));
    o.groups = groups;
    report_ = graft(anatomy(), o);
    return loadModel(at("out.xml"));
  }
  GraftReport report_;
};

// Rotation vector of a body relative to another since the pose qpos0, in the axes of the world
// then.
Eigen::Vector3d turn(const mjModel* m, const mjData* rest, const mjData* d,
                     const std::string& lower, const std::string& upper) {
  mjtNum since[2][4], result[3];
  for (int k = 0; k < 2; k++) {
    const int b = idOf(m, mjOBJ_BODY, k ? upper : lower);
    mjtNum back[4];
    mju_negQuat(back, rest->xquat + 4 * b);
    mju_mulQuat(since[k], d->xquat + 4 * b, back);
  }
  mju_subQuat(result, since[1], since[0]);
  return {result[0], result[1], result[2]};
}

// Pose after a second without gravity, one control set.
DataPtr settled(mjModel* m, int actuator, double control) {
  mju_zero3(m->opt.gravity);
  DataPtr d = makeData(m);
  d->ctrl[actuator] = control;
  while (d->time < 1) mj_step(m, d.get());
  EXPECT_EQ(firstWarning(d.get()), "");
  return d;
}

const std::vector<std::string> kBones = {"pelvis", "L5", "L4", "L3", "L2", "L1", "T12", "T11",
                                         "T10",    "T9", "T8", "T7", "T6", "T5", "T4",  "T3",
                                         "T2",     "T1", "C7", "C6", "C5", "C4", "C3",  "head"};

// Each group reaches its target, about its axis, and its levels share the motion.
TEST_F(GraftActuators, GroupsBendTheirLevels) {
  const ModelPtr m = grafted(plainHumanoid(), true);
  const DataPtr rest = makeData(m.get());
  mj_forward(m.get(), rest.get());
  const std::tuple<const char*, std::size_t, std::size_t> regions[] = {
      {"lumbar", 0, 6}, {"thoracic", 6, 17}, {"cervical", 17, 23}};
  const std::pair<const char*, int> motions[] = {
      {"lateral_bending", 0}, {"flexion", 1}, {"axial_rotation", 2}};
  for (const auto& [region, first, last] : regions) {
    for (const auto& [motion, axis] : motions) {
      const std::string name = std::string(region) + "_" + motion;
      const int u = idOf(m.get(), mjOBJ_ACTUATOR, name);
      const double target = 0.8 * m->actuator_ctrlrange[2 * u + 1];
      const DataPtr d = settled(m.get(), u, target);
      const Eigen::Vector3d reached =
          turn(m.get(), rest.get(), d.get(), kBones[first], kBones[last]);
      EXPECT_NEAR(reached[axis] / target, 0.92, 0.09) << name;
      for (int k = 0; k < 3; k++) {
        if (k != axis) {
          EXPECT_NEAR(reached[k], 0, 0.15 * target) << name << " axis " << k;
        }
      }
      for (std::size_t i = first; i < last; i++) {
        const double share =
            turn(m.get(), rest.get(), d.get(), kBones[i], kBones[i + 1])[axis] / reached[axis];
        EXPECT_GT(share, region == std::string("thoracic") ? 0.003 : 0.04) << name << " " << i;
        EXPECT_LT(share, region == std::string("cervical") ? 0.75 : 0.3) << name << " " << i;
      }
    }
  }
}

// A positive control turns the chest against the pelvis as the joint did whose actuator it was.
TEST_F(GraftActuators, TheHumanoidsOwnKeepNameRangeAndSense) {
  const ModelPtr m = grafted(waistDownHumanoid(), false);
  const ModelPtr before = loadModel(at("in.xml"));
  const DataPtr rest0 = makeData(before.get()), rest = makeData(m.get());
  mj_forward(before.get(), rest0.get());
  mj_forward(m.get(), rest.get());
  for (const char* name : {"abdomen_x", "abdomen_y", "abdomen_z"}) {
    const int u0 = idOf(before.get(), mjOBJ_ACTUATOR, name),
              u = idOf(m.get(), mjOBJ_ACTUATOR, name);
    EXPECT_EQ(u0, u) << "place in ctrl";
    for (int k = 0; k < 2; k++) {
      EXPECT_EQ(before->actuator_ctrlrange[2 * u0 + k], m->actuator_ctrlrange[2 * u + k]);
    }
    const DataPtr d0 = makeData(before.get());
    d0->qpos[before->jnt_qposadr[idOf(before.get(), mjOBJ_JOINT, name)]] = 0.1;
    mj_forward(before.get(), d0.get());
    const Eigen::Vector3d was = turn(before.get(), rest0.get(), d0.get(), "pelvis", "torso");
    const DataPtr d = settled(m.get(), u, 0.5);
    const Eigen::Vector3d is = turn(m.get(), rest.get(), d.get(), "pelvis", "T12");
    EXPECT_GT(is.normalized().dot(was.normalized()), 0.95) << name;
  }
}

// A position servo goes to the angle that it went to.
TEST_F(GraftActuators, PositionServosKeepTheirAngle) {
  const ModelPtr m = grafted(pelvisUpHumanoid(), false);
  const DataPtr rest = makeData(m.get());
  mj_forward(m.get(), rest.get());
  const int u = idOf(m.get(), mjOBJ_ACTUATOR, "Spine1_x");
  const DataPtr d = settled(m.get(), u, 0.3);
  EXPECT_NEAR(turn(m.get(), rest.get(), d.get(), "pelvis", "T12").x(), 0.3, 0.03);
}

// What holds a level by default still does, and no length depends on how the body lies.
TEST_F(GraftActuators, GroupsDoNotFeelARotationOfTheWhole) {
  const ModelPtr m = grafted(waistDownHumanoid(), true);
  const DataPtr d = makeData(m.get());
  const mjtNum turned[4] = {0.5, 0.1, 0.7, 0.5};
  for (int j = 0; j < m->njnt; j++) {
    if (m->jnt_type[j] != mjJNT_FREE) continue;
    mjtNum *q = d->qpos + m->jnt_qposadr[j], unit[4], position[3], rotation[4];
    mju_copy4(unit, turned);
    mju_normalize4(unit);
    mju_rotVecQuat(position, q, unit);
    mju_mulQuat(rotation, unit, q + 3);
    mju_copy3(q, position);
    mju_copy4(q + 3, rotation);
  }
  mj_forward(m.get(), d.get());
  for (const char* name : {"abdomen_x", "abdomen_y", "thoracic_flexion", "cervical_flexion"}) {
    EXPECT_NEAR(d->actuator_length[idOf(m.get(), mjOBJ_ACTUATOR, name)], 0, 1e-5) << name;
  }
}

// What has no angle to go to, or drives no hinge, is removed and said so.
TEST_F(GraftActuators, OthersAreRemovedAndReported) {
  const ModelPtr m = grafted(pelvisUpHumanoid(), false);
  for (const char* name : {"brake", "L_Clavicle_x"}) {
    EXPECT_LT(mj_name2id(m.get(), mjOBJ_ACTUATOR, name), 0);
    EXPECT_TRUE(std::any_of(report_.changes.begin(), report_.changes.end(), [&](const auto& c) {
      return c.action == "removed" && c.kind == "actuator" && c.name == name;
    })) << name;
  }
}

}  // namespace
}  // namespace torso::tools
