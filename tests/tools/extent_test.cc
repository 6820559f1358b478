// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/extent.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/tools/model_from_text.h"
#include "tools/mujoco_support.h"

namespace torso::tools {
namespace {

Interval extentOf(const mjModel* m, const mjtNum direction[3]) {
  const DataPtr d = makeData(m);
  mj_kinematics(m, d.get());
  return extent(m, d.get(), direction);
}

// Half widths along x of shapes turned by 30 degrees about y, in closed form.
TEST(Extent, IsExactForEveryShape) {
  const double s = std::sin(mjPI / 6), c = std::cos(mjPI / 6);
  const struct {
    const char* geom;
    double half;
  } kCases[] = {
      {"type='sphere' size='0.3'", 0.3},
      {"type='capsule' size='0.1 0.5'", 0.1 + 0.5 * s},
      {"type='ellipsoid' size='0.1 0.2 0.5'", std::hypot(0.1 * c, 0.5 * s)},
      {"type='cylinder' size='0.1 0.5'", 0.1 * c + 0.5 * s},
      {"type='box' size='0.1 0.2 0.5'", 0.1 * c + 0.5 * s},
      {"type='mesh' mesh='box'", 0.1 * c + 0.5 * s},
  };
  for (const auto& test : kCases) {
    const ModelPtr m = modelFromText(
        std::string("<asset><mesh name='box' vertex='-.1 -.2 -.5  .1 -.2 -.5  -.1 .2 -.5  .1 .2 -.5"
                    "  -.1 -.2 .5  .1 -.2 .5  -.1 .2 .5  .1 .2 .5'/></asset>"
                    "<worldbody><geom type='plane' size='9 9 9'/><body pos='7 0 0' euler='0 30 0'>"
                    "<geom ") +
        test.geom + "/></body></worldbody>");
    const mjtNum x[3] = {1, 0, 0}, minus_two_x[3] = {-2, 0, 0};
    const Interval along = extentOf(m.get(), x);
    EXPECT_NEAR(along.min, 7 - test.half, 1e-6) << test.geom;
    EXPECT_NEAR(along.max, 7 + test.half, 1e-6) << test.geom;
    EXPECT_NEAR(extentOf(m.get(), minus_two_x).max, -2 * (7 - test.half), 1e-6) << test.geom;
  }
}

TEST(Extent, StatureIsFromTheLowestToTheHighestGeom) {
  const ModelPtr m = modelFromText(
      "<worldbody><geom type='plane' size='9 9 9'/>"
      "<geom type='box' size='1 1 5'/>"
      "<body pos='0 0 0.7'><freejoint/>"
      "<geom type='capsule' size='0.1' fromto='0 0 -0.5 0 0 0.5'/>"
      "<body pos='0 0 0.8'><geom type='sphere' size='0.15' contype='0' "
      "conaffinity='0'/></body></body></worldbody>");
  EXPECT_NEAR(stature(m.get()), 0.8 + 0.15 + 0.5 + 0.1, 1e-12);
}

TEST(Extent, AModelWithoutGeomsHasNone) {
  const ModelPtr m = modelFromText(
      "<worldbody><body><joint/><inertial pos='0 0 0' mass='1' "
      "diaginertia='1 1 1'/></body></worldbody>");
  EXPECT_EQ(stature(m.get()), 0);
}

}  // namespace
}  // namespace torso::tools
