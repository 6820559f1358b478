// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// The generator knows where it put the parts of a vertebra; the search must find them again, from
// the surface alone, wherever the vertebra lies.
#include "model/vertebra_landmarks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "model/bone_mesh.h"
#include "model/simplify.h"
#include "model/tri_mesh.h"

namespace torso {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kDegree = M_PI / 180;

const Anatomy& anatomy() {
  static const Anatomy a = Anatomy::load(TORSO_ANATOMY_DIR);
  return a;
}

// In its vertebra frame.
TriMesh generated(const std::string& level) {
  return transformed(boneMesh(anatomy(), level)[0].mesh,
                     anatomy().vertebra(level).frame().inverse());
}

Isometry3d anyPose(int seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Isometry3d X = Isometry3d::Identity();
  const Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
  X.linear() = q.normalized().toRotationMatrix();
  X.translation() = Vector3d(normal(random), normal(random), normal(random));
  return X;
}

double degreesBetween(const Vector3d& a, const Vector3d& b) {
  return std::acos(std::clamp(a.dot(b), -1.0, 1.0)) / kDegree;
}

// found: in the axes of the vertebra moved by X.
void expectFound(const std::string& level, const VertebraLandmarks& found, const Isometry3d& X,
                 double face_mm, double face_degrees) {
  SCOPED_TRACE(level);
  const Vertebra& v = anatomy().vertebra(level);
  const Isometry3d error = X.inverse() * found.frame;
  EXPECT_LT(error.translation().norm(), 2e-3);
  EXPECT_LT(Eigen::AngleAxisd(error.linear()).angle(), 2 * kDegree);
  const Isometry3d I = X.inverse();
  const auto pitch = [&](const Vector3d& normal) {
    const Vector3d n = I.linear() * normal;
    return std::atan2(n.x(), n.z());
  };
  EXPECT_NEAR(pitch(found.upper_endplate.normal), v.upper_endplate_pitch - v.pitch, 2.5 * kDegree);
  EXPECT_NEAR(pitch(-found.lower_endplate.normal), v.lower_endplate_pitch - v.pitch, 2.5 * kDegree);
  EXPECT_NEAR(found.upper_endplate.width, v.upper_endplate_width, 2e-3);
  EXPECT_NEAR(found.lower_endplate.width, v.lower_endplate_width, 2e-3);
  EXPECT_NEAR(found.upper_endplate.height, v.upper_endplate_depth, 2e-3);
  EXPECT_NEAR(found.lower_endplate.height, v.lower_endplate_depth, 2e-3);
  EXPECT_NEAR(found.body_height_anterior, v.body_height_anterior, 1.5e-3);
  EXPECT_NEAR(found.body_height_posterior, v.body_height_posterior, 1.5e-3);
  EXPECT_NEAR((found.transverse_tip[0] - found.transverse_tip[1]).norm(), v.transverse_process_span,
              2e-3);
  const Vector3d spinous = v.spinous_tip_distance * Vector3d(-std::cos(v.spinous_declination), 0,
                                                             -std::sin(v.spinous_declination));
  // The sacrum's crest cuts L5's process off below, so that the middle of its end is above its
  // axis.
  EXPECT_LT((I * found.spinous_tip - spinous).norm(), level == "L5" ? 5e-3 : 3e-3);
  const VertebraPrior truth = vertebraPrior(anatomy(), level);
  for (int side : {0, 1}) {
    for (bool superior : {true, false}) {
      SCOPED_TRACE(superior ? "superior" : "inferior");
      Landmark face = superior ? truth.superior_face : truth.inferior_face;
      if (side) {
        face.centre = mirror(face.centre);
        face.normal = mirror(face.normal);
      }
      const Landmark& f = superior ? found.superior_face[side] : found.inferior_face[side];
      EXPECT_LT((I * f.centre - face.centre).norm(), 1e-3 * face_mm);
      EXPECT_LT(degreesBetween(I.linear() * f.normal, face.normal), face_degrees);
      EXPECT_NEAR(f.width, face.width, 0.3 * face.width);
      EXPECT_NEAR(f.height, face.height, 0.3 * face.height);
    }
  }
}

TEST(VertebraLandmarks, AreFoundInAnyPose) {
  int seed = 0;
  for (const char* level : {"L5", "L3", "T12", "T8", "T4", "C7", "C4"}) {
    const Isometry3d X = anyPose(++seed);
    const auto found =
        findLandmarks(transformed(generated(level), X), vertebraPrior(anatomy(), level));
    expectFound(level, found, X, 3, 13);
    EXPECT_GT(found.up_certainty, 0.1) << level;
  }
}

TEST(VertebraLandmarks, AreFoundOnCoarseMeshes) {
  for (const char* level : {"L3", "T6"}) {
    const TriMesh coarse = simplified(generated(level), 450);
    ASSERT_LT(coarse.faces.size(), 500u);
    const Isometry3d X = anyPose(7);
    expectFound(level, findLandmarks(transformed(coarse, X), vertebraPrior(anatomy(), level)), X, 4,
                20);
  }
}

// The expectation only starts the search: that of a neighbour, and of a larger body, will do.
TEST(VertebraLandmarks, DoNotNeedTheRightExpectation) {
  const Isometry3d X = anyPose(3);
  const TriMesh mesh = transformed(generated("L3"), X);
  expectFound("L3", findLandmarks(mesh, vertebraPrior(anatomy(), "L2")), X, 4, 15);
  expectFound("L3", findLandmarks(mesh, vertebraPrior(anatomy().scaled(1.2, 1), "L3")), X, 4, 15);
}

TEST(VertebraLandmarks, GivenOnesGoFirst) {
  const TriMesh mesh = generated("L4");
  GivenLandmarks given;
  given["spinous_tip"].centre = {-0.08, 0, -0.03};
  given["left_superior_face"] = {{-0.03, 0.02, 0.012}, {0, -2, 0}, 0.01, 0};
  const VertebraPrior prior = vertebraPrior(anatomy(), "L4");
  const auto found = findLandmarks(mesh, prior, given), free = findLandmarks(mesh, prior);
  EXPECT_LT((found.spinous_tip - given["spinous_tip"].centre).norm(), 1e-9);
  const Landmark& face = found.superior_face[0];
  EXPECT_LT((face.centre - Vector3d(-0.03, 0.02, 0.012)).norm(), 1e-9);
  EXPECT_LT((face.normal - Vector3d(0, -1, 0)).norm(), 1e-9);
  EXPECT_EQ(face.width, 0.01);
  EXPECT_NEAR(face.height, free.superior_face[0].height, 1e-12);
  EXPECT_LT((found.superior_face[1].centre - free.superior_face[1].centre).norm(), 1e-9);
}

TEST(VertebraLandmarks, GivenEndplatesSetTheBodysHeight) {
  const VertebraPrior prior = vertebraPrior(anatomy(), "L4");
  const TriMesh mesh = generated("L4");
  const auto free = findLandmarks(mesh, prior);
  GivenLandmarks given;
  given["upper_endplate"] = free.upper_endplate;
  given["upper_endplate"].centre += 3e-3 * free.upper_endplate.normal;
  const auto found = findLandmarks(mesh, prior, given);
  EXPECT_NEAR(found.body_height_anterior, free.body_height_anterior + 3e-3, 0.3e-3);
  EXPECT_NEAR(found.body_height_posterior, free.body_height_posterior + 3e-3, 0.3e-3);
}

TEST(VertebraLandmarks, SayWhatToGiveIfThereIsNoVertebra) {
  const TriMesh clavicle = boneMesh(anatomy(), "left_clavicle")[0].mesh;
  try {
    findLandmarks(clavicle, vertebraPrior(anatomy(), "L3"));
    FAIL();
  } catch (const std::runtime_error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("upper_endplate, lower_endplate and spinous_tip"));
  }
}

}  // namespace
}  // namespace torso
