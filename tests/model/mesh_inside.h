// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "model/tri_mesh.h"

namespace torso {

// How many shells a point lies in.
inline double windingNumber(const TriMesh& mesh, const Eigen::Vector3d& point) {
  double sum = 0;
  for (const auto& f : mesh.faces) {
    const Eigen::Vector3d a = mesh.vertices[f[0]] - point, b = mesh.vertices[f[1]] - point,
                          c = mesh.vertices[f[2]] - point;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += 2 * std::atan2(a.dot(b.cross(c)),
                          la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (4 * M_PI);
}

// Points `under` the surface of `a` [m] that lie inside `b`.
inline int pointsInside(const TriMesh& a, const TriMesh& b, double under) {
  std::vector<Eigen::Vector3d> normals(a.vertices.size(), Eigen::Vector3d::Zero());
  for (const auto& f : a.faces) {
    const Eigen::Vector3d n =
        (a.vertices[f[1]] - a.vertices[f[0]]).cross(a.vertices[f[2]] - a.vertices[f[0]]);
    for (int k : f) normals[k] += n;
  }
  Eigen::AlignedBox3d region;
  for (const Eigen::Vector3d& v : b.vertices) region.extend(v);
  int count = 0;
  for (std::size_t i = 0; i < a.vertices.size(); i++) {
    const Eigen::Vector3d p = a.vertices[i] - under * normals[i].normalized();
    if (region.contains(p) && windingNumber(b, p) > 0.5) count++;
  }
  return count;
}

}  // namespace torso
