// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Measures of an impact against closed forms, and falls against the mechanics of a point mass.

#include "tools/fall.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/tools/shipped_anatomy.h"
#include "tools/error.h"
#include "tools/impact.h"
#include "tools/torso_mjcf.h"

namespace torso::tools {
namespace {

constexpr double kGravity = 9.81;

// Means of a half sine over each interval: peak [g], length [s].
std::vector<double> halfSine(double peak, double length, double interval) {
  std::vector<double> samples(20, 0.0);
  for (double t = 0; t + interval < length + 1e-9; t += interval) {
    const double w = M_PI / length;
    samples.push_back(peak * (std::cos(w * t) - std::cos(w * (t + interval))) / (w * interval));
  }
  samples.resize(samples.size() + 20, 0.0);
  return samples;
}

// The best window of a half sine is centred, half as long as x = w t with x cot x = 3/5: the
// derivative of its HIC by its length vanishes there.
TEST(Impact, HicOfAHalfSineIsTheClosedForm) {
  double x = 1;
  for (int i = 0; i < 50; i++) x = std::atan(x / 0.6);
  for (const auto& [peak, length] : {std::pair{100.0, 0.008}, {250.0, 0.004}}) {
    const double exact = 2 * x / M_PI * length * std::pow(peak * std::sin(x) / x, 2.5);
    EXPECT_NEAR(headInjuryCriterion(halfSine(peak, length, 1e-4), 1e-4).hic, exact, 0.002 * exact);
  }
  // A pulse of which 15 ms are only a part.
  const double length = 0.06, y = M_PI * 0.0075 / length;
  const double exact = 0.015 * std::pow(80 * std::sin(y) / y, 2.5);
  EXPECT_NEAR(headInjuryCriterion(halfSine(80, length, 1e-4), 1e-4).hic, exact, 0.002 * exact);
  EXPECT_EQ(headInjuryCriterion({}, 1e-4).hic, 0);
}

// A half sine exceeds its value at a time 1.5 ms before or after its middle for 3 ms.
TEST(Impact, ExceededForThreeMillisecondsOfAHalfSine) {
  const double exact = 100 * std::cos(M_PI * 0.0015 / 0.01);
  EXPECT_NEAR(exceededFor(halfSine(100, 0.01, 1e-4), 1e-4), exact, 0.01 * exact);
  // In sum: two pulses of 2 ms.
  std::vector<double> pulses(100, 0.0);
  for (int i = 0; i < 20; i++) pulses[i] = pulses[50 + i] = 40;
  EXPECT_EQ(exceededFor(pulses, 1e-4), 40);
  EXPECT_EQ(exceededFor(pulses, 1e-4, 0.005), 0);
  EXPECT_EQ(exceededFor({5, 5}, 1e-4), 0);
}

ModelPtr ball(const std::string& solref) {
  return compileModel(
      "<mujoco><option timestep='0.001'/><worldbody>"
      "<geom type='plane' size='0 0 1' solref='" +
          solref +
          "' solimp='0.9 0.9 0.001'/>"
          "<body name='head' pos='0 0 0.1'><freejoint/>"
          "<geom type='sphere' size='0.1' mass='5' condim='1' solref='" +
          solref +
          "' solimp='0.9 0.9 0.001'/>"
          "</body></worldbody></mujoco>",
      "ball");
}

// MuJoCo's contact of time constant T and damping ratio 1 is, for a single body and constant
// impedance d, the critically damped spring r'' = -d (2 / (d T) r' + r / (d T)^2) - (1 - d) g: a
// ball that comes with speed v is stopped by 2 v / T at first, and by less from then on.
TEST(Fall, BallIsStoppedAsByASpringAndDamper) {
  const double T = 0.02, height = 0.5;
  const ModelPtr m = ball("0.02 1");
  FallOptions options;
  options.height = height;
  options.seconds = 1;
  options.rate = 10000;
  const Fall f = fall(m.get(), "ball", options, 0);
  const double speed = std::sqrt(2 * kGravity * height);
  EXPECT_NEAR(f.touch, speed / kGravity, 2e-4);
  EXPECT_EQ(f.head_touch, f.touch);
  EXPECT_NEAR(f.weight, 5 * kGravity, 1e-9);
  const FallPeaks peaks = peaksOf(f);
  const double stop = 2 * speed / T + 0.9 * kGravity;
  EXPECT_NEAR(peaks.force, 5 * stop, 0.02 * 5 * stop);
  EXPECT_NEAR(peaks.head, stop / kStandardGravity, 0.02 * stop / kStandardGravity);
  EXPECT_EQ(landingPeaksOf(f).force, peaks.force);
  EXPECT_LT(peaks.head_3ms, peaks.head);
  EXPECT_GT(peaks.hic15, 0);
  // Free fall shows nothing, lying shows one g and the weight.
  EXPECT_NEAR(f.head_acceleration[100], 0, 1e-9);
  EXPECT_NEAR(f.head_acceleration.back(), kGravity / kStandardGravity, 0.01);
  EXPECT_NEAR(f.floor_force.back().z(), 5 * kGravity, 0.5);
}

// All that the floor gives turns the body's momentum: with the weight, from falling to its end.
TEST(Fall, ForceOfTheFloorStopsTheBody) {
  for (const TorsoKind kind : {TorsoKind::kFixed, TorsoKind::kSimple, TorsoKind::kDetailed}) {
    MjcfOptions mjcf;
    mjcf.limbs = true;
    mjcf.bones = false;
    mjcf.kind = kind;
    std::string text = mjcfText(anatomy(), mjcf);
    text.replace(text.find("<worldbody>"), 11,
                 "<worldbody><geom type='plane' size='0 0 1' friction='0.8'/>");
    const ModelPtr m = compileModel(text, "human");
    FallOptions options;
    options.height = 0.2;
    options.seconds = 0.35;
    options.rate = 1200;
    options.frame_times = {-0.05, 0.08, 9};
    const Fall f = fall(m.get(), "human", options, 3);
    const double fallen = std::sqrt(2 * 0.2 / kGravity);
    EXPECT_NEAR(f.touch, fallen, 0.03);  // a foot hangs a little lower
    EXPECT_LT(f.head_touch, 0);
    ASSERT_EQ(f.frames.size(), 2u);
    // Momentum at the second frame, from the velocities, and from the impulses up to then.
    mjData* d = f.frames[1].get();
    mj_subtreeVel(m.get(), d);
    double impulse = 0;
    const auto steps = static_cast<std::size_t>(std::lround(d->time * options.rate));
    for (std::size_t i = 0; i < steps; i++) impulse += f.floor_force[i].z() * f.interval;
    const double mass = anatomy().mass();
    EXPECT_GT(impulse, 0.1 * mass * kGravity * fallen);
    EXPECT_NEAR(impulse, mass * (d->subtree_linvel[2] + kGravity * d->time), 0.01 * impulse);
  }
}

TEST(Fall, RefusesWhatCannotFall) {
  const auto message = [](const std::string& mjcf) -> std::string {
    const ModelPtr m = compileModel(mjcf, "x");
    try {
      fall(m.get(), "x.xml", FallOptions(), 0);
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  const std::string geom = "<geom type='sphere' size='0.1'/></body></worldbody></mujoco>";
  EXPECT_NE(message("<mujoco><worldbody><body name='head'>" + geom).find("x.xml: no free body"),
            std::string::npos);
  EXPECT_EQ(message("<mujoco><worldbody><body name='skull'><freejoint/>" + geom),
            "x.xml: no body is called 'head'");
}

}  // namespace
}  // namespace torso::tools
