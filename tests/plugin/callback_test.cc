// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Callbacks that were installed before ours are called, and come back when ours go.

#include <gtest/gtest.h>

#include <cstring>

#include "tests/plugin/fixture.h"

namespace torso {
namespace {

int passive_calls, sensor_calls, collision_calls;
mjfCollision stock_collision;

void countPassive(const mjModel*, mjData*) { passive_calls++; }
void countSensor(const mjModel*, mjData*, int) { sensor_calls++; }
int countCollision(const mjModel* m, const mjData* d, mjContact* con, int g1, int g2,
                   mjtNum margin) {
  collision_calls++;
  return stock_collision(m, d, con, g1, g2, margin);
}

mjfCollision& collisionEntry() { return mjCOLLISIONFUNC[mjGEOM_SPHERE][mjGEOM_ELLIPSOID]; }

// A sphere that sinks into an ellipsoid.
const char* kSphereOnEllipsoid =
    "<body name='stand' pos='0 3 1'><geom name='egg' type='ellipsoid' size='.1 .2 .3'/></body>"
    "<body name='ball' pos='.02 3.03 1.38'><freejoint/><geom name='ball' size='.1'/></body>";

class CallbackTest : public PluginTest {
 protected:
  CallbackTest() {
    torso_uninstall();
    stock_collision = collisionEntry();
    passive_calls = sensor_calls = collision_calls = 0;
  }
  ~CallbackTest() override {
    torso_uninstall();
    mjcb_passive = nullptr;
    mjcb_sensor = nullptr;
    collisionEntry() = stock_collision;
    torso_install();
  }
  static std::string scene() {
    return std::string("<mujoco><worldbody>") + kSphereOnEllipsoid + "</worldbody></mujoco>";
  }
  static std::string torsoWithScene() {
    std::string text = modelText("torso.xml");
    replaceOnce(&text, "<worldbody>", std::string("<worldbody>") + kSphereOnEllipsoid);
    return text;
  }
};

TEST_F(CallbackTest, UninstallRestoresMujocosOwn) {
  EXPECT_EQ(torso_isInstalled(), 0);
  EXPECT_EQ(mjcb_passive, nullptr);
  EXPECT_EQ(mjcb_sensor, nullptr);
  torso_install();
  EXPECT_EQ(torso_isInstalled(), 1);
  EXPECT_NE(mjcb_passive, nullptr);
  EXPECT_NE(mjcb_sensor, nullptr);
  EXPECT_NE(collisionEntry(), stock_collision);
  torso_uninstall();
  EXPECT_EQ(mjcb_passive, nullptr);
  EXPECT_EQ(mjcb_sensor, nullptr);
  EXPECT_EQ(collisionEntry(), stock_collision);
}

TEST_F(CallbackTest, EarlierCallbacksAreCalledAndRestored) {
  mjcb_passive = countPassive;
  mjcb_sensor = countSensor;
  collisionEntry() = countCollision;
  torso_install();
  torso_install();  // again, which must not make ours its own predecessor
  const ModelPtr m = loadText(torsoWithScene());
  const DataPtr d = makeData(m.get());
  passive_calls = sensor_calls = collision_calls = 0;
  mj_forward(m.get(), d.get());
  EXPECT_EQ(passive_calls, 1);
  EXPECT_GT(sensor_calls, 0);
  EXPECT_EQ(collision_calls, 1) << "for the egg and the ball, not for facets";
  torso_uninstall();
  EXPECT_EQ(mjcb_passive, countPassive);
  EXPECT_EQ(mjcb_sensor, countSensor);
  EXPECT_EQ(collisionEntry(), countCollision);
}

// A program that sets its own callback after us keeps it, whatever we do.
TEST_F(CallbackTest, LaterCallbacksAreLeftAlone) {
  torso_install();
  mjcb_passive = countPassive;
  EXPECT_EQ(torso_isInstalled(), 0);
  torso_uninstall();
  EXPECT_EQ(mjcb_passive, countPassive);
  torso_install();
  EXPECT_EQ(torso_isInstalled(), 1);
  const ModelPtr m = loadModel("torso.xml");
  const DataPtr d = makeData(m.get());
  passive_calls = 0;
  mj_forward(m.get(), d.get());
  EXPECT_EQ(passive_calls, 1);
}

TEST_F(CallbackTest, OtherSpheresAndEllipsoidsCollideAsInStockMujoco) {
  const auto contactOf = [](const mjModel* m) {
    const DataPtr d = makeData(m);
    mj_forward(m, d.get());
    for (int i = 0; i < d->ncon; i++) {
      const mjContact& con = d->contact[i];
      if (con.geom1 == mj_name2id(m, mjOBJ_GEOM, "ball")) {
        return std::vector<mjtNum>(&con.dist, con.frame + 9);
      }
    }
    return std::vector<mjtNum>();
  };
  const ModelPtr alone = loadText(scene());
  const std::vector<mjtNum> stock = contactOf(alone.get());
  ASSERT_EQ(stock.size(), 13u);
  EXPECT_LT(stock[0], 0) << "they touch";
  torso_install();
  EXPECT_EQ(contactOf(alone.get()), stock);
  EXPECT_EQ(contactOf(loadText(torsoWithScene()).get()), stock);
}

TEST_F(CallbackTest, TorsoWorksAfterReinstallation) {
  torso_install();
  const ModelPtr m = loadModel("torso.xml");
  const auto run = [&] {
    DataPtr d = makeData(m.get());
    for (int i = 0; i < 5; i++) mj_step(m.get(), d.get());
    return d;
  };
  const DataPtr before = run();
  torso_uninstall();
  const DataPtr without = run();
  torso_install();
  const DataPtr after = run();
  EXPECT_EQ(differences(m.get(), before.get(), after.get()), "");
  EXPECT_NE(differences(m.get(), before.get(), without.get()), "");
  for (int i = 0; i < m->nuserdata; i++) ASSERT_EQ(without->userdata[i], 0);
}

}  // namespace
}  // namespace torso
