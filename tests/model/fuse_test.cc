// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/fuse.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "model/disc.h"
#include "model/loft.h"
#include "model/simplify.h"

namespace torso {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

TriMesh ball(const Vector3d& centre, double radius) {
  return ellipsoid(centre, Vector3d::Constant(radius), Matrix3d::Identity(), 64);
}

double ballVolume(double r) { return 4 * M_PI / 3 * r * r * r; }

// Of two balls of the same radius whose centres are `distance` apart.
double lensVolume(double r, double distance) {
  return M_PI * std::pow(2 * r - distance, 2) * (distance * distance + 4 * distance * r) /
         (12 * distance);
}

void expectClosed(const TriMesh& mesh) {
  std::set<std::pair<int, int>> edges;
  for (const auto& f : mesh.faces) {
    for (int k = 0; k < 3; k++) {
      EXPECT_TRUE(edges.insert({f[k], f[(k + 1) % 3]}).second);
    }
  }
  for (const auto& [a, b] : edges) EXPECT_EQ(edges.count({b, a}), 1u);
}

TEST(Fuse, TwoBallsHaveTheVolumeOfTheirUnion) {
  TriMesh shells = ball({0, -0.006, 0}, 0.01);
  append(shells, ball({0, 0.006, 0}, 0.01));
  const double expected = 2 * ballVolume(0.01) - lensVolume(0.01, 0.012);
  for (bool symmetric : {false, true}) {
    const TriMesh mesh = fuse(shells, {0.6e-3, 0, 2000, 0, symmetric});
    expectClosed(mesh);
    EXPECT_EQ(connectedParts(mesh).size(), 1u);
    EXPECT_LE(mesh.faces.size(), 2000u);
    EXPECT_NEAR(volume(mesh), expected, 0.01 * expected);
  }
}

TEST(Fuse, FilletAddsBoneWhereShellsMeetAndNowhereElse) {
  TriMesh shells = ball({0, -0.008, 0}, 0.01);
  append(shells, ball({0, 0.008, 0}, 0.01));
  const double sharp = volume(fuse(shells, {0.6e-3, 0, 3000, 0, true}));
  const TriMesh smooth = fuse(shells, {0.6e-3, 4e-3, 3000, 0, true});
  EXPECT_GT(volume(smooth), 1.01 * sharp);
  double reach = 0;
  for (const Vector3d& v : smooth.vertices) reach = std::max(reach, v.y());
  EXPECT_NEAR(reach, 0.018, 0.2e-3);
}

TEST(Fuse, CutIsTakenAway) {
  const double expected = ballVolume(0.01) - lensVolume(0.01, 0.012);
  const TriMesh mesh =
      fuse(ball(Vector3d::Zero(), 0.01), {0.6e-3, 0, 2000, 0, false}, ball({0.012, 0, 0}, 0.01));
  expectClosed(mesh);
  EXPECT_NEAR(volume(mesh), expected, 0.01 * expected);
}

TEST(Fuse, SimplifiedBallStaysABall) {
  const TriMesh fine = ball({0.1, 0.2, 0.3}, 0.05);
  const TriMesh coarse = simplified(fine, 400);
  expectClosed(coarse);
  EXPECT_LE(coarse.faces.size(), 400u);
  EXPECT_NEAR(volume(coarse), volume(fine), 0.02 * volume(fine));
  for (const Vector3d& v : coarse.vertices) {
    EXPECT_NEAR((v - Vector3d(0.1, 0.2, 0.3)).norm(), 0.05, 1e-3);
  }
}

TEST(Loft, StraightTubeHasTheVolumeOfACylinder) {
  TubeStyle style;
  style.sides = 64;
  style.up = Vector3d::UnitX();
  style.cap = 0.01;
  const TriMesh mesh =
      tube({{Vector3d(0, 0, 0), 0.01, 0.02}, {Vector3d(0, 0, 0.1), 0.01, 0.02}}, style);
  expectClosed(mesh);
  EXPECT_NEAR(volume(mesh), M_PI * 0.01 * 0.02 * 0.1, 0.01 * M_PI * 0.01 * 0.02 * 0.1);
}

TEST(Loft, PlateHasTheVolumeOfItsSurfaceTimesThickness) {
  std::vector<std::vector<Vector3d>> grid(11, std::vector<Vector3d>(11));
  for (int i = 0; i < 11; i++) {
    for (int j = 0; j < 11; j++) grid[i][j] = Vector3d(0.01 * i, 0.01 * j, 0);
  }
  const TriMesh mesh =
      plate(grid, std::vector<std::vector<double>>(11, std::vector<double>(11, 1e-3)));
  expectClosed(mesh);
  EXPECT_NEAR(volume(mesh), 0.1 * 0.1 * 1e-3, 0.02 * 0.1 * 0.1 * 1e-3);
}

TEST(Loft, RevolvedRectangleIsAPipe) {
  const TriMesh mesh = revolve({{0.02, 0}, {0.03, 0}, {0.03, 0.05}, {0.02, 0.05}}, {1, 2, 3},
                               Vector3d(1, 1, 0), 128);
  expectClosed(mesh);
  const double expected = M_PI * (0.03 * 0.03 - 0.02 * 0.02) * 0.05;
  EXPECT_NEAR(volume(mesh), expected, 2e-3 * expected);
}

TEST(Loft, EndplateOutlineIsTheDiscs) {
  const DiscShape shape = {0.05, 0.035, 0.012, 0.008};
  const int points = 72;
  const auto outline = endplateOutline(shape.width, shape.depth, points);
  double area = 0;
  for (int i = 0; i < points; i++) {
    const Vector2d &a = outline[i], &b = outline[(i + 1) % points];
    area += (a.x() * b.y() - a.y() * b.x()) / 2;
  }
  EXPECT_NEAR(area, 0.82 * shape.width * shape.depth, 0.02 * shape.width * shape.depth);
  // The disc's polygon has the same area, so that its corners stand out a little.
  const DiscMesh disc = makeDiscMesh(shape, 3);
  const size_t sectors = 36, end = disc.lower_nodes.size();
  for (size_t i = end - sectors; i < end; i++) {
    const Vector2d node = disc.rest_positions[disc.lower_nodes[i]].head<2>();
    double distance = 1;
    for (const Vector2d& p : outline) distance = std::min(distance, (p - node).norm());
    EXPECT_LT(distance, 1.2e-3);
  }
}

}  // namespace
}  // namespace torso
