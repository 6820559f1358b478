// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/facet.h"
#include "model/facet_gap.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "model/body.h"

namespace torso {
namespace {

using Eigen::Vector3d;

constexpr double kBand = 0.2;

double levelSet(const Vector3d& p, const Vector3d& radii) {
  return p.cwiseQuotient(radii).squaredNorm() - 1;
}

// On a sphere of radius r the band is the shell r sqrt(1 - band) .. r sqrt(1 + band).
TEST(FacetGapTest, OnASphereIsTheDistanceToTheShell) {
  const double r = 0.02, inner = r * std::sqrt(1 - kBand), outer = r * std::sqrt(1 + kBand);
  const Vector3d direction = Vector3d(1, 2, 3).normalized(), radii = Vector3d::Constant(r);
  const double depth = 1e-5;
  const FacetGap out = facetGap((outer + depth) * direction, radii, kBand, r * direction);
  EXPECT_NEAR(out.violation, depth, 1e-3 * depth);
  EXPECT_LT((out.normal + direction).norm(), 1e-12) << "a point outside must come back in";
  const FacetGap in = facetGap((inner - depth) * direction, radii, kBand, r * direction);
  EXPECT_NEAR(in.violation, depth, 1e-3 * depth);
  EXPECT_LT((in.normal - direction).norm(), 1e-12) << "a point inside must come out";
}

TEST(FacetGapTest, IsZeroOnTheBandsEdgesAndNegativeBetween) {
  const double r = 0.02;
  const Vector3d radii = Vector3d::Constant(r), x = Vector3d::UnitX();
  for (double edge : {1 - kBand, 1 + kBand}) {
    EXPECT_NEAR(facetGap(r * std::sqrt(edge) * x, radii, kBand, r * x).violation, 0, 1e-15);
  }
  for (double C : {-0.19, -0.1, 0.0, 0.1, 0.19}) {
    EXPECT_LT(facetGap(r * std::sqrt(1 + C) * x, radii, kBand, r * x).violation, 0) << C;
  }
}

// The normal is the direction in which the level set's distance to the band falls fastest.
TEST(FacetGapTest, NormalIsTheGradientOfTheLevelSet) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const Vector3d radii(0.015, 0.021, 0.005);
  int checked = 0;
  for (int trial = 0; trial < 200; trial++) {
    const Vector3d side = Vector3d(normal(random), normal(random), normal(random)).normalized();
    const Vector3d rest = side.cwiseProduct(radii);
    // Somewhere near the rest place, within or beyond the band.
    const Vector3d p =
        rest + 0.3 * Vector3d(normal(random), normal(random), normal(random)).cwiseProduct(radii);
    if (p.cwiseQuotient(radii).dot(side) < 0.35) continue;
    const FacetGap gap = facetGap(p, radii, kBand, rest);
    const double C = levelSet(p, radii);
    Vector3d gradient;
    for (int i = 0; i < 3; i++) {
      const Vector3d e = 1e-7 * Vector3d::Unit(i);
      gradient[i] = (levelSet(p + e, radii) - levelSet(p - e, radii)) / 2e-7;
    }
    EXPECT_NEAR(gap.normal.norm(), 1, 1e-12);
    EXPECT_LT((gap.normal - (C > 0 ? -1 : 1) * gradient.normalized()).norm(), 1e-6);
    EXPECT_NEAR(gap.violation, (std::abs(C) - kBand) / gradient.norm(), 1e-9);
    checked++;
  }
  EXPECT_GT(checked, 100);
}

// Following the normal by the violation a few times leads back to the face, also for a point that
// has got through the ellipsoid and out at its back.
TEST(FacetGapTest, LeadsBackFromTheWrongSide) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Vector3d radii(0.015, 0.021, 0.005);
  const Vector3d rest = Vector3d(0.2, -0.1, std::sqrt(0.95)).cwiseProduct(radii);
  int wrong = 0;
  for (int trial = 0; trial < 200; trial++) {
    // Anywhere above or below the middle of the face.
    Vector3d p = Vector3d(0.6 * uniform(random), 0.6 * uniform(random), 2 * uniform(random))
                     .cwiseProduct(radii);
    if (p.cwiseQuotient(radii).dot(rest.cwiseQuotient(radii)) < 0) {
      wrong++;
      EXPECT_GT(facetGap(p, radii, kBand, rest).violation, 0) << "the wrong side is no rest";
    }
    for (int i = 0; i < 20; i++) {
      const FacetGap gap = facetGap(p, radii, kBand, rest);
      ASSERT_TRUE(std::isfinite(gap.violation) && gap.normal.allFinite());
      if (gap.violation > 0) p += gap.violation * gap.normal;
    }
    EXPECT_LT(std::abs(levelSet(p, radii)), kBand + 1e-6);
    EXPECT_GT(p.cwiseQuotient(radii).dot(rest.cwiseQuotient(radii)), 0) << "on the rest's side";
  }
  EXPECT_GT(wrong, 50);
}

