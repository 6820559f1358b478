// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// How bones are shown in plates, as those of an atlas.

#include <mujoco/mujoco.h>

#include <vector>

namespace torso::tools {

struct View {
  double azimuth, elevation;  // of a free camera [deg]
};

// The scene as a plain, light background, seen from afar (8 degrees of view), so that one scale
// holds in depth. Light comes from the camera's upper left and casts no shadows, which are patches
// on smooth bones.
void preparePlate(mjModel* m);

// Lights for a view, in a state whose positions are known.
void placeLight(const mjModel* m, mjData* d, const View& view);

// A picture of width x height (RGB) from one that is kFiner times as wide and as high: drivers
// without a graphics card smooth edges little.
constexpr int kFiner = 2;
std::vector<unsigned char> shrink(const std::vector<unsigned char>& fine, int width, int height);

}  // namespace torso::tools
