// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/body.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

namespace torso {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

class BodyTest : public ::testing::Test {
 protected:
  std::vector<std::string> bodies() const {
    std::vector<std::string> names = {"pelvis", "ribcage", "head"};
    for (const Vertebra& v : anatomy.vertebrae) names.push_back(v.name);
    for (const char* side : {"left_", "right_"}) {
      for (const char* part :
           {"clavicle", "scapula", "upper_arm", "lower_arm", "hand", "thigh", "shin", "foot"}) {
        names.push_back(std::string(side) + part);
      }
    }
    return names;
  }
  const Anatomy anatomy = Anatomy::load(TORSO_ANATOMY_DIR);
};

TEST_F(BodyTest, MassesAddUpToTheWholeBody) {
  double sum = 0;
  for (const std::string& body : bodies()) {
    const double mass = bodyInertial(anatomy, body).mass;
    EXPECT_GT(mass, 0.05) << body;
    sum += mass;
  }
  EXPECT_NEAR(sum, anatomy.mass(), 1e-9);
  EXPECT_NEAR(sum, 72, 0.5);
}

// A real body's principal moments are positive, and none exceeds the sum of the other two.
TEST_F(BodyTest, InertiasBelongToRealBodies) {
  for (const std::string& body : bodies()) {
    const Inertial inertial = bodyInertial(anatomy, body);
    EXPECT_LT((inertial.inertia - inertial.inertia.transpose()).norm(), 1e-12) << body;
    const Vector3d I = Eigen::SelfAdjointEigenSolver<Matrix3d>(inertial.inertia).eigenvalues();
    EXPECT_GT(I[0], 0) << body;
    EXPECT_LE(I[2], I[0] + I[1]) << body;
    // Radii of gyration between a centimetre and the size of a man.
    EXPECT_GT(std::sqrt(I[0] / inertial.mass), 0.01) << body;
    EXPECT_LT(std::sqrt(I[2] / inertial.mass), 0.2) << body;
  }
}

TEST_F(BodyTest, RightIsTheMirrorOfLeft) {
  const Matrix3d M = Vector3d(1, -1, 1).asDiagonal();
  for (const std::string& body : bodies()) {
    const Inertial inertial = bodyInertial(anatomy, body);
    const auto [side, name] = splitSide(body);
    if (side == Side::kLeft) {
      const Inertial right = bodyInertial(anatomy, "right_" + name);
      EXPECT_EQ(inertial.mass, right.mass) << name;
      EXPECT_EQ(mirror(inertial.com), right.com) << name;
      EXPECT_LT((M * inertial.inertia * M - right.inertia).norm(), 1e-12) << name;
      EXPECT_EQ(mirror(bodyFrame(anatomy, body).translation()),
                bodyFrame(anatomy, "right_" + name).translation());
      EXPECT_GT(inertial.com.y(), 0) << name;
    } else if (side == Side::kMiddle) {
      EXPECT_NEAR(inertial.com.y(), 0, 1e-12) << body;
      EXPECT_NEAR(inertial.inertia(0, 1), 0, 1e-12) << body;
      EXPECT_NEAR(inertial.inertia(1, 2), 0, 1e-12) << body;
    }
  }
}

// What a vertebra gives to the rib cage is lost to none: mass and first moment of the slices.
TEST_F(BodyTest, RibCageAndVertebraeShareTheSlices) {
  double mass = 0, expected_mass = 0;
  Vector3d moment = Vector3d::Zero(), expected_moment = Vector3d::Zero();
  const auto add = [&](const std::string& body) {
    const Inertial inertial = bodyInertial(anatomy, body);
    mass += inertial.mass;
    moment += inertial.mass * inertial.com;
  };
  add("ribcage");
  for (const Vertebra& v : anatomy.vertebrae) {
    add(v.name);
    expected_mass += v.slice_mass;
    expected_moment += v.slice_mass * (v.frame() * v.slice_com);
  }
  EXPECT_NEAR(mass, expected_mass, 1e-12);
  EXPECT_LT((moment - expected_moment).norm(), 1e-12);
}

// A standing body is balanced: its centre of mass lies over the feet.
TEST_F(BodyTest, CentreOfMassIsOverTheFeet) {
  Vector3d moment = Vector3d::Zero();
  for (const std::string& body : bodies()) {
    const Inertial inertial = bodyInertial(anatomy, body);
    moment += inertial.mass * inertial.com;
  }
  const Vector3d com = moment / anatomy.mass();
  EXPECT_NEAR(com.y(), 0, 1e-12);
  EXPECT_GT(com.x(), anatomy.landmark("heel").x());
  EXPECT_LT(com.x(), anatomy.landmark("toe_tip").x());
  // 0.55 to 0.58 of stature above the ground (men, Dempster 1955).
  const double height = (com.z() - anatomy.landmark("sole").z()) / anatomy.stature();
  EXPECT_GT(height, 0.54);
  EXPECT_LT(height, 0.59);
}

TEST_F(BodyTest, NamesAndLevels) {
  EXPECT_EQ(splitSide("left_hand"), (std::pair{Side::kLeft, std::string("hand")}));
  EXPECT_EQ(splitSide("right_foot"), (std::pair{Side::kRight, std::string("foot")}));
  EXPECT_EQ(splitSide("pelvis"), (std::pair{Side::kMiddle, std::string("pelvis")}));
  EXPECT_EQ(pairedName(anatomy, Side::kLeft, "hand"), "left_hand");
  EXPECT_EQ(pairedName(anatomy, Side::kRight, "ribcage"), "ribcage");
  EXPECT_EQ(pairedName(anatomy, Side::kRight, "L4"), "L4");
  EXPECT_EQ(bodyOfLevel(anatomy, "S1"), "pelvis");
  EXPECT_EQ(bodyOfLevel(anatomy, "C2"), "head");
  EXPECT_EQ(bodyOfLevel(anatomy, "T4"), "T4");
  EXPECT_THROW(bodyFrame(anatomy, "left_wing"), std::runtime_error);
  EXPECT_THROW(bodyInertial(anatomy, "left_wing"), std::runtime_error);
}

}  // namespace
}  // namespace torso
