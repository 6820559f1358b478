// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/mesh_checks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "tests/model/ball_mesh.h"

namespace torso {
namespace {

using Eigen::Vector3d;

TriMesh cube(const Vector3d& low, double side) {
  TriMesh mesh;
  for (int i = 0; i < 8; i++) {
    mesh.vertices.push_back(low + side * Vector3d(i & 1, i >> 1 & 1, i >> 2 & 1));
  }
  mesh.faces = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

TriMesh ball(const Vector3d& centre, double radius) { return ballMesh(centre, radius, 24); }

TEST(FindFaults, NoneInACube) { EXPECT_FALSE(findFaults(cube(Vector3d::Zero(), 0.1)).any()); }

TEST(FindFaults, CountsEachKind) {
  TriMesh open = cube(Vector3d::Zero(), 0.1);
  open.faces.pop_back();
  EXPECT_EQ(findFaults(open).open_edges, 3);

  TriMesh turned = cube(Vector3d::Zero(), 0.1);
  std::swap(turned.faces[0][0], turned.faces[0][1]);
  EXPECT_EQ(findFaults(turned).misturned_edges, 3);

  TriMesh crowded = cube(Vector3d::Zero(), 0.1);
  crowded.vertices.push_back({-1, -1, -1});
  crowded.faces.push_back({0, 1, 8});
  EXPECT_EQ(findFaults(crowded).crowded_edges, 1);

  // Two cubes that share one corner.
  TriMesh pinched = cube(Vector3d::Zero(), 0.1);
  append(pinched, cube(Vector3d::Constant(0.1), 0.1));
  for (auto& f : pinched.faces) {
    for (int& k : f) k = k == 8 ? 7 : k;
  }
  EXPECT_EQ(findFaults(pinched).pinched_vertices, 1);
  EXPECT_EQ(findFaults(pinched).open_edges, 0);

  TriMesh flat = cube(Vector3d::Zero(), 0.1);
  flat.vertices[7] = flat.vertices[3];
  EXPECT_GT(findFaults(flat).flat_faces, 0);

  TriMesh bad = cube(Vector3d::Zero(), 0.1);
  bad.faces.push_back({0, 0, 99});
  EXPECT_EQ(findFaults(bad).bad_indices, 1);
  EXPECT_THROW(MeshTree{bad}, std::invalid_argument);
  EXPECT_THROW(MeshTree{TriMesh{}}, std::invalid_argument);
}

TEST(MeshTree, RayMeetsTheNearestFace) {
  TriMesh mesh = cube(Vector3d::Zero(), 0.1);
  append(mesh, cube({0.3, 0, 0}, 0.1));
  const MeshTree tree(mesh);
  const Vector3d x = Vector3d::UnitX();
  EXPECT_NEAR(tree.castRay({-0.2, 0.03, 0.04}, x).distance, 0.2, 1e-12);
  EXPECT_NEAR(tree.castRay({0.15, 0.03, 0.04}, x).distance, 0.15, 1e-12);
  EXPECT_NEAR(tree.castRay({0.05, 0.03, 0.04}, x).distance, 0.05, 1e-12) << "from inside";
  EXPECT_EQ(tree.castRay({0.05, 0.2, 0.04}, x).face, -1);
  EXPECT_NEAR(tree.normal(tree.castRay({-0.2, 0.03, 0.04}, x).face).dot(x), -1, 1e-12);
}

// The distance to a fine ball is that to its sphere, but for the faces' flatness.
TEST(MeshTree, DistanceToABall) {
  const Vector3d centre(0.1, -0.2, 0.3);
  const MeshTree tree(ball(centre, 0.05));
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 300; i++) {
    const Vector3d p = centre + 0.05 * Vector3d(normal(random), normal(random), normal(random));
    EXPECT_NEAR(tree.signedDistance(p), (p - centre).norm() - 0.05, 1.2e-3);
    const MeshTree::Nearest nearest = tree.nearest(p);
    EXPECT_NEAR((nearest.point - p).norm(), nearest.distance, 1e-12);
    Vector3d mean = Vector3d::Zero();
    for (int k = 0; k < 3; k++) {
      mean += nearest.weights[k] * tree.mesh().vertices[tree.mesh().faces[nearest.face][k]];
    }
    EXPECT_NEAR((nearest.point - mean).norm(), 0, 1e-12);
    EXPECT_NEAR(nearest.weights.sum(), 1, 1e-12);
    EXPECT_GE(nearest.weights.minCoeff(), 0);
  }
}

TEST(MeshTree, WindingNumberCountsShells) {
  TriMesh mesh = ball(Vector3d::Zero(), 0.05);
  append(mesh, ball({0.04, 0, 0}, 0.05));
  const MeshTree tree(mesh);
  EXPECT_EQ(tree.windingNumber({-0.03, 0, 0}), 1);
  EXPECT_EQ(tree.windingNumber({0.02, 0, 0}), 2);
  EXPECT_EQ(tree.windingNumber({0.2, 0, 0}), 0);
}

TEST(MeshTree, SelfIntersectionsOfOverlappingShellsOnly) {
  TriMesh mesh = cube(Vector3d::Zero(), 0.1);
  append(mesh, cube({0.2, 0.01, 0.02}, 0.1));
  EXPECT_TRUE(MeshTree(mesh).selfIntersections().empty());
  append(mesh, cube({0.05, 0.03, 0.04}, 0.1));
  EXPECT_FALSE(MeshTree(mesh).selfIntersections().empty());

  // A dent pushed out through the opposite side: neighbours with a common vertex cross others.
  TriMesh dented = ball(Vector3d::Zero(), 0.05);
  EXPECT_TRUE(MeshTree(dented).selfIntersections().empty());
  dented.vertices[0] = -1.3 * dented.vertices[0];
  EXPECT_FALSE(MeshTree(dented).selfIntersections().empty());
}

TEST(Penetration, IsTheDepthOfTheOverlap) {
  const MeshTree a(cube(Vector3d::Zero(), 0.1));
  EXPECT_EQ(penetration(a, MeshTree(cube({0.11, 0, 0}, 0.1))), 0);
  // A corner 3, 4 and 5 mm inside: 3 mm from the nearest side.
  EXPECT_NEAR(penetration(a, MeshTree(cube({0.097, 0.096, 0.095}, 0.1))), 0.003, 1e-12);
  // A beam through the cube has no vertex inside, nor has the cube one in it.
  TriMesh beam = cube({0.04, 0.04, 0.04}, 0.02);
  for (Vector3d& p : beam.vertices) p.x() = p.x() > 0.05 ? 0.2 : -0.1;
  EXPECT_EQ(penetration(a, MeshTree(beam), 1e-6), 1e-6);
}

}  // namespace
}  // namespace torso
