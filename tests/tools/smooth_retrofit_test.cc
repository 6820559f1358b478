// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// A retrofit is as smooth as its input, also where the spine has two equilibria.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tools/course_limit.h"
#include "tools/posture.h"
#include "tools/retrofit.h"
#include "tools/smoothness.h"

namespace torso::tools {
namespace {

using Eigen::MatrixXd;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kDegree = EIGEN_PI / 180;

double largestSecond(const MatrixXd& x, const VectorXd& limit) {
  double largest = 0;
  for (Eigen::Index t = 1; t + 1 < x.rows(); t++) {
    const double second = (x.row(t + 1) - 2 * x.row(t) + x.row(t - 1)).norm();
    largest = std::max(largest, second / limit[t]);
  }
  return largest;
}

// A wave, with a step half way.
MatrixXd wave(double step) {
  MatrixXd course(121, 2);
  for (int t = 0; t < 121; t++) {
    course.row(t) << std::sin(0.1 * (t - 60)) + (t > 60 ? step : t < 60 ? -step : 0), 0.1 * t;
  }
  return course;
}

TEST(CourseLimit, LeavesWhatIsWithinIt) {
  const MatrixXd course = wave(0);
  const VectorXd limit = VectorXd::Constant(121, 0.011);  // the wave itself: 0.01
  EXPECT_LT((limitSecondDifferences(course, limit) - course).norm(), 1e-9);
}

TEST(CourseLimit, SpreadsAStepWithoutLag) {
  const MatrixXd course = wave(0.5);
  const VectorXd limit = VectorXd::Constant(121, 0.03);
  EXPECT_GT(largestSecond(course, limit), 10);
  const MatrixXd smooth = limitSecondDifferences(course, limit);
  EXPECT_LT(largestSecond(smooth, limit), 1.1);
  // The course is odd about its middle, and so is what comes of it.
  EXPECT_LT((smooth.col(0) + smooth.col(0).reverse()).cwiseAbs().maxCoeff(), 1e-6);
  // Far from the step nothing changes, and nowhere more than by its height.
  EXPECT_LT((smooth - course).topRows(20).cwiseAbs().maxCoeff(), 0.02);
  EXPECT_LT((smooth - course).cwiseAbs().maxCoeff(), 0.6);
}

TEST(CourseLimit, LetsTheInputJump) {
  const MatrixXd course = wave(0.5);
  VectorXd limit = VectorXd::Constant(121, 0.03);
  limit.segment(59, 3).setConstant(2);
  EXPECT_LT((limitSecondDifferences(course, limit) - course).cwiseAbs().maxCoeff(), 0.01);
}

// Our body at rest in a world of its own, but for the head: sunk towards the shoulders and nodding,
// it goes forward, back and home again once in the time of the motion.
HeldMotion sunkenHead(const mjModel* m, int frames, double down, double nod) {
  const DataPtr d = makeData(m);
  mj_kinematics(m, d.get());
  HeldMotion motion;
  motion.name = "sunken head";
  motion.rate = 30;
  motion.bodies = {"pelvis", "head", "left_upper_arm", "right_upper_arm"};
  for (int f = 0; f < frames; f++) {
    const double phase = 2 * EIGEN_PI * f / (frames - 1), share = 0.5 - 0.5 * std::cos(phase);
    for (const std::string& name : motion.bodies) {
      const int id = mj_name2id(m, mjOBJ_BODY, name.c_str());
      Vector3d p(d->xpos + 3 * id);
      const mjtNum* x = d->xquat + 4 * id;
      Quaterniond q(x[0], x[1], x[2], x[3]);
      if (name == "head") {
        p += Vector3d(0.06 * std::sin(phase), 0, -down * std::sin(0.5 * phase));
        q = Eigen::AngleAxisd(nod * share, Vector3d::UnitY()) * q;
      }
      motion.positions.push_back({p.x(), p.y(), p.z()});
      motion.quaternions.push_back({q.w(), q.x(), q.y(), q.z()});
    }
  }
  return motion;
}

std::vector<std::vector<Vector3d>> turnsOf(const RetrofitResult& result) {
  std::vector<std::vector<Vector3d>> turns;
  for (const RetrofitFrame& frame : result.frames) turns.push_back(frame.turns);
  return turns;
}

// Frame by frame the neck snaps from one equilibrium to another; over time it does not, and the
// head is held as well.
TEST(SmoothRetrofit, NeckDoesNotSnap) {
  const RetrofitModels models(BodyMjcf(TORSO_MJCF "/human.xml"));
  const HeldMotion motion = sunkenHead(models.human.get(), 40, 0.04, 0.5);
  const std::vector<std::string> names = Posture(models.human.get()).names();
  const ExplainedJumps explained(motion);
  RetrofitOptions options;
  options.over_time = false;
  const RetrofitResult before = retrofit(models, motion, options);
  const RetrofitResult after = retrofit(models, motion, RetrofitOptions());
  EXPECT_GT(explained.largestBeyond(names, turnsOf(before)), 5 * kDegree);
  EXPECT_LT(explained.largestBeyond(names, turnsOf(after)), 2 * kDegree);
  const Smoothness rough = smoothness(heldTurns(motion), turnsOf(before), motion.rate);
  const Smoothness smooth = smoothness(heldTurns(motion), turnsOf(after), motion.rate);
  EXPECT_LT(smooth.largest_jump, 2 * kDegree);
  EXPECT_LT(smooth.output_share, 0.5 * rough.output_share);
  const auto median = [](const RetrofitResult& result) {
    std::vector<double> errors;
    for (const RetrofitFrame& frame : result.frames) errors.push_back(frame.position_error);
    std::nth_element(errors.begin(), errors.begin() + errors.size() / 2, errors.end());
    return errors[errors.size() / 2];
  };
  EXPECT_LT(median(after), median(before) + 0.0005);
}

TEST(ExplainedJumps, AreOfTheBonesThatMoveTheJoint) {
  const RetrofitModels models(BodyMjcf(TORSO_MJCF "/human.xml"));
  HeldMotion motion = sunkenHead(models.human.get(), 9, 0, 0);
  const auto bone = [&](int frame, int body) { return 4 * frame + body; };
  for (int f = 0; f < 9; f++) {  // the left arm: a turn about its own length, past half a turn
    auto& q = motion.quaternions[bone(f, 2)];
    const Eigen::AngleAxisd turn(f, Vector3d::UnitZ());
    const Quaterniond turned = Quaterniond(q[0], q[1], q[2], q[3]) * turn;
    q = {turned.w(), turned.x(), turned.y(), turned.z()};
    motion.positions[bone(f, 1)] = motion.positions[bone(0, 1)];
  }
  motion.positions[bone(6, 3)][0] += 0.015;  // the right shoulder: a tenth of the lever
  const ExplainedJumps explained(motion);
  EXPECT_NEAR(explained.of("left_scapula")[3], 0, 1e-6);
  EXPECT_NEAR(explained.of("C7/T1")[6], 0, 1e-6);
  EXPECT_NEAR(explained.of("right_scapula")[6], 0.24 * 0.2, 1e-6);
  EXPECT_NEAR(explained.of("right_scapula")[2], 0, 1e-6);
  EXPECT_NEAR(explained.of("L4/L5")[6], 0.12 * 0.2, 1e-6);
  // The turn that goes on at one speed is no jump.
  for (const std::vector<Vector3d>& turns : heldTurns(motion)) EXPECT_EQ(turns.size(), 3u);
  const auto turns = heldTurns(motion);
  EXPECT_NEAR((turns[8][1] - turns[0][1]).norm(), 8, 1e-6);
}

}  // namespace
}  // namespace torso::tools
