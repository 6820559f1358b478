// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <vector>

#include "model/disc_elasticity.h"
#include "tests/model/disc_test_util.h"

namespace torso {
namespace {

using Eigen::Vector3d;

double volume(const DiscMesh& mesh, const std::array<int, 4>& t) {
  const Vector3d& a = mesh.rest_positions[t[0]];
  return (mesh.rest_positions[t[1]] - a)
             .cross(mesh.rest_positions[t[2]] - a)
             .dot(mesh.rest_positions[t[3]] - a) /
         6;
}

// Nodes of the outline of the lower endplate, counter-clockwise.
std::vector<Vector3d> outline(const DiscMesh& mesh, int refinement) {
  const size_t end = mesh.lower_nodes.size(), sectors = 12 * refinement;
  return {mesh.rest_positions.begin() + end - sectors, mesh.rest_positions.begin() + end};
}

double outlineArea(const DiscMesh& mesh, int refinement) {
  const auto points = outline(mesh, refinement);
  double area = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    const Vector3d &a = points[i], &b = points[(i + 1) % points.size()];
    area += (a.x() * b.y() - a.y() * b.x()) / 2;
  }
  return area;
}

TEST(DiscMesh, DefaultHasTheCountsOfItsRingsAndLayers) {
  const DiscMesh mesh = makeDiscMesh(kLumbarShape);
  EXPECT_EQ(mesh.rest_positions.size(), 5u * (1 + 12 + 12 + 12));
  EXPECT_EQ(mesh.tets.size(), 4u * (12 + 24 + 24) * 3);
  EXPECT_EQ(mesh.lower_nodes.size(), 37u);
  EXPECT_EQ(mesh.upper_nodes.size(), 37u);
  EXPECT_EQ(mesh.hoops.size(), 48u);
}

TEST(DiscMesh, FillsItsShapeWithoutGapOrOverlap) {
  for (const DiscShape& shape : discShapes()) {
    for (int refinement : {1, 2, 3}) {
      const DiscMesh mesh = makeDiscMesh(shape, refinement);
      EXPECT_EQ(checkDiscMesh(mesh), "");
      double sum = 0;
      for (const auto& t : mesh.tets) {
        ASSERT_GT(volume(mesh, t), 0);
        sum += volume(mesh, t);
      }
      // Each inner face belongs to two tets, and the rest closes.
      std::map<std::array<int, 3>, int> faces;
      for (const auto& t : mesh.tets) {
        for (int skip = 0; skip < 4; ++skip) {
          std::array<int, 3> f = {t[(skip + 1) % 4], t[(skip + 2) % 4], t[(skip + 3) % 4]};
          std::sort(f.begin(), f.end());
          ++faces[f];
        }
      }
      size_t outer = 0;
      for (const auto& [f, count] : faces) {
        ASSERT_LE(count, 2);
        outer += count == 1;
      }
      // Two endplates, of whose triangles each stands for 3 tets a layer; and the side.
      const size_t layers = 4 * refinement, sectors = 12 * refinement;
      EXPECT_EQ(outer, 2 * mesh.tets.size() / 3 / layers + sectors * layers * 2);
      // Volume of a wedge: outline integral of a linear height, by its triangles' centroids.
      double expected = 0;
      const auto points = outline(mesh, refinement);
      for (size_t i = 0; i < points.size(); ++i) {
        const Vector3d &a = points[i], &b = points[(i + 1) % points.size()];
        const double area = (a.x() * b.y() - a.y() * b.x()) / 2;
        const double x = (a.x() + b.x()) / 3;
        expected +=
            area * (shape.height_posterior +
                    (x / shape.depth + 0.5) * (shape.height_anterior - shape.height_posterior));
      }
      EXPECT_NEAR(sum, expected, 1e-9 * expected);
    }
  }
}

// The nucleus holds the share of the volume that it is said to, and lies behind the centre; the
// annulus' cells are twelve tets each, around it, and their hoops run around it.
TEST(DiscMesh, NucleusLiesInsideTheAnnulus) {
  for (const DiscShape& shape : discShapes()) {
    for (int refinement : {1, 2}) {
      const DiscMesh mesh = makeDiscMesh(shape, refinement);
      double nucleus = 0, whole = 0;
      Vector3d centre = Vector3d::Zero();
      std::vector<int> tets(mesh.hoops.size(), 0);
      for (size_t e = 0; e < mesh.tets.size(); ++e) {
        const double V = volume(mesh, mesh.tets[e]);
        whole += V;
        if (mesh.cells[e] != DiscMesh::kNucleus) {
          ++tets[mesh.cells[e]];
          continue;
        }
        nucleus += V;
        for (int node : mesh.tets[e]) centre += V / 4 * mesh.rest_positions[node];
      }
      centre /= nucleus;
      EXPECT_NEAR(nucleus / whole, 0.43, 0.02);
      EXPECT_NEAR(centre.y(), 0, 1e-12);
      EXPECT_LT(centre.x(), 0.02 * shape.depth);
      for (int count : tets) EXPECT_EQ(count, 12);
      for (const auto& [a, b] : mesh.hoops) {
        const Vector3d radius = mesh.rest_positions[a] - centre;
        const Vector3d along = mesh.rest_positions[b] - mesh.rest_positions[a];
        EXPECT_GT(radius.head<2>().norm(), 0.25 * shape.depth);
        EXPECT_GT(radius.cross(along).z(), 0);  // counter-clockwise
      }
    }
  }
}

TEST(DiscMesh, OutlineHasTheGivenExtentsAndArea) {
  for (const DiscShape& shape : discShapes()) {
    for (int refinement : {1, 2, 3}) {
      const DiscMesh mesh = makeDiscMesh(shape, refinement);
      Vector3d low = Vector3d::Constant(1), high = Vector3d::Constant(-1);
      for (const auto& x : mesh.rest_positions) {
        low = low.cwiseMin(x);
        high = high.cwiseMax(x);
      }
      EXPECT_NEAR(high.y(), shape.width / 2, 1e-12);
      EXPECT_NEAR(low.y(), -shape.width / 2, 1e-12);
      EXPECT_NEAR(high.x(), shape.depth / 2, 1e-12);
      EXPECT_NEAR(low.x(), -shape.depth / 2, 1e-12);
      EXPECT_NEAR(outlineArea(mesh, refinement) / (shape.width * shape.depth), 0.82, 0.0082);
    }
  }
}

TEST(DiscMesh, OutlineIsConvexAndFlatterBehindThanInFront) {
  for (const DiscShape& shape : discShapes()) {
    const DiscMesh mesh = makeDiscMesh(shape);
    const auto points = outline(mesh, 1);
    const auto corner = [&](int i) { return points[(i + 12) % 12]; };
    for (int i = 0; i < 12; ++i) {
      const Vector3d a = corner(i) - corner(i - 1), b = corner(i + 1) - corner(i);
      EXPECT_GT(a.x() * b.y() - a.y() * b.x(), 0) << "corner " << i;
    }
    // How far the outline falls back beside the median plane (node 0 is in front, 6 behind).
    const double front = corner(0).x() - corner(1).x();
    const double behind = corner(7).x() - corner(6).x();
    EXPECT_LT(behind, 0.6 * front);
  }
}

TEST(DiscMesh, HeightsAreAWedge) {
  const DiscShape shape = {0.05, 0.035, 0.014, 0.006};
  const DiscMesh mesh = makeDiscMesh(shape);
  for (size_t i = 0; i < mesh.lower_nodes.size(); ++i) {
    const Vector3d& low = mesh.rest_positions[mesh.lower_nodes[i]];
    const Vector3d& high = mesh.rest_positions[mesh.upper_nodes[i]];
    EXPECT_NEAR(low.z(), -high.z(), 1e-15);
    EXPECT_NEAR(high.z() - low.z(), 0.010 + low.x() / 0.035 * 0.008, 1e-12);
  }
}

// The image of every tet under the reflection of one coordinate is a tet.
bool mirrors(const DiscMesh& mesh, int axis) {
  const int n = static_cast<int>(mesh.rest_positions.size());
  std::vector<int> image(n, -1);
  for (int i = 0; i < n; ++i) {
    Vector3d x = mesh.rest_positions[i];
    x[axis] = -x[axis];
    for (int j = 0; j < n; ++j) {
      if ((mesh.rest_positions[j] - x).norm() < 1e-9) image[i] = j;
    }
    if (image[i] < 0) return false;
  }
  std::set<std::array<int, 4>> tets;
  for (auto t : mesh.tets) {
    std::sort(t.begin(), t.end());
    tets.insert(t);
  }
  return std::all_of(mesh.tets.begin(), mesh.tets.end(), [&](const std::array<int, 4>& t) {
    std::array<int, 4> m = {image[t[0]], image[t[1]], image[t[2]], image[t[3]]};
    std::sort(m.begin(), m.end());
    return tets.count(m) == 1;
  });
}

TEST(DiscMesh, IsMirrorSymmetric) {
  for (const DiscShape& shape : discShapes()) {
    EXPECT_TRUE(mirrors(makeDiscMesh(shape), 1));
    EXPECT_TRUE(mirrors(makeDiscMesh(shape), 2));
    EXPECT_TRUE(mirrors(makeDiscMesh(shape, 2), 1));
  }
  EXPECT_FALSE(mirrors(makeDiscMesh(kLumbarShape), 0));  // the claim can fail
}

TEST(DiscMesh, TopologyDoesNotDependOnTheShape) {
  const DiscMesh first = makeDiscMesh(kLumbarShape);
  for (const DiscShape& shape : discShapes()) {
    const DiscMesh mesh = makeDiscMesh(shape);
    EXPECT_EQ(mesh.tets, first.tets);
    EXPECT_EQ(mesh.upper_nodes, first.upper_nodes);
    EXPECT_EQ(mesh.cells, first.cells);
    EXPECT_EQ(mesh.hoops, first.hoops);
  }
}

TEST(DiscMesh, UpperEndplateAreaCountsTheTilt) {
  DiscShape shape = kLumbarShape;
  EXPECT_NEAR(upperEndplateArea(makeDiscMesh(shape)), 0.82 * 0.05 * 0.035, 1e-2 * 0.001435);
  shape.height_anterior = 0.014;
  shape.height_posterior = 0.006;
  const double slope = 0.004 / 0.035;
  EXPECT_NEAR(upperEndplateArea(makeDiscMesh(shape)),
              outlineArea(makeDiscMesh(shape), 1) * std::sqrt(1 + slope * slope), 1e-12);
  EXPECT_GT(upperEndplateAreaVector(makeDiscMesh(shape)).z(), 0);
}

TEST(DiscMesh, RefusesSizesThatAreNotPositive) {
  for (double bad : {0.0, -0.01, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(makeDiscMesh({bad, 0.035, 0.01, 0.01}), std::invalid_argument);
    EXPECT_THROW(makeDiscMesh({0.05, 0.035, 0.01, bad}), std::invalid_argument);
  }
  EXPECT_THROW(makeDiscMesh(kLumbarShape, 0), std::invalid_argument);
}

// The check's message holds each of the words.
void expectFault(const DiscMesh& mesh, std::initializer_list<const char*> words) {
  const std::string message = checkDiscMesh(mesh);
  for (const char* word : words) EXPECT_NE(message.find(word), std::string::npos) << message;
  EXPECT_THROW(DiscBatch({{mesh, kDiscMaterial}}), std::invalid_argument);
}

TEST(CheckDiscMesh, NamesEachFault) {
  const DiscMesh good = makeDiscMesh(kLumbarShape);
  ASSERT_EQ(checkDiscMesh(good), "");

  DiscMesh mesh = good;
  mesh.tets[17][2] = 185;
  expectFault(mesh, {"tet 17", "185", "out of range"});
  mesh = good;
  mesh.tets[17][2] = -1;
  expectFault(mesh, {"tet 17", "-1", "out of range"});
  mesh = good;
  mesh.lower_nodes[3] = 185;
  expectFault(mesh, {"lower", "185", "out of range"});
  mesh = good;
  mesh.rest_positions[40].y() = std::numeric_limits<double>::quiet_NaN();
  expectFault(mesh, {"node 40", "not finite"});
  mesh = good;
  mesh.rest_positions[40].y() = std::numeric_limits<double>::infinity();
  expectFault(mesh, {"node 40", "not finite"});
  mesh = good;
  mesh.tets[5][3] = mesh.tets[5][2];
  expectFault(mesh, {"tet 5", "degenerate"});
  mesh = good;
  std::swap(mesh.tets[600][0], mesh.tets[600][1]);
  expectFault(mesh, {"tet 600", "inverted"});
  mesh = good;
  mesh.upper_nodes.push_back(mesh.lower_nodes[7]);
  expectFault(mesh, {"node 7", "twice"});
  mesh = good;
  mesh.lower_nodes.push_back(mesh.lower_nodes[7]);
  expectFault(mesh, {"node 7", "twice"});
  mesh = good;
  mesh.upper_nodes.clear();
  expectFault(mesh, {"upper", "no node"});
  mesh = good;
  mesh.lower_nodes.clear();
  expectFault(mesh, {"lower", "no node"});
  mesh = good;
  mesh.tets.clear();
  expectFault(mesh, {"no tets"});
  mesh = good;
  mesh.rest_positions.emplace_back(0, 0, 0);
  expectFault(mesh, {"node 185", "no tet"});
  mesh = good;
  mesh.cells.pop_back();
  expectFault(mesh, {"719 cell numbers", "720 tets"});
  mesh = good;
  mesh.cells[300] = 48;
  expectFault(mesh, {"tet 300", "cell 48", "out of range"});
  mesh = good;
  mesh.cells[300] = -2;
  expectFault(mesh, {"tet 300", "cell -2", "out of range"});
  mesh = good;
  mesh.hoops.push_back({0, 1});
  expectFault(mesh, {"cell 48", "no tets"});
  mesh = good;
  mesh.hoops[7][1] = 185;
  expectFault(mesh, {"cell 7", "hoop node 185", "out of range"});
  mesh = good;
  mesh.hoops[7] = {0, 37};  // one above the other
  expectFault(mesh, {"cell 7", "axis"});

  // A tet of its own, attached nowhere; then by two nodes, about which it can turn.
  mesh = good;
  for (const Vector3d& x :
       {Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 1)}) {
    mesh.rest_positions.push_back(Vector3d(0.1, 0, 0) + 0.01 * x);
  }
  mesh.tets.push_back({185, 186, 187, 188});
  mesh.cells.push_back(DiscMesh::kNucleus);
  expectFault(mesh, {"tet 720", "no endplate"});
  mesh.lower_nodes.push_back(185);
  mesh.lower_nodes.push_back(186);
  expectFault(mesh, {"tet 720", "no endplate"});
  mesh.lower_nodes.push_back(187);
  EXPECT_EQ(checkDiscMesh(mesh), "");
}

TEST(CheckDiscMesh, APartThatHangsOnOneNodeIsRefused) {
  DiscMesh mesh = makeDiscMesh(kLumbarShape);
  const int hinge = 37 + 36;  // a free node of the side
  const Vector3d x = mesh.rest_positions[hinge];
  for (int k = 0; k < 3; ++k) mesh.rest_positions.push_back(x + 0.005 * Vector3d::Unit(k));
  mesh.tets.push_back({hinge, 185, 186, 187});
  mesh.cells.push_back(static_cast<int>(mesh.hoops.size()));
  mesh.hoops.push_back({185, 186});
  try {
    DiscElasticity elasticity(mesh, kDiscMaterial);
    FAIL() << "no exception";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("move freely"), std::string::npos) << e.what();
  }
}

