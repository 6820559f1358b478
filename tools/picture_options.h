// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mujoco/mujoco.h>

#include <CLI/CLI.hpp>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "tools/disc_skin.h"
#include "tools/stick.h"

namespace torso::tools {

// The options that say what a picture shows and from where, the same in each command that makes
// pictures.
struct PictureOptions {
  int width = 1280, height = 960;  // [pixels]
  std::string camera;
  std::optional<double> azimuth, elevation, distance;  // [deg], [deg], [m]
  std::vector<double> lookat;                          // empty or x, y, z [m]
  std::vector<std::string> layers, show, hide;
  std::string discs;                 // "", "pressure" or "mises"
  std::optional<std::string> range;  // of the colours of discs, LOW:HIGH [MPa]
  bool cut_discs = false;

  void addTo(CLI::App& command);

  // What is drawn. Throws Error for an unknown layer.
  mjvOption visibility() const;
  // The camera; by default it frames the bodies as they are in all the states (at least one), and
  // all sticks.
  // Throws Error "<path>: ..." that lists the model's cameras if the named one does not exist.
  mjvCamera view(const mjModel* m, const std::vector<const mjData*>& states,
                 const std::string& path, const std::vector<Stick>& sticks = {}) const;
  // How the discs are coloured, if they are; by default with a range from what they show in all the
  // states. Throws Error "<path>: ..." if the model has none.
  std::optional<DiscColours> discColours(const mjModel* m, const std::vector<const mjData*>& states,
                                         const std::string& path) const;
};

}  // namespace torso::tools
