// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "plugin/facet_collider.h"

namespace torso::plugin {

FacetGap pointGap(const mjModel* m, const mjData* d, const FacetEntry& facet, int point_geom) {
  const int ellipsoid = facet.ellipsoid_geom;
  mjtNum offset[3], local[3];
  mju_sub3(offset, d->geom_xpos + 3 * point_geom, d->geom_xpos + 3 * ellipsoid);
  mju_rotVecMatT(local, offset, d->geom_xmat + 9 * ellipsoid);
  const mjtNum* size = m->geom_size + 3 * ellipsoid;
  FacetGap gap = facetGap(Eigen::Vector3d(local[0], local[1], local[2]),
                          Eigen::Vector3d(size[0], size[1], size[2]), facet.band);
  const mjtNum normal[3] = {gap.normal[0], gap.normal[1], gap.normal[2]};
  mju_rotVecMat(gap.normal.data(), normal, d->geom_xmat + 9 * ellipsoid);
  return gap;
}

int collideFacet(const mjModel* m, const mjData* d, const FacetEntry& facet, mjContact* con,
                 int point_geom) {
  const FacetGap gap = pointGap(m, d, facet, point_geom);
  if (gap.violation <= 0) return 0;
  // The contact pushes geom1, the point, against the frame's first axis.
  con->dist = -gap.violation;
  mju_copy3(con->pos, d->geom_xpos + 3 * point_geom);
  mju_scl3(con->frame, gap.normal.data(), -1);
  mju_zero3(con->frame + 3);
  return 1;
}

}  // namespace torso::plugin
