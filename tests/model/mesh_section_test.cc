// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/mesh_section.h"

#include <gtest/gtest.h>

#include <cmath>

namespace torso {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Square tube along z: 0.1 high, outer edge 0.04, inner edge 0.02, closed, faces outwards.
TriMesh squareTube() {
  TriMesh mesh;
  for (double half : {0.02, 0.01}) {
    for (double z : {0.0, 0.1}) {
      for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
        mesh.vertices.push_back({half * x, half * y, z});
      }
    }
  }
  const auto square = [&](int a, int b, int c, int d) {
    mesh.faces.push_back({a, b, c});
    mesh.faces.push_back({a, c, d});
  };
  for (int k = 0; k < 4; k++) {
    const int n = (k + 1) % 4;
    square(k, n, 4 + n, 4 + k);            // outside
    square(8 + n, 8 + k, 12 + k, 12 + n);  // inside
    square(n, k, 8 + k, 8 + n);            // below
    square(4 + k, 4 + n, 12 + n, 12 + k);  // above
  }
  return mesh;
}

TEST(Section, OutlinesGoRoundSolidAndHollowInOppositeSenses) {
  const auto outlines = section(squareTube(), 2, 0.03);
  ASSERT_EQ(outlines.size(), 2u);
  double solid = 0, hollow = 0;
  for (const Outline& o : outlines) {
    (signedArea(o) > 0 ? solid : hollow) += signedArea(o);
    EXPECT_LT(centroid(o).norm(), 1e-12);
    EXPECT_TRUE(contains(o, Vector2d(0.003, -0.004)));
    EXPECT_FALSE(contains(o, Vector2d(0.03, 0)));
  }
  EXPECT_NEAR(solid, 0.04 * 0.04, 1e-12);
  EXPECT_NEAR(hollow, -0.02 * 0.02, 1e-12);
}

TEST(Section, CoordinatesAreInCyclicOrder) {
  // Across y: (z, x); the two walls left and right of the hollow.
  const auto outlines = section(squareTube(), 1, 0.0);
  ASSERT_EQ(outlines.size(), 2u);
  for (const Outline& o : outlines) {
    EXPECT_NEAR(signedArea(o), 0.1 * 0.01, 1e-12);
    EXPECT_NEAR(centroid(o).x(), 0.05, 1e-12);
    EXPECT_NEAR(std::abs(centroid(o).y()), 0.015, 1e-12);
  }
}

TEST(Section, RaysMeetTheNearestFace) {
  const TriMesh tube = squareTube();
  EXPECT_NEAR(rayLength(tube, {0.001, 0.002, 0.05}, Vector3d::UnitX()), 0.009, 1e-12);
  EXPECT_NEAR(rayLength(tube, {-1, 0.002, 0.05}, Vector3d::UnitX()), 0.98, 1e-12);
  EXPECT_TRUE(std::isinf(rayLength(tube, {0.001, 0.002, 0.05}, Vector3d::UnitZ())));
}

TEST(SurfacePoints, ShareTheAreaAndLieClose) {
  double area = 0;
  Vector3d flux = Vector3d::Zero();
  const auto points = surfacePoints(squareTube(), 0.003);
  for (const auto& p : points) {
    area += p.area;
    flux += p.area * p.normal;
    EXPECT_NEAR(p.normal.norm(), 1, 1e-12);
  }
  EXPECT_NEAR(area, 4 * 0.1 * (0.04 + 0.02) + 2 * (0.04 * 0.04 - 0.02 * 0.02), 1e-12);
  EXPECT_LT(flux.norm(), 1e-12);
  EXPECT_GT(points.size(), area / (0.003 * 0.003));
}

}  // namespace
}  // namespace torso
