// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Where a ray meets one triangle; of whole meshes see mesh_checks.h and mesh_section.h.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>

#include "model/tri_mesh.h"

namespace torso {

using Triangle = std::array<Eigen::Vector3d, 3>;

inline Triangle corners(const TriMesh& mesh, int face) {
  const auto& f = mesh.faces[face];
  return {mesh.vertices[f[0]], mesh.vertices[f[1]], mesh.vertices[f[2]]};
}

// Distance along a ray to the plane of a face if it passes the face, else a negative number; its
// sign of passage, if sign is not null: +1 out of the solid, -1 into it.
inline double passage(const Triangle& t, const Eigen::Vector3d& origin,
                      const Eigen::Vector3d& direction, int* sign) {
  const Eigen::Vector3d e1 = t[1] - t[0], e2 = t[2] - t[0], p = direction.cross(e2);
  const double det = e1.dot(p);
  if (det == 0) return -1;
  const Eigen::Vector3d s = origin - t[0], q = s.cross(e1);
  const double u = s.dot(p) / det, v = direction.dot(q) / det;
  if (!(u >= 0 && v >= 0 && u + v <= 1)) return -1;
  if (sign) *sign = det < 0 ? 1 : -1;
  return e2.dot(q) / det;
}

}  // namespace torso
