// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/solid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "model/blend.h"
#include "model/disc.h"
#include "model/loft.h"
#include "model/mesh_checks.h"
#include "model/simplify.h"
#include "model/surface.h"
#include "tests/model/ball_mesh.h"

namespace torso {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

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

TEST(Simplified, BallStaysABall) {
  const TriMesh fine = ballMesh({0.1, 0.2, 0.3}, 0.05, 64);
  const TriMesh coarse = simplified(fine, 400);
  expectClosed(coarse);
  EXPECT_LE(coarse.faces.size(), 400u);
  EXPECT_NEAR(volume(coarse), volume(fine), 0.02 * volume(fine));
  for (const Vector3d& v : coarse.vertices) {
    EXPECT_NEAR((v - Vector3d(0.1, 0.2, 0.3)).norm(), 0.05, 1e-3);
  }
}

TriMesh meshOf(const Blend& solid) { return surface(solid, 0.5, 4000, false, Finish::kRounded); }

TEST(Solid, VolumesAreThoseOfTheBodies) {
  const Vector3d o = Vector3d::Zero();
  const struct {
    Solid solid;
    double volume, tolerance;
  } rows[] = {{ballSolid({1, 2, 3}, 8), ballVolume(8), 0.01},
              {ellipsoidSolid(o, {9, 6, 5}), 4 * M_PI / 3 * 270, 0.01},
              {torus(o, Vector3d::UnitX(), 9, 3), 2 * M_PI * 9 * M_PI * 9, 0.02},
              {cylinder(o, Vector3d::UnitZ(), 8, 6, 0.1), M_PI * 64 * 12, 0.02},
              {capsule({0, 0, -10}, {0, 0, 10}, 5), M_PI * 25 * 20 + ballVolume(5), 0.01},
              {stoutRod({{{0, 0, -10}, 5, 5}, {{0, 0, 10}, 5, 5}}, Vector3d::UnitX(), 2, 1),
               M_PI * 25 * 20 + ballVolume(5), 0.01},
              {bentPlate({{{0, 0, 0}, {0, 30, 0}}, {{30, 0, 0}, {30, 30, 0}}}, {{4, 4}, {4, 4}}),
               30 * 30 * 4 + 120 * M_PI * 4 / 2 + ballVolume(2), 0.02},  // with its round edge
              {grown(ballSolid(o, 6), 2), ballVolume(8), 0.01},
              {moved(ballSolid({1, 0, 0}, 4), Eigen::Translation3d(5, 0, 0) * Eigen::Scaling(2.0)),
               ballVolume(8), 0.01}};
  for (const auto& row : rows) {
    const TriMesh mesh = meshOf(row.solid);
    expectClosed(mesh);
    EXPECT_NEAR(volume(mesh) / row.volume, 1, row.tolerance) << &row - rows;
    for (const Vector3d& v : mesh.vertices) {
      EXPECT_LT(row.solid.box.exteriorDistance(v), 0.1) << &row - rows;
    }
  }
}

TEST(Solid, MovedSolidLiesWhereItIsMoved) {
  const Solid ball =
      moved(ballSolid({1, 0, 0}, 4), Eigen::Translation3d(5, 0, 0) * Eigen::Scaling(2.0));
  EXPECT_NEAR(ball.distance({7, 0, 0}), -8, 1e-12);
  EXPECT_NEAR(ball.distance({7, 18, 0}), 10, 1e-12);
}

TEST(Blend, UnionsCarvingsAndClipsArePutTogetherInOrder) {
  const double ball = ballVolume(8), half = ball / 2;
  const Solid whole = ballSolid({0, 0, 0}, 8);
  EXPECT_NEAR(volume(meshOf(Blend(whole).carve(halfSpace({0, 0, 0}, Vector3d::UnitZ())))), half,
              0.02 * half);
  EXPECT_NEAR(volume(meshOf(Blend(whole).clip(halfSpace({0, 0, 4}, Vector3d::UnitZ())))),
              ball - M_PI * 16 * (8 - 4.0 / 3), 0.02 * ball);
  // What is united after a carving is not carved.
  const Blend filled = Blend(whole).carve(ballSolid({0, 0, 0}, 5)).unite(ballSolid({0, 0, 0}, 6));
  EXPECT_NEAR(volume(meshOf(filled)), ball, 0.01 * ball);
}

TEST(Blend, FilletAddsBoneWhereSolidsMeetAndNowhereElse) {
  const auto pair = [](double fillet) {
    return Blend(ballSolid({0, -8, 0}, 10)).unite(ballSolid({0, 8, 0}, 10), fillet);
  };
  const TriMesh sharp = meshOf(pair(0)), smooth = meshOf(pair(4));
  EXPECT_GT(volume(smooth), 1.01 * volume(sharp));
  double reach = 0;
  for (const Vector3d& v : smooth.vertices) reach = std::max(reach, v.y());
  EXPECT_NEAR(reach, 18, 0.2);
}

// The solid of a blend can be blended in turn.
TEST(Blend, SolidHasTheBlendsDistance) {
  const Blend blend =
      Blend(ballSolid({0, 0, 0}, 8)).unite(torus({6, 0, 0}, Vector3d::UnitY(), 7, 2), 3);
  const TriMesh direct = meshOf(blend), nested = meshOf(blend.solid());
  expectClosed(direct);
  EXPECT_NEAR(volume(nested), volume(direct), 2e-3 * volume(direct));
}

TEST(KeptApart, NeighboursAreAGapApart) {
  const std::vector<Solid> pair = keptApart({ballSolid({0, 0, 0}, 8), ballSolid({10, 0, 0}, 8)}, 1);
  const TriMesh a = meshOf(pair[0]), b = meshOf(pair[1]);
  const MeshTree tree(a);
  double nearest = 1e9;
  for (const Vector3d& v : b.vertices) nearest = std::min(nearest, tree.signedDistance(v));
  EXPECT_NEAR(nearest, 1, 0.15);
  for (const Vector3d& v : a.vertices) EXPECT_LT(v.x(), 5);
}

TEST(Solid, DistanceToAMeshHasTheRightSign) {
  const Solid cup =
      meshSolid(meshOf(Blend(ballSolid({0, 0, 0}, 8)).carve(ballSolid({6, 0, 0}, 5), 0.1)));
  for (int i = 0; i < 2000; i++) {  // about the cup and its sharp edge
    const Vector3d p(12 * std::sin(i * 1.1), 12 * std::sin(i * 1.7 + 1),
                     12 * std::sin(i * 2.3 + 2));
    const double inner = 8 - p.norm(), outer = (p - Vector3d(6, 0, 0)).norm() - 5;
    if (std::abs(inner) < 0.4 || std::abs(outer) < 0.4) continue;
    EXPECT_EQ(cup.distance(p) < 0, inner > 0 && outer > 0) << p.transpose();
  }
  EXPECT_NEAR(cup.distance({-20, 0, 0}), 12, 0.1);
}

TEST(Blend, BallsHaveTheVolumeOfTheirUnionAndDifference) {
  const auto solid = [](double y) {
    return ellipsoidSolid(Vector3d(0, y, 0), Vector3d::Constant(0.01));
  };
  Blend both, rest;
  both.unitePair(solid(0.006), 0);
  rest.unite(solid(0), 0);
  rest.carve(solid(0.012), 0);
  const double lens = lensVolume(0.01, 0.012);
  const TriMesh united = surface(both, 0.6e-3, 3000, true);
  const TriMesh carved = surface(rest, 0.6e-3, 3000, false);
  expectClosed(united);
  expectClosed(carved);
  EXPECT_NEAR(volume(united), 2 * ballVolume(0.01) - lens, 0.02 * ballVolume(0.01));
  EXPECT_NEAR(volume(carved), ballVolume(0.01) - lens, 0.02 * ballVolume(0.01));
}

TEST(Surface, OnlyTheLargestPartIsKept) {
  Blend blend;
  blend.unite(ellipsoidSolid(Vector3d::Zero(), Vector3d::Constant(0.01)), 0);
  blend.unite(ellipsoidSolid(Vector3d(0, 0, 0.02), Vector3d::Constant(0.004)), 0);
  const TriMesh mesh = surface(blend, 0.6e-3, 3000, true);
  EXPECT_EQ(connectedParts(mesh).size(), 1u);
  EXPECT_NEAR(volume(mesh), ballVolume(0.01), 0.02 * ballVolume(0.01));
}

TEST(Solid, DistanceIsTheEuclideanOneNearTheSurface) {
  TubeStyle style;
  style.up = Vector3d::UnitX();
  const Solid bar =
      rod({{Vector3d(0, 0, 0), 0.004, 0.008}, {Vector3d(0, 0, 0.1), 0.004, 0.008}}, style);
  const Solid plate = facePlate(Eigen::Isometry3d::Identity(), 0.02, 0.03, 0.005, 0);
  for (double off : {-1e-3, 0.0, 1e-3}) {
    EXPECT_NEAR(bar.distance(Vector3d(0.008 + off, 0, 0.05)), off, 1e-4);
    EXPECT_NEAR(bar.distance(Vector3d(0, 0.004 + off, 0.05)), off, 1e-4);
    EXPECT_NEAR(plate.distance(Vector3d(0.003, 0.002, off)), off, 1e-9);
    EXPECT_NEAR(plate.distance(Vector3d(0.01 + off, 0, -0.002)), off, 1e-4);
    EXPECT_NEAR(plate.distance(Vector3d(0, 0.015 + off, -0.002)), off, 1e-4);
  }
}

TEST(Solid, OutlinePlateHasTheVolumeOfItsAreaTimesThickness) {
  Blend blend;
  blend.unite(outlinePlate(
                  Eigen::Isometry3d::Identity(), {{0, 0}, {0.03, 0}, {0.03, 0.02}, {0, 0.02}},
                  [](const Vector2d&) { return 0.006; }, 0),
              0);
  const double expected = 0.03 * 0.02 * 0.006;
  EXPECT_NEAR(volume(surface(blend, 0.5e-3, 4000, true)), expected, 0.04 * expected);
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
