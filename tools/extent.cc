// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/extent.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/mujoco_support.h"

namespace torso::tools {
namespace {

// Largest dot(n, x) over the points of the geom, relative to its centre; n in the geom's frame.
double support(const mjModel* m, int geom, const mjtNum n[3]) {
  const mjtNum* size = m->geom_size + 3 * geom;
  const double radial = std::hypot(n[0], n[1]);
  switch (m->geom_type[geom]) {
    case mjGEOM_SPHERE:
      return size[0] * mju_norm3(n);
    case mjGEOM_CAPSULE:
      return size[0] * mju_norm3(n) + size[1] * std::abs(n[2]);
    case mjGEOM_ELLIPSOID:
      return std::hypot(size[0] * n[0], size[1] * n[1], size[2] * n[2]);
    case mjGEOM_CYLINDER:
      return size[0] * radial + size[1] * std::abs(n[2]);
    case mjGEOM_BOX:
      return size[0] * std::abs(n[0]) + size[1] * std::abs(n[1]) + size[2] * std::abs(n[2]);
    case mjGEOM_MESH: {
      const int mesh = m->geom_dataid[geom];
      const float* v = m->mesh_vert + 3 * m->mesh_vertadr[mesh];
      double largest = -std::numeric_limits<double>::infinity();
      for (int i = 0; i < m->mesh_vertnum[mesh]; i++, v += 3) {
        largest = std::max(largest, n[0] * v[0] + n[1] * v[1] + n[2] * v[2]);
      }
      return largest;
    }
    default:
      return 0;
  }
}

}  // namespace

bool isBodyGeom(const mjModel* m, int geom) {
  return m->geom_bodyid[geom] != 0 && m->geom_type[geom] != mjGEOM_PLANE &&
         m->geom_type[geom] != mjGEOM_HFIELD;
}

Interval extent(const mjModel* m, const mjData* d, const mjtNum direction[3],
                const std::function<bool(int geom)>& accept) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  Interval interval = {kInf, -kInf};
  for (int g = 0; g < m->ngeom; g++) {
    if (!isBodyGeom(m, g) || (accept && !accept(g))) continue;
    const double centre = mju_dot3(direction, d->geom_xpos + 3 * g);
    mjtNum n[3];
    mju_rotVecMatT(n, direction, d->geom_xmat + 9 * g);
    interval.max = std::max(interval.max, centre + support(m, g, n));
    mju_scl3(n, n, -1);
    interval.min = std::min(interval.min, centre - support(m, g, n));
  }
  return interval;
}

double stature(const mjModel* m) {
  const DataPtr d = makeData(m);
  mj_kinematics(m, d.get());
  const mjtNum up[3] = {0, 0, 1};
  const Interval z = extent(m, d.get(), up);
  return z.empty() ? 0 : z.max - z.min;
}

}  // namespace torso::tools
