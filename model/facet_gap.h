// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The law of a facet: four points of bone A slide on an ellipsoid of bone B, |C(p)| <= band with
// C(p) = |S^-1 R^T (p - centre)|^2 - 1.

#include <Eigen/Core>

namespace torso {

// Where a point stands in its facet's band. In the frame of the ellipsoid.
struct FacetGap {
  double violation;        // distance beyond the band [m], 0 or less within it
  Eigen::Vector3d normal;  // unit; direction in which the point must move back
};

// point: in the frame of the ellipsoid [m]. radii: its half axes [m], > 0; band: bound of |C|,
// 0 < band < 1. rest: the point's place at rest, on C = 0; a point that has got past the middle of
// the ellipsoid, where the level sets would push it out on the wrong side, is pushed back to that
// side; one that slides by up to 107 degrees (in the ellipsoid's own scale) round the surface is
// not. The distance is exact to first order in the violation (level set function over its
// gradient).
FacetGap facetGap(const Eigen::Vector3d& point, const Eigen::Vector3d& radii, double band,
                  const Eigen::Vector3d& rest);

}  // namespace torso
