// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

namespace torso::tools {

// All that the plugin's C interface tells of the inside of one disc.
struct DiscData {
  std::string name;
  std::vector<Eigen::Vector3d> nodes;  // (nnode) world [m]
  std::vector<Eigen::Vector3d> rest;   // (nnode) disc frame [m]
  Eigen::Vector3d origin;              // of the disc frame, which goes with the lower bone [m]
  Eigen::Matrix3d axes;                // x, y, z of the disc frame in the world
  std::vector<std::array<int, 4>> tets;
  std::vector<int> cells;                      // (ntet) -1: nucleus, else a cell of the annulus
  std::vector<Eigen::Matrix3d> stress;         // (ntet) Cauchy, world [Pa]
  std::vector<Eigen::Vector2d> fibre_stretch;  // (ntet)
};

// Of all discs in the state d, for which mj_forward was called. Throws Error if the plugin refuses.
std::vector<DiscData> discData(const mjModel* m, const mjData* d);

}  // namespace torso::tools
