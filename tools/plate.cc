// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/plate.h"

#include <algorithm>
#include <cmath>

namespace torso::tools {

void preparePlate(mjModel* m) {
  std::fill_n(m->tex_rgb, m->ntexdata, mjtByte{247});
  std::fill_n(m->light_castshadow, m->nlight, mjtByte{0});
  const auto set = [](auto* rgb, float value) { std::fill_n(rgb, 3, value); };
  set(m->vis.headlight.ambient, 0.31f);
  set(m->vis.headlight.diffuse, 0.26f);
  set(m->vis.headlight.specular, 0.0f);
  for (int i = 0; i < m->nlight; i++) {
    set(m->light_diffuse + 3 * i, i == 0 ? 0.58f : 0.0f);
    set(m->light_specular + 3 * i, i == 0 ? 0.12f : 0.0f);
    m->light_directional[i] = 1;
  }
  m->vis.global.fovy = 8;
  m->vis.quality.numslices = 48;
  m->vis.quality.numstacks = 24;
}

void placeLight(const mjModel* m, mjData* d, const View& view) {
  const double a = view.azimuth * mjPI / 180, e = view.elevation * mjPI / 180;
  const mjtNum forward[3] = {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
  const mjtNum right[3] = {std::sin(a), -std::cos(a), 0};
  mjtNum up[3];
  mju_cross(up, right, forward);
  for (int i = 0; i < m->nlight; i++) {
    mjtNum* direction = d->light_xdir + 3 * i;
    for (int k = 0; k < 3; k++) direction[k] = 0.6 * forward[k] + 0.6 * right[k] - 0.8 * up[k];
    mju_normalize3(direction);
  }
}

std::vector<unsigned char> shrink(const std::vector<unsigned char>& fine, int width, int height) {
  std::vector<unsigned char> rgb(std::size_t{3} * width * height);
  for (std::size_t i = 0; i < rgb.size(); i++) {
    const std::size_t colour = i % 3, x = i / 3 % width, y = i / 3 / width;
    int sum = 0;
    for (int k = 0; k < kFiner * kFiner; k++) {
      const std::size_t row = kFiner * y + k / kFiner, column = kFiner * x + k % kFiner;
      sum += fine[3 * (row * kFiner * width + column) + colour];
    }
    rgb[i] = static_cast<unsigned char>(sum / (kFiner * kFiner));
  }
  return rgb;
}

}  // namespace torso::tools
