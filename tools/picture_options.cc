// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/picture_options.h"

#include <fmt/format.h>

#include <algorithm>

#include "tools/error.h"
#include "tools/mujoco_support.h"
#include "tools/renderer.h"

namespace torso::tools {

void PictureOptions::addTo(CLI::App& command) {
  const std::string group = "Picture";
  command.add_option("--width", width, "[pixels]")
      ->check(CLI::Range(16, 16384))
      ->capture_default_str()
      ->group(group);
  command.add_option("--height", height, "[pixels]")
      ->check(CLI::Range(16, 16384))
      ->capture_default_str()
      ->group(group);
  auto* name = command.add_option("--camera", camera, "A camera of the model")->group(group);
  command
      .add_option("--azimuth", azimuth,
                  fmt::format("Direction of view [deg], 90 from the right, 180 from the front; by "
                              "default {}",
                              kDefaultAzimuth))
      ->excludes(name)
      ->group(group);
  command
      .add_option("--elevation", elevation,
                  fmt::format("[deg], negative: from above; by default {}", kDefaultElevation))
      ->excludes(name)
      ->group(group);
  command.add_option("--distance", distance, "From the point looked at [m]; by default all fits")
      ->check(CLI::PositiveNumber)
      ->excludes(name)
      ->group(group);
  command.add_option("--lookat", lookat, "Point in the middle: x y z [m]")
      ->expected(3)
      ->excludes(name)
      ->group(group);
  command
      .add_option("--layers", layers,
                  fmt::format("Show these layers and none of the others: {}",
                              fmt::join(layerNames(), ", ")))
      ->delimiter(',')
      ->check(CLI::IsMember(layerNames()))
      ->group(group);
  command.add_option("--show", show, "Layers or groups (geom:3, tendon:1, ...) to add")
      ->delimiter(',')
      ->group(group);
  command.add_option("--hide", hide, "Layers or groups to leave out")->delimiter(',')->group(group);
}

mjvOption PictureOptions::visibility() const {
  mjvOption option;
  mjv_defaultOption(&option);
  if (!layers.empty()) {
    for (const std::string& layer : layerNames()) {
      setVisible(option, layer, std::find(layers.begin(), layers.end(), layer) != layers.end());
    }
  }
  for (const std::string& layer : show) setVisible(option, layer, true);
  for (const std::string& layer : hide) setVisible(option, layer, false);
  return option;
}

mjvCamera PictureOptions::view(const mjModel* m, const std::vector<const mjData*>& states,
                               const std::string& path) const {
  mjvCamera result;
  if (!camera.empty()) {
    mjv_defaultCamera(&result);
    result.type = mjCAMERA_FIXED;
    result.fixedcamid = mj_name2id(m, mjOBJ_CAMERA, camera.c_str());
    if (result.fixedcamid >= 0) return result;
    std::vector<std::string> names;
    for (int i = 0; i < m->ncam; i++) names.push_back(nameOf(m, mjOBJ_CAMERA, i));
    throw Error(fmt::format("{}: no camera '{}'; the model has: {}", path, camera,
                            names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
  }
  result = frameBodies(m, states, visibility(), azimuth.value_or(kDefaultAzimuth),
                       elevation.value_or(kDefaultElevation), static_cast<double>(width) / height);
  if (distance) result.distance = *distance;
  if (!lookat.empty()) std::copy(lookat.begin(), lookat.end(), result.lookat);
  return result;
}

}  // namespace torso::tools