TEST(CheckDiscMaterial, NamesEachFault) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(checkDiscMaterial(kDiscMaterial), "");
  EXPECT_EQ(checkDiscMaterial(homogeneousMaterial(1, 0)), "");
  const auto expectFault = [](DiscMaterial m, double DiscMaterial::*member, double value,
                              const char* word) {
    m.*member = value;
    EXPECT_NE(checkDiscMaterial(m).find(word), std::string::npos) << checkDiscMaterial(m);
    EXPECT_THROW(DiscBatch({{makeDiscMesh(kLumbarShape), m}}), std::invalid_argument);
  };
  const double infinity = std::numeric_limits<double>::infinity();
  for (double bad : {0.0, -1.0, nan, infinity}) {
    expectFault(kDiscMaterial, &DiscMaterial::annulus_modulus, bad, "modulus of the annulus");
    expectFault(kDiscMaterial, &DiscMaterial::nucleus_modulus, bad, "modulus of the nucleus");
    expectFault(kDiscMaterial, &DiscMaterial::nucleus_bulk_modulus, bad, "bulk");
  }
  for (double bad : {-1.0, nan, infinity}) {
    expectFault(kDiscMaterial, &DiscMaterial::fibre_modulus, bad, "modulus of the fibres");
    expectFault(kDiscMaterial, &DiscMaterial::fibre_stiffening, bad, "stiffening");
    expectFault(kDiscMaterial, &DiscMaterial::fibre_angle, bad, "angle");
  }
  for (double bad : {-0.1, 0.5, 0.7, nan}) {
    expectFault(kDiscMaterial, &DiscMaterial::annulus_poisson, bad, "Poisson");
  }
}

}  // namespace
}  // namespace torso