// The scapula's points slide by more than a quarter round their ellipsoid.
TEST(FacetGapTest, LetsAPointSlideFarRound) {
  const Vector3d radii(0.09, 0.06, 0.16), rest(0, radii.y(), 0);
  for (double angle = 0; angle < 100 * M_PI / 180; angle += 0.01) {
    const Vector3d p =
        Vector3d(0.8 * std::sin(angle), std::cos(angle), 0.6 * std::sin(angle)).cwiseProduct(radii);
    EXPECT_LT(facetGap(p, radii, kBand, rest).violation, 0) << angle;
  }
}

TEST(FacetGapTest, CentreIsNoSingularity) {
  const Vector3d radii(0.015, 0.021, 0.005), rest(0, 0, 0.005);
  const FacetGap gap = facetGap(Vector3d::Zero(), radii, kBand, rest);
  EXPECT_LT((gap.normal - Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_NEAR(gap.violation, std::sqrt(1 - kBand) * 0.005, 1e-12);
}

class FacetsTest : public ::testing::Test {
 protected:
  const Anatomy anatomy = Anatomy::load(TORSO_ANATOMY_DIR);
  const std::vector<Facet> facets = makeFacets(anatomy);
};

TEST_F(FacetsTest, CountsByKind) {
  std::map<Facet::Kind, int> count;
  for (const Facet& f : facets) count[f.kind]++;
  EXPECT_EQ(count[Facet::Kind::kZygapophyseal], 44);
  EXPECT_EQ(count[Facet::Kind::kCostovertebral], 14);
  EXPECT_EQ(count[Facet::Kind::kCostotransverse], 14);
  EXPECT_EQ(count[Facet::Kind::kScapulothoracic], 2);
}

TEST_F(FacetsTest, PointsLieOnTheEllipsoidAtRest) {
  for (const Facet& f : facets) {
    EXPECT_GT(f.radii.minCoeff(), 0) << f.name;
    EXPECT_GT(f.band, 0) << f.name;
    EXPECT_LT(f.band, 1) << f.name;
    for (const Vector3d& p : f.points) {
      EXPECT_NEAR(levelSet(f.ellipsoid.inverse() * p, f.radii), 0, 1e-9) << f.name;
    }
  }
}

TEST_F(FacetsTest, FramesAreRotationsAndBodiesExist) {
  for (const Facet& f : facets) {
    const Eigen::Matrix3d R = f.ellipsoid.linear();
    EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12) << f.name;
    EXPECT_GT(R.determinant(), 0) << f.name;
    EXPECT_NO_THROW(bodyFrame(anatomy, f.points_body)) << f.name;
    EXPECT_NO_THROW(bodyFrame(anatomy, f.ellipsoid_body)) << f.name;
    EXPECT_NE(f.points_body, f.ellipsoid_body) << f.name;
  }
}

TEST_F(FacetsTest, RightIsTheMirrorOfLeft) {
  std::map<std::string, const Facet*> by_name;
  for (const Facet& f : facets) by_name[f.name] = &f;
  ASSERT_EQ(by_name.size(), facets.size()) << "names are unique";
  int pairs = 0;
  for (const Facet& left : facets) {
    const std::size_t at = left.name.rfind("left");
    if (at == std::string::npos) continue;
    std::string name = left.name;
    name.replace(at, 4, "right");
    ASSERT_EQ(by_name.count(name), 1u) << name;
    const Facet& right = *by_name[name];
    pairs++;
    EXPECT_EQ(left.radii, right.radii);
    for (int i = 0; i < 4; i++) EXPECT_EQ(mirror(left.points[i]), right.points[i]) << name;
    // The two ellipsoids have the same level set at mirrored places.
    for (const Vector3d& p : {Vector3d(0.1, 0.05, 0.2), Vector3d(-0.03, 0.01, 0.4)}) {
      const double C = levelSet(left.ellipsoid.inverse() * p, left.radii);
      EXPECT_NEAR(levelSet(right.ellipsoid.inverse() * mirror(p), right.radii), C,
                  1e-9 * std::abs(C))
          << name;
    }
  }
  EXPECT_EQ(pairs, 37);
}

}  // namespace
}  // namespace torso
