// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Motions of which every bone is known, found again from pelvis, head and limbs. The whole table is
// made by `torso truth`.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tools/error.h"
#include "tools/posture.h"
#include "tools/retrofit.h"
#include "tools/retrofit_truth.h"

namespace torso::tools {
namespace {

constexpr double kDegree = EIGEN_PI / 180;

const BodyMjcf& body() {
  static const BodyMjcf human(TORSO_MJCF "/human.xml");
  return human;
}

const RetrofitModels& models() {
  static const RetrofitModels both(body());
  return both;
}

// A body that stands in its rest pose, somewhere else and turned, for so many frames.
HeldMotion standing(int frames) {
  const mjModel* m = models().human.get();
  const DataPtr d = makeData(m);
  mj_kinematics(m, d.get());
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(2, Eigen::Vector3d(0, 0, 1)));
  HeldMotion motion;
  motion.name = "standing";
  motion.rate = 30;
  motion.bodies = {"pelvis", "head", "left_upper_arm", "right_upper_arm", "left_lower_arm"};
  for (int frame = 0; frame < frames; frame++) {
    for (const std::string& name : motion.bodies) {
      const int id = mj_name2id(m, mjOBJ_BODY, name.c_str());
      const Eigen::Vector3d p =
          turn * Eigen::Map<const Eigen::Vector3d>(d->xpos + 3 * id) + Eigen::Vector3d(3, -2, 1);
      const mjtNum* x = d->xquat + 4 * id;
      const Eigen::Quaterniond q = turn * Eigen::Quaterniond(x[0], x[1], x[2], x[3]);
      motion.positions.push_back({p.x(), p.y(), p.z()});
      motion.quaternions.push_back({q.w(), q.x(), q.y(), q.z()});
    }
  }
  return motion;
}

class TruthIsFound : public testing::TestWithParam<const char*> {};

TEST_P(TruthIsFound, LevelByLevel) {
  const Truth truth = makeTruth(body(), GetParam(), 30);
  const RetrofitResult result = retrofit(models(), truth.held, RetrofitOptions());
  const TruthErrors errors = compareWithTruth(models(), truth, result);
  EXPECT_LT(errors.worst_level, 3 * kDegree) << errors.worst_level_name;
  for (double region : errors.regions) EXPECT_LT(region, 5 * kDegree);
  EXPECT_LT(errors.worst_scapula, 5 * kDegree);
  EXPECT_LT(errors.position_error, 0.003);
  EXPECT_LT(errors.rotation_error, 1 * kDegree);
  EXPECT_EQ(errors.flagged, 0);
  // No jump that the body itself did not make, but for a tenth of a degree.
  EXPECT_LT(errors.smoothness.largest_jump,
            1.5 * errors.truth_smoothness.largest_jump + 0.1 * kDegree);
  EXPECT_LT(errors.smoothness.gain, 1);
  EXPECT_LT(errors.core_seconds, 1.0 * errors.seconds);
}
INSTANTIATE_TEST_SUITE_P(Retrofit, TruthIsFound, testing::Values("bend and twist", "sit-up"));

TEST(Retrofit, RestStaysAtRestWhereverItStands) {
  const HeldMotion motion = standing(3);
  RetrofitOptions options;
  options.weight = 0;
  const RetrofitResult result = retrofit(models(), motion, options);
  ASSERT_EQ(result.frames.size(), 3u);
  const mjModel* m = models().human.get();
  const DataPtr d = makeData(m);
  for (std::size_t frame = 0; frame < 3; frame++) {
    for (const Eigen::Vector3d& turn : result.frames[frame].turns) {
      EXPECT_LT(turn.norm(), 0.5 * kDegree);
    }
    // Held bones of the whole body are where they were to be.
    mju_copy(d->qpos, result.qpos.data() + frame * m->nq, m->nq);
    mj_kinematics(m, d.get());
    for (std::size_t i = 0; i < motion.bodies.size(); i++) {
      const int id = mj_name2id(m, mjOBJ_BODY, motion.bodies[i].c_str());
      const auto& p = motion.positions[frame * motion.bodies.size() + i];
      EXPECT_LT(mju_dist3(d->xpos + 3 * id, p.data()), 1e-3) << motion.bodies[i];
    }
  }
}

TEST(Retrofit, FlagsWhatNoSpineReachesAndComesBack) {
  HeldMotion motion = standing(6);
  // In the third and fourth frame the head is half a metre to the front.
  for (std::size_t frame : {2, 3}) motion.positions[frame * motion.bodies.size() + 1][0] += 0.5;
  const RetrofitResult result = retrofit(models(), motion, RetrofitOptions());
  EXPECT_TRUE(result.frames[0].flags.empty());
  EXPECT_TRUE(result.frames[1].flags.empty());
  EXPECT_FALSE(result.frames[2].flags.empty());
  EXPECT_GT(result.frames[3].position_error, 0.01);
  EXPECT_LT(result.frames[5].position_error, 0.003);
}

TEST(Retrofit, SaysWhatIsMissing) {
  HeldMotion motion = standing(2);
  motion.positions[3][1] = NAN;
  EXPECT_THROW(retrofit(models(), motion, RetrofitOptions()), Error);
  motion = standing(2);
  motion.bodies[0] = "tail";
  EXPECT_THROW(retrofit(models(), motion, RetrofitOptions()), Error);
  EXPECT_THROW(retrofit(models(), HeldMotion(), RetrofitOptions()), Error);
  EXPECT_THROW(BodyMjcf("<mujoco/>", "empty"), Error);
}

TEST(Smoothness, SeesANarrowBandAndAJump) {
  const auto wave = [](double hertz, double amplitude, int jump) {
    std::vector<std::vector<Eigen::Vector3d>> turns;
    for (int i = 0; i < 120; i++) {
      const double x = amplitude * std::sin(2 * EIGEN_PI * hertz * i / 30);
      turns.push_back({Eigen::Vector3d(0, x + (i >= jump ? 0.05 : 0), 0)});
    }
    return turns;
  };
  const auto slow = wave(1, 0.3, 1000);
  const Smoothness same = smoothness(slow, wave(1, 0.1, 1000), 30);
  EXPECT_GT(same.band, 1);
  EXPECT_LT(same.band, 2);
  EXPECT_NEAR(same.output_share, same.input_share, 1e-9);
  EXPECT_GT(smoothness(slow, wave(4, 0.1, 1000), 30).output_share, 0.9);
  const Smoothness jumped = smoothness(slow, wave(1, 0.1, 60), 30);
  EXPECT_GT(jumped.output_share, 5 * same.output_share);
  EXPECT_GT(jumped.largest_jump, 0.04);
}

}  // namespace
}  // namespace torso::tools
