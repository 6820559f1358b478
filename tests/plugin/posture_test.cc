// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// The pelvis held and the servos at zero: the spine comes to rest and keeps its curves.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/plugin/fixture.h"

namespace torso {
namespace {

constexpr double kDegree = M_PI / 180;

class PostureTest : public PluginTest {
 protected:
  PostureTest() {
    std::string text = modelText("human.xml");
    fixPelvis(&text);
    m = loadText(text);
    m->opt.collision = mjCOL_PAIR;  // the legs hang free of the floor
    for (int i = 1; i < m->nbody; i++) {
      const std::string name = mj_id2name(m.get(), mjOBJ_BODY, i);
      const bool vertebra =
          name.size() <= 3 && (name[0] == 'L' || name[0] == 'T' || name[0] == 'C');
      if (vertebra || name == "head" || name == "ribcage") spine.push_back(i);
    }
  }
  int body(const char* name) const { return mj_name2id(m.get(), mjOBJ_BODY, name); }
  // Angle of the rotation from one orientation to another [rad].
  static double angle(const mjtNum* from, const mjtNum* to) {
    mjtNum inverse[4], difference[4], turn[3];
    mju_negQuat(inverse, from);
    mju_mulQuat(difference, inverse, to);
    mju_quat2Vel(turn, difference, 1);
    return mju_norm3(turn);
  }
  // Pitch of a body, from its x axis [rad].
  static double pitch(const mjData* d, int body) {
    const mjtNum* R = d->xmat + 9 * body;
    return std::atan2(-R[6], R[0]);
  }
  ModelPtr m;
  std::vector<int> spine;
};

TEST_F(PostureTest, ComesToRestWithinTwoSecondsAndStays) {
  ASSERT_EQ(spine.size(), 24u);
  const DataPtr d = makeData(m.get());
  mj_forward(m.get(), d.get());
  const DataPtr start = copyData(m.get(), d.get());
  while (d->time < 2) mj_step(m.get(), d.get());
  mj_forward(m.get(), d.get());
  double speed = 0;
  for (int i : spine) speed = std::max(speed, mju_norm3(d->cvel + 6 * i));
  const DataPtr rest = copyData(m.get(), d.get());

  double drift = 0;
  const char* drifting = "";
  while (d->time < 12) {
    mj_step(m.get(), d.get());
    for (int i : spine) {
      const double turned = angle(rest->xquat + 4 * i, d->xquat + 4 * i);
      if (turned <= drift) continue;
      drift = turned;
      drifting = mj_id2name(m.get(), mjOBJ_BODY, i);
    }
  }
  std::printf("at 2 s: %.3f deg/s; then in 10 s: %.4f deg (%s)\n", speed / kDegree, drift / kDegree,
              drifting);
  EXPECT_LT(speed, 1 * kDegree);
  EXPECT_LT(drift, 0.1 * kDegree);

  // Curves as the angle between the bodies at their ends, against the anatomy's.
  const auto change = [&](const char* lower, const char* upper) {
    return (pitch(d.get(), body(upper)) - pitch(d.get(), body(lower)) -
            pitch(start.get(), body(upper)) + pitch(start.get(), body(lower))) /
           kDegree;
  };
  std::printf("change of curve: L1-S1 %.2f deg, T1-T12 %.2f deg, C3-C7 %.2f deg; head %.2f deg\n",
              change("pelvis", "L1"), change("T12", "T1"), change("C7", "C3"),
              change("pelvis", "head"));
  EXPECT_LT(std::abs(change("pelvis", "L1")), 5);
  EXPECT_LT(std::abs(change("T12", "T1")), 5);
  EXPECT_LT(std::abs(change("C7", "C3")), 5);
  // The model and its load are mirror symmetric.
  EXPECT_NEAR(d->xpos[3 * body("head") + 1], 0, 1e-3);
}

}  // namespace
}  // namespace torso
