// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "plugin/facet_collider.h"

#include <algorithm>

#include "plugin/limit.h"
#include "plugin/point_velocity.h"

namespace torso::plugin {
namespace {

// Gap of a world point; normal in the world frame.
FacetGap gapAt(const mjModel* m, const mjData* d, const FacetEntry& facet, int point_geom,
               const mjtNum point[3]) {
  const int ellipsoid = facet.ellipsoid_geom;
  mjtNum offset[3], local[3];
  mju_sub3(offset, point, d->geom_xpos + 3 * ellipsoid);
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

// Gaps of the point where it is, and where its present velocity takes it in a step.
struct Path {
  FacetGap now, then;
};
Path pathOf(const mjModel* m, const mjData* d, const FacetEntry& facet, int point_geom) {
  const mjtNum* point = d->geom_xpos + 3 * point_geom;
  const Eigen::Vector3d velocity = pointVelocity(m, d, m->geom_bodyid[point_geom], point) -
                                   pointVelocity(m, d, m->geom_bodyid[facet.ellipsoid_geom], point);
  mjtNum ahead[3];
  mju_addScl3(ahead, point, velocity.data(), m->opt.timestep);
  return {gapAt(m, d, facet, point_geom, point), gapAt(m, d, facet, point_geom, ahead)};
}

}  // namespace

FacetGap pointGap(const mjModel* m, const mjData* d, const FacetEntry& facet, int point_geom) {
  return gapAt(m, d, facet, point_geom, d->geom_xpos + 3 * point_geom);
}

double facetLimitGap(const mjModel* m, const mjData* d, const FacetEntry& facet, int point_geom) {
  const Path path = pathOf(m, d, facet, point_geom);
  return limitGap(-path.now.violation, -path.then.violation);
}

int collideFacet(const mjModel* m, const mjData* d, const FacetEntry& facet, mjContact* con,
                 int point_geom) {
  constexpr double kNear = 0.03;
  const mjtNum* point = d->geom_xpos + 3 * point_geom;
  const auto [now, then] = pathOf(m, d, facet, point_geom);
  // Forces change where the point will be, so look at those that come near the edge, too: within
  // two steps at this speed, or nearer than a share of the ellipsoid's size.
  const double approach = std::max(then.violation - now.violation, 0.0);
  const double near = kNear * mju_min(m->geom_size[3 * facet.ellipsoid_geom + 2],
                                      m->geom_size[3 * facet.ellipsoid_geom]);
  if (now.violation + 2 * approach + near <= 0) return 0;
  // The contact pushes geom1, the point, against the frame's first axis.
  con->dist = kFacetDistance;
  mju_copy3(con->pos, point);
  mju_scl3(con->frame, then.normal.data(), -1);
  mju_zero3(con->frame + 3);
  return 1;
}

}  // namespace torso::plugin
