// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mujoco/mujoco.h>

#include "model/facet.h"
#include "plugin/instance.h"

namespace torso::plugin {

// Where a facet's point stands in its band; normal in the world frame.
FacetGap pointGap(const mjModel* m, const mjData* d, const FacetEntry& facet, int point_geom);

// A frictionless contact that moves the point back into its band; returns the number of contacts,
// 0 while it is within. Only for the geoms of one facet.
int collideFacet(const mjModel* m, const mjData* d, const FacetEntry& facet, mjContact* con,
                 int point_geom);

}  // namespace torso::plugin
