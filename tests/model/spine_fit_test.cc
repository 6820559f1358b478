// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/spine_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "model/bone_mesh.h"

namespace torso {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kDegree = M_PI / 180;
const std::vector<std::string> kLumbar = {"L1", "L2", "L3", "L4", "L5"};

const Anatomy& anatomy() {
  static const Anatomy a = Anatomy::load(TORSO_ANATOMY_DIR);
  return a;
}

// Generated bones of a spine, in the standing body.
const std::map<std::string, TriMesh>& lumbarSpine() {
  static const auto meshes = [] {
    std::map<std::string, TriMesh> out;
    for (const std::string& level : kLumbar) out[level] = boneMesh(anatomy(), level)[0].mesh;
    return out;
  }();
  return meshes;
}

SpineLandmarks landmarks(const std::map<std::string, TriMesh>& meshes) {
  SpineLandmarks out;
  for (const auto& [level, mesh] : meshes) {
    out[level] = findLandmarks(mesh, vertebraPrior(anatomy(), level));
  }
  return out;
}

TEST(SpineFit, GivesTheSpineBackThatTheBonesAreFrom) {
  const SpineLandmarks found = landmarks(lumbarSpine());
  EXPECT_NEAR(spineScale(anatomy(), found), 1, 0.02);
  const SpineFit fit = fitSpine(anatomy(), found);
  EXPECT_TRUE(fit.common_frame);
  for (const Vertebra& v : fit.anatomy.vertebrae) {
    const Vertebra& old = anatomy().vertebra(v.name);
    EXPECT_LT((v.position - old.position).norm(), 4e-3) << v.name;
    EXPECT_NEAR(v.pitch, old.pitch, 2 * kDegree) << v.name;
  }
  for (const std::string& level : kLumbar) {
    const Isometry3d& X = fit.placement.at(level);
    EXPECT_LT((X * anatomy().vertebra(level).position - anatomy().vertebra(level).position).norm(),
              4e-3);
  }
  for (std::size_t i = 0; i < fit.anatomy.discs.size(); i++) {
    const DiscShape &now = fit.anatomy.discs[i].shape, &old = anatomy().discs[i].shape;
    EXPECT_NEAR(now.height_anterior, old.height_anterior, 1.5e-3) << fit.anatomy.discs[i].name;
    EXPECT_NEAR(now.height_posterior, old.height_posterior, 1.5e-3) << fit.anatomy.discs[i].name;
    EXPECT_NEAR(now.width, old.width, 2e-3) << fit.anatomy.discs[i].name;
    EXPECT_NEAR(now.depth, old.depth, 2e-3) << fit.anatomy.discs[i].name;
  }
}

// Discs lie between the endplates of the meshes as placed, wherever those were in the files.
TEST(SpineFit, DiscsLieBetweenEndplates) {
  std::map<std::string, TriMesh> moved;
  double angle = 0.4;
  for (const auto& [level, mesh] : lumbarSpine()) {
    Isometry3d X = Isometry3d::Identity();
    X.rotate(AngleAxisd(angle += 0.7, Vector3d(1, angle, -0.3).normalized()));
    X.translation() = Vector3d(angle, 0.1, -angle);
    moved[level] = transformed(mesh, X);
  }
  const SpineLandmarks found = landmarks(moved);
  const SpineFit fit = fitSpine(anatomy(), found);
  EXPECT_FALSE(fit.common_frame);
  for (const Disc& disc : fit.anatomy.discs) {
    for (bool upper : {true, false}) {
      const std::string& level = upper ? disc.upper : disc.lower;
      if (!found.count(level)) continue;
      const Landmark& plate =
          upper ? found.at(level).lower_endplate : found.at(level).upper_endplate;
      const Isometry3d into_disc = disc.frame.inverse() * fit.placement.at(level);
      const Vector3d centre = into_disc * plate.centre, normal = into_disc.linear() * plate.normal;
      const double sign = upper ? 1 : -1;
      const double middle = (disc.shape.height_anterior + disc.shape.height_posterior) / 4;
      EXPECT_NEAR(centre.z(), sign * middle, 0.5e-3) << disc.name;
      EXPECT_NEAR(centre.y(), 0, 1e-3) << disc.name;
      EXPECT_NEAR(centre.x(), 0, 2e-3) << disc.name;
      // The wedge opens to the front by half at each plate.
      const double half_wedge = std::atan(
          (disc.shape.height_anterior - disc.shape.height_posterior) / disc.shape.depth / 2);
      const Vector3d up = -sign * normal;
      EXPECT_NEAR(std::atan2(up.x(), up.z()), -sign * half_wedge, 3 * kDegree) << disc.name;
    }
  }
}

TEST(SpineFit, FacetsEncloseTheProcessBelowAndHoldTheFaceAbove) {
  const SpineLandmarks found = landmarks(lumbarSpine());
  const SpineFit fit = fitSpine(anatomy(), found);
  std::map<std::string, TriMesh> placed;
  for (const auto& [level, X] : fit.placement) {
    placed[level] = transformed(lumbarSpine().at(level), X);
  }
  const auto facets = fittedFacets(fit, found, placed);
  ASSERT_EQ(facets.size(), 74u);
  int fitted = 0;
  for (const Facet& facet : facets) {
    for (const Vector3d& p : facet.points) {
      const Vector3d r = (facet.ellipsoid.inverse() * p).cwiseQuotient(facet.radii);
      EXPECT_NEAR(r.norm(), 1, 1e-6) << facet.name;
    }
    if (!found.count(facet.points_body) || !found.count(facet.ellipsoid_body)) continue;
    fitted++;
    const int side = facet.name.find("right") != std::string::npos ? 1 : 0;
    const Landmark& above = found.at(facet.points_body).inferior_face[side];
    const Landmark& below = found.at(facet.ellipsoid_body).superior_face[side];
    const Vector3d face = fit.placement.at(facet.points_body) * above.centre;
    Vector3d mean = Vector3d::Zero();
    for (const Vector3d& p : facet.points) mean += p / 4;
    EXPECT_LT((mean - face).norm(), 3e-3) << facet.name;
    // Not on one line.
    const Vector3d a = facet.points[1] - facet.points[0], b = facet.points[2] - facet.points[0];
    EXPECT_GT(a.cross(b).norm(), 9e-6) << facet.name;
    const Vector3d r =
        (facet.ellipsoid.inverse() * (fit.placement.at(facet.ellipsoid_body) * below.centre))
            .cwiseQuotient(facet.radii);
    EXPECT_LT(r.norm(), 1.02) << facet.name;
  }
  EXPECT_EQ(fitted, 8);
}

TEST(SpineFit, MissingLevelsFollowTheirNeighbours) {
  std::map<std::string, TriMesh> large;
  for (const char* level : {"L1", "L3", "L5"}) {
    large[level] = lumbarSpine().at(level);
    for (Vector3d& v : large[level].vertices) v *= 1.2;
  }
  const SpineFit fit = fitSpine(anatomy(), landmarks(large));
  for (const char* level : {"L2", "L4"}) {
    const Vertebra &now = fit.anatomy.vertebra(level), &old = anatomy().vertebra(level);
    EXPECT_NEAR(now.upper_endplate_width / old.upper_endplate_width, 1.2, 0.05) << level;
    EXPECT_NEAR(now.body_height_anterior / old.body_height_anterior, 1.2, 0.05) << level;
  }
  // The neck is as before, but higher.
  const Vertebra &now = fit.anatomy.vertebra("C5"), &old = anatomy().vertebra("C5");
  EXPECT_NEAR(now.upper_endplate_width, old.upper_endplate_width, 1e-9);
  const double risen = now.position.z() - old.position.z();
  EXPECT_GT(risen, 0.02);
  EXPECT_NEAR(fit.anatomy.landmark("head_vertex").z() - anatomy().landmark("head_vertex").z(),
              risen, 2e-3);
  EXPECT_NEAR(fit.anatomy.landmark("hip_joint_centre").z(),
              anatomy().landmark("hip_joint_centre").z(), 1e-12);
}

}  // namespace
}  // namespace torso
