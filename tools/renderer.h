// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/disc_skin.h"
#include "tools/stick.h"

namespace torso::tools {

// Pictures of a model without a window or a display, through EGL. One at a time per process.
class Renderer {
 public:
  // Size in pixels; anti-aliasing as the model asks (visual/quality offsamples). Changes the size
  // of the offscreen buffer in m->vis. Throws Error if there is no EGL or the picture is too large.
  // discs: how they are coloured, with a legend; by default they are drawn as the model's skins.
  Renderer(mjModel* m, int width, int height, std::optional<DiscColours> discs = std::nullopt);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  // The state in d, for which mj_forward was called, and sticks in its world: rows from below, 3
  // bytes (RGB) a pixel.
  std::vector<unsigned char> pixels(mjData* d, const mjvOption& option, mjvCamera camera,
                                    const std::vector<Stick>& sticks = {});
  // The same as the content of a PNG file.
  std::string png(mjData* d, const mjvOption& option, mjvCamera camera,
                  const std::vector<Stick>& sticks = {});
  // What draws, in OpenGL's words: a graphics card, or "llvmpipe (...)" for software.
  std::string driver() const;

 private:
  struct Context;
  struct Stage;
  std::unique_ptr<Context> context_;
  const mjModel* m_;
  int width_, height_;
  std::optional<DiscColours> discs_;
  std::unique_ptr<Stage> stage_;
};

// Content of a PNG file of a picture as Renderer::pixels gives it. Throws Error.
std::string encodePng(const std::vector<unsigned char>& rgb, int width, int height);

// What can be shown or hidden by name:
// bones (geom group 1), outline (geom group 2), collision (geom group 3), facets (geom and site
// group 4), ligaments (tendon group 1), discs (skin group 1)
const std::vector<std::string>& layerNames();

// Show or hide a layer, or a group "geom:3", "site:4", "joint:0", "tendon:1", "actuator:0",
// "skin:1". Throws Error that lists the choices.
void setVisible(mjvOption& option, const std::string& layer_or_group, bool visible);

// A free camera with the given direction [deg] that has all visible body geoms and tendons, in each
// of the given states, and all sticks in a picture of the given aspect (width by height). Needs
// mj_fwdPosition.
mjvCamera frameBodies(const mjModel* m, const std::vector<const mjData*>& states,
                      const mjvOption& option, double azimuth, double elevation, double aspect,
                      const std::vector<Stick>& sticks = {});

// The direction of the default camera [deg]: onto the front, a little from above and its right.
constexpr double kDefaultAzimuth = 150, kDefaultElevation = -10;

}  // namespace torso::tools
