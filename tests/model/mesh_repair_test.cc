// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/mesh_repair.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

namespace torso {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

// Closed surface of n x n squares on each side of a cube of edge 1, two triangles each.
TriMesh cube(int n) {
  TriMesh mesh;
  for (int axis = 0; axis < 3; axis++) {
    for (int side : {0, 1}) {
      for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
          const auto corner = [&](int di, int dj) {
            Vector3d p;
            p[axis] = side;
            p[(axis + 1) % 3] = static_cast<double>(i + di) / n;
            p[(axis + 2) % 3] = static_cast<double>(j + dj) / n;
            mesh.vertices.push_back(p);
            return static_cast<int>(mesh.vertices.size()) - 1;
          };
          int a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          if (side == 0) std::swap(b, d);
          mesh.faces.push_back({a, b, c});
          mesh.faces.push_back({a, c, d});
        }
      }
    }
  }
  return mesh;
}

// Each edge runs once forward and once back.
bool closed(const TriMesh& mesh) {
  std::map<std::pair<int, int>, int> runs;
  for (const auto& f : mesh.faces) {
    for (int k = 0; k < 3; k++) runs[{f[k], f[(k + 1) % 3]}]++;
  }
  for (const auto& [edge, n] : runs) {
    if (n != 1 || !runs.count({edge.second, edge.first})) return false;
  }
  return true;
}

std::string complaint(const TriMesh& mesh) {
  MeshRepair done;
  try {
    repaired(mesh, &done);
  } catch (const std::runtime_error& e) {
    return e.what();
  }
  return "";
}

TEST(MeshRepair, JoinsASoupOfTriangles) {
  const TriMesh soup = cube(4);
  ASSERT_FALSE(closed(soup));
  MeshRepair done;
  const TriMesh mesh = repaired(soup, &done);
  EXPECT_TRUE(closed(mesh));
  EXPECT_EQ(mesh.vertices.size(), 98u);  // 6 * 4^2 + 2
  EXPECT_NEAR(signedVolume(mesh), 1, 1e-12);
  EXPECT_EQ(done.text(), "");
}

TEST(MeshRepair, FillsASmallHole) {
  TriMesh mesh = cube(6);
  mesh.faces.erase(mesh.faces.begin() + 30, mesh.faces.begin() + 32);  // one square
  MeshRepair done;
  const TriMesh out = repaired(mesh, &done);
  EXPECT_TRUE(closed(out));
  EXPECT_EQ(done.filled_holes, 1);
  EXPECT_NEAR(signedVolume(out), 1, 1e-9);
}

TEST(MeshRepair, RefusesALargeHole) {
  TriMesh mesh = cube(6);
  mesh.faces.resize(5 * 72);  // one side of the cube is missing
  EXPECT_THAT(complaint(mesh), HasSubstr("open: a hole"));
}

TEST(MeshRepair, TurnsSingleFaces) {
  TriMesh mesh = cube(4);
  for (int i : {3, 50, 77}) std::swap(mesh.faces[i][0], mesh.faces[i][1]);
  MeshRepair done;
  const TriMesh out = repaired(mesh, &done);
  EXPECT_TRUE(closed(out));
  EXPECT_EQ(done.flipped_faces, 3);
  EXPECT_NEAR(signedVolume(out), 1, 1e-12);
}

TEST(MeshRepair, RefusesAMeshThatIsInsideOut) {
  TriMesh mesh = cube(4);
  for (Vector3d& v : mesh.vertices) v.y() = -v.y();  // mirrored, faces as they were
  EXPECT_THAT(complaint(mesh), HasSubstr("inside out"));
}

TEST(MeshRepair, DropsDoubleAndStrayFaces) {
  TriMesh mesh = cube(8);
  mesh.faces.push_back(mesh.faces[5]);
  // A fin on one edge.
  mesh.vertices.push_back(mesh.vertices[mesh.faces[20][0]] + Vector3d(0.02, 0.03, 0.04));
  mesh.faces.push_back(
      {mesh.faces[20][0], mesh.faces[20][1], static_cast<int>(mesh.vertices.size()) - 1});
  MeshRepair done;
  const TriMesh out = repaired(mesh, &done);
  EXPECT_TRUE(closed(out));
  EXPECT_EQ(done.dropped_faces, 2);
  EXPECT_NEAR(signedVolume(out), 1, 1e-12);
}

TEST(MeshRepair, RefusesAnInnerWall) {
  TriMesh mesh = cube(4);
  const int n = static_cast<int>(mesh.vertices.size());
  for (const Vector3d& p :
       {Vector3d(0.5, 0, 0), Vector3d(0.5, 1, 0), Vector3d(0.5, 1, 1), Vector3d(0.5, 0, 1),
        Vector3d(0.5, 0.25, 0), Vector3d(0.5, 0.5, 0), Vector3d(0.5, 0.75, 0)}) {
    mesh.vertices.push_back(p);
  }
  // Four triangles from a corner to the squares' edges at the bottom, and one more.
  mesh.faces.push_back({n + 3, n + 0, n + 4});
  mesh.faces.push_back({n + 3, n + 4, n + 5});
  mesh.faces.push_back({n + 3, n + 5, n + 6});
  mesh.faces.push_back({n + 3, n + 6, n + 1});
  mesh.faces.push_back({n + 3, n + 1, n + 2});
  EXPECT_THAT(complaint(mesh), HasSubstr("not manifold"));
  EXPECT_THAT(complaint(mesh), HasSubstr("0.5"));
}

TEST(MeshRepair, KeepsTwoPartsThatTouchInAnEdge) {
  TriMesh mesh = cube(2), other = cube(2);
  for (Vector3d& v : other.vertices) v += Vector3d(1, 1, 0);
  append(mesh, other);
  MeshRepair done;
  const TriMesh out = repaired(mesh, &done);
  EXPECT_TRUE(closed(out));
  EXPECT_EQ(done.cut_edges, 2);
  EXPECT_NEAR(signedVolume(out), 2, 1e-12);
}

}  // namespace
}  // namespace torso
