// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Two torsos with prefixes of their own in one model.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>

#include "tests/plugin/fixture.h"
#include "tools/paths.h"
#include "tools/torso_mjcf.h"

namespace torso {
namespace {

using Eigen::Vector3d;

class TwoTorsosTest : public PluginTest {
 protected:
  static std::string text(const std::string& prefix) {
    static const Anatomy anatomy = Anatomy::load(tools::anatomyFolder());
    tools::MjcfOptions options;
    options.prefix = prefix;
    tinyxml2::XMLDocument document;
    tools::writeMjcf(anatomy, options, document);
    tinyxml2::XMLPrinter printer;
    document.Print(&printer);
    return withoutMeshes(printer.CStr());
  }
  // Both in one model, with room for both.
  static std::string pair() {
    std::string a = text("a_"), b = text("b_");
    a.erase(a.rfind("</mujoco>"));
    b.erase(0, b.find('>', b.find("<mujoco ")) + 1);
    std::string both = a + b;
    for (int i = 0; i < 2; i++) {  // of two <size>, the last one counts
      replaceOnce(&both, "nuserdata=\"20000\"", "nuserdata=\"40000\"");
      replaceOnce(&both, "njmax=\"1500\"", "njmax=\"3000\"");
      replaceOnce(&both, "nconmax=\"500\"", "nconmax=\"1000\"");
      replaceOnce(&both, "nstack=\"2000000\"", "nstack=\"6000000\"");
    }
    return both;
  }
  static void moveAll(const mjModel* m, mjData* d, const std::string& prefix, double y) {
    for (int j = 0; j < m->njnt; j++) {
      const std::string name = mj_id2name(m, mjOBJ_JOINT, j);
      if (name.rfind(prefix, 0) == 0 && m->jnt_type[j] == mjJNT_FREE) {
        d->qpos[m->jnt_qposadr[j] + 1] += y;
      }
    }
  }
  // Copies positions from a model of one torso to the one of that prefix in another.
  static void copyPositions(const mjModel* from_model, const mjData* from, const mjModel* m,
                            mjData* d, const std::string& prefix) {
    for (int j = 0; j < from_model->njnt; j++) {
      const std::string name = mj_id2name(from_model, mjOBJ_JOINT, j);
      const int to = mj_name2id(m, mjOBJ_JOINT, (prefix + name).c_str());
      ASSERT_GE(to, 0) << prefix + name;
      mju_copy(d->qpos + m->jnt_qposadr[to], from->qpos + from_model->jnt_qposadr[j],
               m->jnt_type[to] == mjJNT_FREE ? 7 : 4);
    }
  }
};

TEST_F(TwoTorsosTest, EachHasTheWrenchesOfOneAlone) {
  const ModelPtr one = loadText(text("")), two = loadText(pair());
  const torsoInfo info = torsoOf(two.get());
  EXPECT_EQ(info.ntorso, 2);
  EXPECT_EQ(info.ndisc, 46);
  EXPECT_EQ(info.nligament, 40);
  EXPECT_EQ(info.nligsegment, 880);
  EXPECT_EQ(info.nfacet, 148);

  const DataPtr alone = makeData(one.get()), both = makeData(two.get());
  // Some pose away from rest: 5 ms of a random motion.
  std::mt19937 random(9);
  std::normal_distribution<double> normal(0, 0.2);
  std::vector<mjtNum> velocity(one->nv);
  for (mjtNum& v : velocity) v = normal(random);
  mj_integratePos(one.get(), alone->qpos, velocity.data(), 0.005);
  for (const char* prefix : {"a_", "b_"}) {
    copyPositions(one.get(), alone.get(), two.get(), both.get(), prefix);
  }
  moveAll(two.get(), both.get(), "b_", 2);
  mj_forward(one.get(), alone.get());
  mj_forward(two.get(), both.get());
  for (int i = 0; i < 23; i++) {
    const std::string name = torso_discName(one.get(), i);
    Vector3d force, moment, point;
    torso_discWrench(one.get(), alone.get(), i, force.data(), moment.data(), point.data());
    EXPECT_GT(force.norm(), 0.1) << name;
    for (const char* prefix : {"a_", "b_"}) {
      const int disc = torso_discId(two.get(), (prefix + name).c_str());
      ASSERT_GE(disc, 0) << prefix + name;
      Vector3d f, t, p;
      torso_discWrench(two.get(), both.get(), disc, f.data(), t.data(), p.data());
      if (prefix[0] == 'b') p.y() -= 2;
      EXPECT_LT((f - force).norm(), 1e-5 * force.norm()) << prefix + name;
      EXPECT_LT((t - moment).norm(), 1e-5 * moment.norm()) << prefix + name;
      EXPECT_LT((p - point).norm(), 1e-12) << prefix + name;
    }
  }
}

TEST_F(TwoTorsosTest, BothSimulate) {
  const ModelPtr m = loadText(pair());
  mju_zero3(m->opt.gravity);
  const DataPtr d = makeData(m.get());
  moveAll(m.get(), d.get(), "b_", 2);
  // Only b is commanded.
  for (int i = 0; i < m->nu; i++) {
    if (mj_id2name(m.get(), mjOBJ_ACTUATOR, i)[0] == 'b') {
      d->ctrl[i] = 0.5 * m->actuator_ctrlrange[2 * i + 1];
    }
  }
  while (d->time < 0.3) mj_step(m.get(), d.get());
  const auto motion = [&](const char* head) {
    mjtNum difference[4];
    mju_sub(difference, d->xquat + 4 * mj_name2id(m.get(), mjOBJ_BODY, head),
            m->body_quat + 4 * mj_name2id(m.get(), mjOBJ_BODY, head), 4);
    return mju_norm(difference, 4);
  };
  EXPECT_LT(motion("a_C3"), 1e-3);
  EXPECT_GT(motion("b_C3"), 1e-2);
}

// The second torso's damage is found too, under its own name.
TEST_F(TwoTorsosTest, DamageIsNamedWithItsPrefix) {
  std::string both = pair();
  replaceOnce(&both, "<numeric name=\"b_disc:L4/L5\" data=\"",
              "<numeric name=\"b_disc:L4/L5\" data=\"-");
  std::string error;
  EXPECT_FALSE(loadText(both, &error));
  EXPECT_NE(error.find("numeric 'b_disc:L4/L5': Young's modulus"), std::string::npos) << error;
}

}  // namespace
}  // namespace torso
