// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "plugin/facet_collider.h"

#include <algorithm>

namespace torso::plugin {

FacetGap pointGap(const mjModel* m, const mjData* d, const FacetEntry& facet, int point_geom) {
  const int ellipsoid = facet.ellipsoid_geom;
  mjtNum offset[3], local[3];
  mju_sub3(offset, d->geom_xpos + 3 * point_geom, d->geom_xpos + 3 * ellipsoid);
  mju_rotVecMatT(local, offset, d->geom_xmat + 9 * ellipsoid);
  const mjtNum* size = m->geom_size + 3 * ellipsoid;
  const int k = static_cast<int>(std::find(facet.point_geoms, facet.point_geoms + 3, point_geom) -
                                 facet.point_geoms);
  FacetGap gap = facetGap(Eigen::Vector3d(local[0], local[1], local[2]),
                          Eigen::Vector3d(size[0], size[1], size[2]), facet.band, facet.rest[k]);
  const mjtNum normal[3] = {gap.normal[0], gap.normal[1], gap.normal[2]};
  mju_rotVecMat(gap.normal.data(), normal, d->geom_xmat + 9 * ellipsoid);
  return gap;
}

namespace {

// Velocity of a world point of a body, from positions and qvel alone (d->cvel is still that of the
// step before when collisions are computed).
Eigen::Vector3d pointVelocity(const mjModel* m, const mjData* d, int body, const mjtNum* point) {
  while (body && !m->body_dofnum[body]) body = m->body_parentid[body];
  Eigen::Vector3d angular = Eigen::Vector3d::Zero(), linear = Eigen::Vector3d::Zero();
  if (!body) return linear;
  const mjtNum* com = d->subtree_com + 3 * m->body_rootid[body];
  for (int i = m->body_dofadr[body] + m->body_dofnum[body] - 1; i >= 0; i = m->dof_parentid[i]) {
    const mjtNum* axis = d->cdof + 6 * i;
    angular += d->qvel[i] * Eigen::Vector3d(axis[0], axis[1], axis[2]);
    linear += d->qvel[i] * Eigen::Vector3d(axis[3], axis[4], axis[5]);
  }
  const Eigen::Vector3d offset(point[0] - com[0], point[1] - com[1], point[2] - com[2]);
  return linear + angular.cross(offset);
}

}  // namespace

int collideFacet(const mjModel* m, const mjData* d, const FacetEntry& facet, mjContact* con,
                 int point_geom) {
  const FacetGap gap = pointGap(m, d, facet, point_geom);
  const mjtNum* point = d->geom_xpos + 3 * point_geom;
  if (gap.violation <= 0) {
    const Eigen::Vector3d velocity =
        pointVelocity(m, d, m->geom_bodyid[point_geom], point) -
        pointVelocity(m, d, m->geom_bodyid[facet.ellipsoid_geom], point);
    const double outward = -velocity.dot(gap.normal);
    if (gap.violation + 2 * m->opt.timestep * outward <= 0) return 0;
  }
  // The contact pushes geom1, the point, against the frame's first axis.
  con->dist = -gap.violation - kFacetLookAhead;
  mju_copy3(con->pos, point);
  mju_scl3(con->frame, gap.normal.data(), -1);
  mju_zero3(con->frame + 3);
  return 1;
}

}  // namespace torso::plugin
