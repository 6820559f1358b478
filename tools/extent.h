// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mujoco/mujoco.h>

#include <functional>

namespace torso::tools {

// True for the geoms of bodies, false for what stands around them: geoms of the world body, planes
// and height fields.
bool isBodyGeom(const mjModel* m, int geom);

// Interval that geoms cover along a direction [m]; empty (min > max) if there are none.
struct Interval {
  double min, max;
  bool empty() const { return min > max; }
};

// Smallest and largest dot(direction, x) over the points x of the body geoms that `accept` takes
// (all, if it is null), exact for every geom type. Needs mj_kinematics.
Interval extent(const mjModel* m, const mjData* d, const mjtNum direction[3],
                const std::function<bool(int geom)>& accept = nullptr);

// Height of the model's body in its reference pose qpos0: top of its highest geom above the bottom
// of its lowest, visual ones included [m]; 0 if it has no geoms.
double stature(const mjModel* m);

}  // namespace torso::tools
