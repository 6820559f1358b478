// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mujoco/mujoco.h>

#include "model/facet_gap.h"
#include "plugin/instance.h"

namespace torso::plugin {

// Where a facet's point stands in its band; normal in the world frame.
FacetGap pointGap(const mjModel* m, const mjData* d, const FacetEntry& facet, int point_geom);

// A frictionless contact that keeps the point in its band; returns the number of contacts. There is
// one if the point is beyond the band or would, at its present speed, leave it within two steps:
// the constraint then acts in the step in which the band would be left, not after it. Its normal is
// that of the place where the point is going. contact.dist is always kFacetDistance, which makes
// MuJoCo include the contact; rewriteLimits puts the law's gap into its row.
int collideFacet(const mjModel* m, const mjData* d, const FacetEntry& facet, mjContact* con,
                 int point_geom);

// The law's gap of a point [m] at the velocities as they are now. MuJoCo's finite differences
// change them without detecting collisions again, so contact.dist may be out of date.
double facetLimitGap(const mjModel* m, const mjData* d, const FacetEntry& facet, int point_geom);

inline constexpr double kFacetDistance = -1;  // [m], below the gap of the MJCF's facet pairs

}  // namespace torso::plugin
