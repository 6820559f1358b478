// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/bone_measure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <stdexcept>

#include "model/loft.h"
#include "model/vertebra_measure.h"
#include "tests/model/anatomy_copy.h"

namespace torso {
namespace {

using Eigen::Vector3d;

constexpr double kMm = 1e-3;

TriMesh box(const Vector3d& low, const Vector3d& high) {
  const auto at = [&](double z) {
    return Ring{{high.x(), low.y(), z},
                {high.x(), high.y(), z},
                {low.x(), high.y(), z},
                {low.x(), low.y(), z}};
  };
  TriMesh mesh = loft({at(low.z()), at(high.z())});
  for (Vector3d& p : mesh.vertices) p *= kMm;
  return mesh;
}

// A vertebra of simple shapes [mm]: body 42 x 32, 25 high in front and 23 behind; pedicles 8 x 14
// and 22 apart; canal 14 deep; transverse processes 90 across; spinous process to x = -65.
TriMesh blockVertebra() {
  std::vector<Ring> rings;
  for (double sign : {-1.0, 1.0}) {
    Ring ring;
    for (int i = 0; i < 96; i++) {
      const double a = 2 * M_PI * i / 96, x = 16 * std::cos(a);
      ring.push_back(Vector3d(x, 21 * std::sin(a), sign * (12 + x / 32)) * kMm);
    }
    rings.push_back(ring);
  }
  TriMesh mesh = loft(rings);
  for (double side : {1.0, -1.0}) {
    TriMesh arch = box({-30, 11, -3}, {-10, 19, 11});
    append(arch, box({-34, 17, 0}, {-29, 45, 6}));
    append(mesh, side > 0 ? arch : mirrored(arch));
  }
  append(mesh, box({-34, -19, -11}, {-30, 19, 8}));
  append(mesh, box({-65, -3, -10}, {-33, 3, 0}));
  return mesh;
}

TEST(VertebraShape, OfSimpleShapes) {
  const MeshTree tree(blockVertebra());
  const VertebraShape v(tree, 1);
  for (bool upper : {true, false}) {
    EXPECT_NEAR(v.endplate(upper).width, 42 * kMm, 0.3 * kMm) << upper;
    EXPECT_NEAR(v.endplate(upper).depth, 32 * kMm, 0.3 * kMm) << upper;
    EXPECT_NEAR(v.endplate(upper).slope, (upper ? 1 : -1) / 32.0, 1e-3) << upper;
  }
  EXPECT_NEAR(v.height(true), 25 * kMm, 0.2 * kMm);
  EXPECT_NEAR(v.height(false), 23 * kMm, 0.2 * kMm);
  EXPECT_NEAR(v.canalDepth(), 14 * kMm, 0.1 * kMm);
  ASSERT_TRUE(v.pedicle());
  EXPECT_NEAR(2 * v.pedicle()->medial, 22 * kMm, 0.1 * kMm);
  EXPECT_NEAR(v.pedicle()->width, 8 * kMm, 0.1 * kMm);
  EXPECT_NEAR(v.pedicle()->height, 14 * kMm, 0.2 * kMm);
  EXPECT_NEAR(v.transverseSpan(), 90 * kMm, 1e-9);
  // The body and, of the pedicles of 14 mm, what lies beside it.
  EXPECT_GT(v.bodyVolume(), M_PI * 16 * 21 * 24 * 1e-9 * 0.99);
  EXPECT_NEAR(v.spinousTipDistance(), std::hypot(65, 5) * kMm, 0.6 * kMm);
}

TEST(VertebraShape, WithoutAnArchHasNoPedicleAndNoCanal) {
  const MeshTree tree(box({-16, -21, -12}, {16, 21, 12}));
  const VertebraShape v(tree, 1);
  EXPECT_NEAR(v.bodyVolume(), 32 * 42 * 24 * 1e-9, 1e-9);
  EXPECT_FALSE(v.pedicle());
  EXPECT_FALSE(std::isfinite(v.canalDepth()));
  EXPECT_NEAR(v.height(true), 24 * kMm, 1e-9);
}

// An elliptic pillar whose top is the face; the search begins beside its middle.
TEST(FindFace, OfAnEllipticPillar) {
  for (double tilt : {0.0, 0.6}) {
    const Eigen::AngleAxisd turn(tilt, Vector3d::UnitY());
    std::vector<Ring> rings;
    for (double z : {-12.0, 0.0}) {
      Ring ring;
      for (int i = 0; i < 64; i++) {
        const double a = 2 * M_PI * i / 64;
        ring.push_back(turn * Vector3d(8 * std::cos(a), 5 * std::sin(a), z) * kMm);
      }
      rings.push_back(ring);
    }
    const MeshTree tree(loft(rings));
    const Vector3d normal = turn * Vector3d::UnitZ();
    const Vector3d guess = (normal + 0.15 * Vector3d(0.3, 1, 0)).normalized();
    const auto face =
        findFace(tree, turn * Vector3d(1.5, 1, 0) * kMm, guess, turn * Vector3d::UnitX(), 1);
    ASSERT_TRUE(face);
    EXPECT_NEAR(face->height, 16 * kMm, 0.9 * kMm);
    EXPECT_NEAR(face->width, 10 * kMm, 0.9 * kMm);
    EXPECT_NEAR(face->area, M_PI * 40 * kMm * kMm, 8 * kMm * kMm);
    EXPECT_GT(face->normal.dot(normal), std::cos(0.02));
    EXPECT_LT(face->centre.norm(), 0.6 * kMm);
  }
}

TEST(PublishedMeasures, AreReadAndScaled) {
  const auto rows = loadPublishedMeasures(TORSO_ANATOMY_DIR);
  std::set<std::pair<std::string, std::string>> seen;
  for (const PublishedMeasure& row : rows) {
    EXPECT_TRUE(seen.insert({row.bone, row.quantity}).second) << row.bone << row.quantity;
    EXPECT_FALSE(row.source.empty()) << row.bone << row.quantity;
    EXPECT_TRUE(std::set<std::string>(
                    {"measured", "quoted", "recalled", "blend", "interpolated", "assumed"})
                    .count(row.provenance))
        << row.provenance;
    const PublishedMeasure big = scaled(row, 2);
    const double factor = row.unit == "mm" ? 2 : row.unit == "mm2" ? 4 : row.unit == "cm3" ? 8 : 1;
    EXPECT_NEAR(big.mean, factor * row.mean, 1e-12);
    EXPECT_NEAR(tolerance(big), factor * tolerance(row), 1e-12);
  }
  PublishedMeasure row{"L4", "x", "mm", 0.040, 0.003, "", "", ""};
  EXPECT_TRUE(inside(row, 0.0429));
  EXPECT_FALSE(inside(row, 0.0431));
  row.sd = -1;  // 5 %
  EXPECT_TRUE(inside(row, 0.0419));
  EXPECT_FALSE(inside(row, 0.0421));
}

TEST(PublishedMeasures, FaultsAreNamedWithFileAndLine) {
  const auto message = [](const std::string& from, const std::string& to) -> std::string {
    AnatomyCopy copy(TORSO_ANATOMY_DIR);
    const int line = copy.replace("bone_measures.csv", from, to);
    try {
      loadPublishedMeasures(copy.folder());
    } catch (const std::runtime_error& e) {
      EXPECT_NE(std::string(e.what()).find("bone_measures.csv:" + std::to_string(line)),
                std::string::npos)
          << e.what();
      return e.what();
    }
    return "";
  };
  const std::string row = "L5,upper_endplate_width,mm,47.3,";
  EXPECT_NE(message(row, "L5,upper_endplate_width,inch,47.3,").find("inch"), std::string::npos);
  EXPECT_NE(message(row, "L5,upper_endplate_width,mm,wide,").find("mean"), std::string::npos);
  EXPECT_NE(message(row, "L5,upper_endplate_width,mm,47.3,-").find("sd"), std::string::npos);
}

}  // namespace
}  // namespace torso
