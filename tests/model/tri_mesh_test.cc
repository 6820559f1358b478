// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/tri_mesh.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstring>

namespace torso {
namespace {

TriMesh tetrahedron() {
  TriMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  return mesh;
}

double volume(const TriMesh& mesh) {
  double v = 0;
  for (const auto& f : mesh.faces) {
    v += mesh.vertices[f[0]].dot(mesh.vertices[f[1]].cross(mesh.vertices[f[2]])) / 6;
  }
  return v;
}

TEST(TriMesh, MirrorAndMotionKeepTheVolumePositive) {
  const TriMesh mesh = tetrahedron();
  EXPECT_NEAR(volume(mesh), 1.0 / 6, 1e-15);
  EXPECT_NEAR(volume(mirrored(mesh)), 1.0 / 6, 1e-15);
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translate(Eigen::Vector3d(1, 2, 3));
  X.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  EXPECT_NEAR(volume(transformed(mesh, X)), 1.0 / 6, 1e-15);
}

TEST(TriMesh, AppendKeepsBothParts) {
  TriMesh two = tetrahedron();
  append(two, tetrahedron());
  EXPECT_EQ(two.faces.size(), 8u);
  EXPECT_NEAR(volume(two), 2.0 / 6, 1e-15);
}

TEST(TriMesh, StlHoldsEveryTriangleOnce) {
  const std::string bytes = toStl(tetrahedron());
  ASSERT_EQ(bytes.size(), 80u + 4u + 4u * 50u);
  // Its triangles enclose the same volume.
  double volume = 0;
  for (int i = 0; i < 4; i++) {
    Eigen::Matrix<float, 3, 4> triangle;  // normal, then the corners
    std::memcpy(triangle.data(), bytes.data() + 84 + 50 * i, 48);
    volume += triangle.col(1).dot(triangle.col(2).cross(triangle.col(3))) / 6;
    EXPECT_NEAR(triangle.col(0).norm(), 1, 1e-6);
  }
  EXPECT_NEAR(volume, 1.0 / 6, 1e-6);
}

}  // namespace
}  // namespace torso
