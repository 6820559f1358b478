// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "model/mesh_checks.h"

namespace torso {

// Points `under` the surface of `a` [m] that lie inside `b`.
inline int pointsInside(const MeshTree& a, const MeshTree& b, double under) {
  std::vector<Eigen::Vector3d> normals(a.mesh().vertices.size(), Eigen::Vector3d::Zero());
  for (const auto& f : a.mesh().faces) {
    const auto& v = a.mesh().vertices;
    const Eigen::Vector3d n = (v[f[1]] - v[f[0]]).cross(v[f[2]] - v[f[0]]);
    for (int k : f) normals[k] += n;
  }
  int count = 0;
  for (std::size_t i = 0; i < normals.size(); i++) {
    count += b.windingNumber(a.mesh().vertices[i] - under * normals[i].normalized()) > 0;
  }
  return count;
}

}  // namespace torso
