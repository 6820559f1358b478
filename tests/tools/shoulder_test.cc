// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "tests/tools/shipped_anatomy.h"
#include "tools/bone_files.h"
#include "tools/shoulder_rhythm.h"

namespace torso::tools {
namespace {

constexpr double kDegree = EIGEN_PI / 180;

const ShoulderReport& report() {
  static const ShoulderReport r = [] {
    const Skeleton skeleton =
        readSkeleton(anatomy(), TORSO_MJCF "/assets", ShoulderBench::bodies());
    ShoulderBench bench(anatomy(), skeleton);
    return measureShoulder(bench, 20,
                           readScapularMuscles(TORSO_ANATOMY_DIR "/scapular_muscles.csv"));
  }();
  return r;
}

// Between Inman's line and McClure's bone pins, but for 3 degrees, and two to one.
TEST(Shoulder, ScapulaFollowsTheArmAsPublished) {
  const auto published = readShoulderRhythm(TORSO_ANATOMY_DIR "/shoulder_rhythm.csv");
  int compared = 0;
  for (const PublishedRhythm& row : published) {
    if (row.quantity != "upward_rotation" || row.elevation > 121 * kDegree) continue;
    const double ours = upwardRotationAt(report().raising, row.elevation) / kDegree;
    const double value = row.value / kDegree;
    if (row.source == "Inman 1944" && row.elevation > 31 * kDegree) {
      EXPECT_GT(ours, value - 3);
    }
    if (row.source == "McClure 2001") {
      EXPECT_LT(ours, value + 3);
    }
    compared++;
  }
  EXPECT_EQ(compared, 8);
  EXPECT_GT(report().raising_ratio, 1.8);
  EXPECT_LT(report().raising_ratio, 2.6);
}

// At the top the scapula is tilted back and the clavicle has turned as bone pins say, but for a few
// degrees; external rotation is too small, see README.
TEST(Shoulder, ScapulaTiltsAndClavicleTurnsAsPublished) {
  const ShoulderPose& top = report().raising.back();
  int compared = 0;
  for (const PublishedRhythm& row : readShoulderRhythm(TORSO_ANATOMY_DIR "/shoulder_rhythm.csv")) {
    SCOPED_TRACE(row.quantity);
    const double ours = row.quantity == "posterior_tilt"        ? top.posterior_tilt
                        : row.quantity == "clavicle_elevation"  ? top.clavicle_elevation
                        : row.quantity == "clavicle_retraction" ? top.clavicle_retraction
                        : row.quantity == "clavicle_posterior_rotation"
                            ? top.clavicle_posterior_rotation
                            : NAN;
    if (std::isnan(ours)) continue;
    EXPECT_NEAR(ours / kDegree, row.value / kDegree, 8);
    compared++;
  }
  EXPECT_EQ(compared, 4);
}

// In the setting phase the scapula does less than afterwards.
TEST(Shoulder, ScapulaSetsBeforeItTurns) {
  const auto& poses = report().raising;
  const double setting =
      upwardRotationAt(poses, 40 * kDegree) - upwardRotationAt(poses, 20 * kDegree);
  const double after =
      upwardRotationAt(poses, 90 * kDegree) - upwardRotationAt(poses, 70 * kDegree);
  EXPECT_LT(setting, 0.6 * after);
}

TEST(Shoulder, ScapulaGlidesOnTheThoraxAndDoesNotCutIntoIt) {
  EXPECT_LT(report().gliding_distance, 3e-3);
  EXPECT_GT(report().clearance, 0);
  // Nor wing.
  EXPECT_LT(report().medial_border, report().rest.medial_border + 5e-3);
  EXPECT_LT(report().inferior_angle, report().rest.inferior_angle + 5e-3);
}

// The servos move the clavicle by most of their range, and the medial border stays on the ribs.
TEST(Shoulder, ShrugsProtractsAndRetracts) {
  for (const auto& [motion, poses] : report().girdle) {
    const ShoulderPose& end = poses.back();
    SCOPED_TRACE(girdleMotionName(motion));
    if (motion == GirdleMotion::kElevation) {
      EXPECT_GT(end.clavicle_elevation, 20 * kDegree);
    }
    if (motion == GirdleMotion::kDepression) {
      EXPECT_LT(end.clavicle_elevation, -4 * kDegree);
    }
    if (motion == GirdleMotion::kProtraction) {
      EXPECT_LT(end.clavicle_retraction, -10 * kDegree);
    }
    if (motion == GirdleMotion::kRetraction) {
      EXPECT_GT(end.clavicle_retraction, 10 * kDegree);
    }
    EXPECT_LT(end.medial_border, poses.front().medial_border + 0.01);
  }
}

}  // namespace
}  // namespace torso::tools
