// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Bodies with other limbs.

#include "model/limb_lengths.h"

#include <gtest/gtest.h>

#include "model/body.h"

namespace torso {
namespace {

using Eigen::Vector3d;

double length(const Anatomy& a, const char* from, const char* to) {
  return (a.landmark(to) - a.landmark(from)).norm();
}

TEST(LimbLengthsTest, OnlyTheNamedSegmentsGrow) {
  const Anatomy a = Anatomy::load(TORSO_ANATOMY_DIR);
  const Anatomy b = withLimbs(a, {{"thigh", 1.1}, {"lower_arm", 0.9}, {"foot", 1.2}});
  EXPECT_NEAR(length(b, "hip_joint_centre", "knee"), 1.1 * length(a, "hip_joint_centre", "knee"),
              1e-12);
  EXPECT_NEAR(length(b, "knee", "ankle"), length(a, "knee", "ankle"), 1e-12);
  EXPECT_NEAR(length(b, "heel", "toe_tip"), 1.2 * length(a, "heel", "toe_tip"), 1e-12);
  EXPECT_NEAR(length(b, "glenohumeral_centre_GH", "elbow"),
              length(a, "glenohumeral_centre_GH", "elbow"), 1e-12);
  EXPECT_NEAR(length(b, "elbow", "wrist"), 0.9 * length(a, "elbow", "wrist"), 1e-12);
  // What hangs on a segment moves along, in shape and mass the same.
  for (const char* body : {"left_shin", "right_shin", "left_hand"}) {
    const Inertial x = bodyInertial(a, body), y = bodyInertial(b, body);
    EXPECT_NEAR(x.mass, y.mass, 1e-12);
    EXPECT_TRUE((y.com - bodyFrame(b, body).translation())
                    .isApprox(x.com - bodyFrame(a, body).translation(), 1e-9))
        << body;
  }
  EXPECT_NEAR(bodyInertial(b, "left_thigh").mass,
              1.1 * 1.1 * 1.1 * bodyInertial(a, "left_thigh").mass, 1e-9);
  for (const char* body : {"pelvis", "L3", "head", "left_scapula", "left_thigh"}) {
    EXPECT_TRUE(bodyFrame(a, body).isApprox(bodyFrame(b, body))) << body;
  }
}

TEST(LimbLengthsTest, BadFactorsAreRefused) {
  const Anatomy a = Anatomy::load(TORSO_ANATOMY_DIR);
  EXPECT_THROW(withLimbs(a, {{"pelvis", 1.1}}), std::invalid_argument);
  EXPECT_THROW(withLimbs(a, {{"thigh", 0}}), std::invalid_argument);
}

}  // namespace
}  // namespace torso
