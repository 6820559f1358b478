// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/facet_gap.h"

#include <cmath>

namespace torso {

using Eigen::Vector3d;

FacetGap facetGap(const Vector3d& point, const Vector3d& radii, double band, const Vector3d& rest) {
  // Past the middle: shares of the way from the centre to the rest place. A point that slides far
  // round the ellipsoid (the scapula's do, by 80 degrees) is not: it is near the surface all along.
  constexpr double kPast = 0.3, kFarSide = -0.3, kNearSurface = 0.5;
  const Vector3d inverse = radii.cwiseInverse();
  const Vector3d scaled = point.cwiseProduct(inverse), side = rest.cwiseProduct(inverse);
  const double along = scaled.dot(side);
  if (along < kFarSide || (along < kPast && scaled.squaredNorm() < kNearSurface)) {
    const Vector3d gradient = side.cwiseProduct(inverse);
    const double slope = gradient.norm();
    return {(std::sqrt(1 - band) - along) / slope, gradient / slope};
  }
  const double C = scaled.squaredNorm() - 1;
  const Vector3d gradient = 2 * scaled.cwiseProduct(inverse);
  const double slope = gradient.norm();
  return {(std::abs(C) - band) / slope, (C > 0 ? -1 : 1) / slope * gradient};
}

}  // namespace torso
