// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "model/triangle_tree.h"

namespace torso {
namespace {

using Eigen::Affine3d;
using Eigen::Vector3d;

constexpr double kPi = EIGEN_PI;

TriMesh meshOf(const Shape& shape) { return surface(shape, 0.5, 4000, Affine3d::Identity()); }

TEST(Shape, VolumesAreThoseOfTheBodies) {
  const Vector3d o = Vector3d::Zero();
  EXPECT_NEAR(volume(meshOf(ballShape({1, 2, 3}, 8))) / (4 * kPi / 3 * 512), 1, 0.01);
  EXPECT_NEAR(volume(meshOf(ellipsoidShape(o, {9, 6, 5}))) / (4 * kPi / 3 * 270), 1, 0.01);
  EXPECT_NEAR(volume(meshOf(ringShape(o, Vector3d::UnitX(), 9, 3))) / (2 * kPi * 9 * kPi * 9), 1,
              0.02);
  EXPECT_NEAR(volume(meshOf(rollShape(o, Vector3d::UnitZ(), 8, 6, 0.1))) / (kPi * 64 * 12), 1,
              0.02);
  // A straight tube with half balls at its ends.
  const Shape tube = tubeShape({{{0, 0, -10}, 5, 5}, {{0, 0, 10}, 5, 5}}, Vector3d::UnitX(), 2, 1);
  EXPECT_NEAR(volume(meshOf(tube)) / (kPi * 25 * 20 + 4 * kPi / 3 * 125), 1, 0.01);
}

TEST(Shape, CutsUnionsAndClipsArePutTogetherInOrder) {
  const double ball = 4 * kPi / 3 * 512, half = ball / 2;
  const Shape whole = ballShape({0, 0, 0}, 8);
  EXPECT_NEAR(
      volume(meshOf(Sculpture().add(whole).cut(halfSpace({0, 0, 0}, Vector3d::UnitZ())).shape())),
      half, 0.02 * half);
  EXPECT_NEAR(
      volume(meshOf(Sculpture().add(whole).clip(halfSpace({0, 0, 4}, Vector3d::UnitZ())).shape())),
      ball - kPi * 16 * (8 - 4.0 / 3), 0.02 * ball);
  // What is added after a cut is not cut.
  const Shape filled =
      Sculpture().add(whole).cut(ballShape({0, 0, 0}, 5)).add(ballShape({0, 0, 0}, 6)).shape();
  EXPECT_NEAR(volume(meshOf(filled)), ball, 0.01 * ball);
}

TEST(Shape, NeighboursAreKeptApartByTheGap) {
  const std::vector<Shape> pair = keptApart({ballShape({0, 0, 0}, 8), ballShape({10, 0, 0}, 8)}, 1);
  const TriMesh a = meshOf(pair[0]), b = meshOf(pair[1]);
  const TriangleTree tree(a);
  double nearest = 1e9;
  for (const Vector3d& v : b.vertices) nearest = std::min(nearest, tree.signedDistance(v));
  EXPECT_NEAR(nearest, 1, 0.15);
  for (const Vector3d& v : a.vertices) EXPECT_LT(v.x(), 5);
}

TEST(Shape, MeshesOfShapesAreClosed) {
  const TriMesh mesh = meshOf(Sculpture()
                                  .add(ballShape({0, 0, 0}, 8))
                                  .add(ringShape({6, 0, 0}, Vector3d::UnitY(), 7, 2), 3)
                                  .shape());
  std::set<std::pair<int, int>> edges;
  for (const auto& f : mesh.faces) {
    for (int k = 0; k < 3; k++) EXPECT_TRUE(edges.insert({f[k], f[(k + 1) % 3]}).second);
  }
  for (const auto& [a, b] : edges) EXPECT_TRUE(edges.count({b, a}));
}

TEST(Shape, DistanceToAMeshHasTheRightSign) {
  const TriMesh mesh =
      meshOf(Sculpture().add(ballShape({0, 0, 0}, 8)).cut(ballShape({6, 0, 0}, 5), 0.1).shape());
  const Shape shape = meshShape(mesh);
  for (int i = 0; i < 2000; i++) {  // about the cup and its sharp edge
    const Vector3d p(12 * std::sin(i * 1.1), 12 * std::sin(i * 1.7 + 1),
                     12 * std::sin(i * 2.3 + 2));
    const double inner = 8 - p.norm(), outer = (p - Vector3d(6, 0, 0)).norm() - 5;
    if (std::abs(inner) < 0.4 || std::abs(outer) < 0.4) continue;
    EXPECT_EQ(shape.distance(p) < 0, inner > 0 && outer > 0) << p.transpose();
  }
  EXPECT_NEAR(shape.distance({-20, 0, 0}), 12, 0.1);
}

}  // namespace
}  // namespace torso
