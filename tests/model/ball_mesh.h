// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <vector>

#include "model/loft.h"

namespace torso {

// A ball with `sides` points around along meridians.
inline TriMesh ballMesh(const Eigen::Vector3d& centre, double radius, int sides) {
  std::vector<Ring> rings;
  for (int k = 1; k < sides / 2; k++) {
    const double latitude = 2 * M_PI * k / sides - M_PI / 2;
    Ring ring;
    for (int i = 0; i < sides; i++) {
      const double longitude = 2 * M_PI * (i + 0.5) / sides;
      ring.push_back({std::cos(latitude) * std::cos(longitude),
                      std::cos(latitude) * std::sin(longitude), std::sin(latitude)});
    }
    rings.push_back(ring);
  }
  TriMesh mesh = loft(rings);  // its ends are flat
  for (Eigen::Vector3d& v : mesh.vertices) v = centre + radius * v.normalized();
  return mesh;
}

}  // namespace torso
