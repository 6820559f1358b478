// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/picture_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tools/error.h"
#include "tools/mujoco_support.h"
#include "tools/renderer.h"

namespace torso::tools {

namespace {

// LOW:HIGH; returns "" or what is wrong with it.
std::string readRange(const std::string& text, std::array<double, 2>* range) {
  double low, high;
  int end = 0;
  if (std::sscanf(text.c_str(), "%lf:%lf%n", &low, &high, &end) != 2 ||
      end != static_cast<int>(text.size()) || !std::isfinite(low) || !std::isfinite(high)) {
    return fmt::format("'{}' is not LOW:HIGH, two numbers", text);
  }
  if (!(low < high)) return fmt::format("in '{}' LOW must be less than HIGH", text);
  if (range) *range = {low, high};
  return "";
}

}  // namespace

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
  auto* colours =
      command
          .add_option("--discs", discs,
                      "Draw the discs as deformed, coloured by pressure or von Mises stress")
          ->check(CLI::IsMember({"pressure", "mises"}))
          ->group(group);
  command
      .add_option("--discs-range", range,
                  "LOW:HIGH, values of the first and last colour [MPa]; by default all but the "
                  "outermost 2 % have colours of their own")
      ->check([](const std::string& text) { return readRange(text, nullptr); })
      ->type_name("LOW:HIGH")
      ->needs(colours)
      ->group(group);
  command.add_flag("--discs-cut", cut_discs, "Draw only their right half, to show the section")
      ->needs(colours)
      ->group(group);
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
                               const std::string& path, const std::vector<Stick>& sticks) const {
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
                       elevation.value_or(kDefaultElevation), static_cast<double>(width) / height,
                       sticks);
  if (distance) result.distance = *distance;
  if (!lookat.empty()) std::copy(lookat.begin(), lookat.end(), result.lookat);
  return result;
}

std::optional<DiscColours> PictureOptions::discColours(const mjModel* m,
                                                       const std::vector<const mjData*>& states,
                                                       const std::string& path) const {
  if (discs.empty()) return std::nullopt;
  if (torsoOf(m, path).ndisc == 0) throw Error(path + ": the model has no discs to colour");
  DiscColours colours;
  colours.quantity = discs == "mises" ? DiscQuantity::kMises : DiscQuantity::kPressure;
  colours.cut = cut_discs;
  if (range) {
    readRange(*range, &colours.range);
    for (double& value : colours.range) value *= 1e6;
  } else {
    colours.range = discRange(m, states, colours.quantity, colours.cut);
  }
  return colours;
}

}  // namespace torso::tools
