// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The facets of the torso: which bones, which ellipsoid, which points (their law: facet_gap.h).

#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include "model/anatomy.h"
#include "model/skeleton.h"

namespace torso {

struct Facet {
  enum class Kind { kZygapophyseal, kCostovertebral, kCostotransverse, kScapulothoracic };
  std::string name;  // "L4/L5_left", "T1_costovertebral_left", "scapulothoracic_left"
  Kind kind;
  std::string points_body, ellipsoid_body;  // A, B
  Eigen::Isometry3d ellipsoid;              // frame in the standing body
  Eigen::Vector3d radii;                    // [m]
  std::array<Eigen::Vector3d, 4> points;    // on C = 0 at rest, in the standing body [m]
  double band;
};

// The 74 facets: 22 gaps x 2, T1-T7 x (costovertebral, costotransverse) x 2, scapulothoracic x 2.
std::vector<Facet> makeFacets(const Anatomy& anatomy);

// The same with the scapulothoracic ones fitted to the bones: their points on the costal surface of
// the scapula, their ellipsoid through them; if the skeleton has the left scapula.
std::vector<Facet> makeFacets(const Anatomy& anatomy, const Skeleton& skeleton);

// Fits a left scapulothoracic facet to the left scapula (standing body [m]): moves its points to
// the costal surface, and half axes and centre of the ellipsoid by some millimetres so that it
// passes through them. size: of the body, over the tables'.
void fitToScapula(const MeshTree& scapula, double size, Facet* facet);

}  // namespace torso
