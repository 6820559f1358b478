// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Parts of the head body without the vertebrae. Axes of the standing body; unit and origin of this
// header: millimetres from the mid-point between the ear holes (porion), so that the Frankfurt
// plane is z = 0.

#include <vector>

#include "model/tri_mesh.h"

namespace torso {

// Height of the vault above the Frankfurt plane that the skull is made for [mm].
constexpr double kVaultHeight = 127;

// Dental arch, seen from above an ellipse whose foremost point is (front, 0); the crowns' edges lie
// on a plane that rises to the rear [mm].
struct DentalArch {
  double front, width, length;   // half axes across and along
  double edge_front, edge_rise;  // height of the edge at the foremost point; rise per mm behind it
  bool upper;
  std::vector<double> crowns;  // widths of the left crowns from the mid-line

  // Point at an angle from the foremost point, `root` from the edge towards the root, `inset`
  // inside the arch.
  Eigen::Vector3d point(double angle, double root, double inset) const;
  // Unit direction out of the arch.
  Eigen::Vector3d outwards(double angle) const;
  double speed(double angle) const;      // |d point / d angle|
  double curvature(double angle) const;  // [1/mm]
  double lastAngle() const;              // where the row ends
};
const DentalArch& upperArch();
const DentalArch& lowerArch();

// Cranium and face. `condyle`: middle of the left occipital condyle's face for C1.
TriMesh skullMesh(const Eigen::Vector3d& condyle);
TriMesh mandibleMesh();
// Crowns, which stand a little off the jaw and off each other.
TriMesh teethMesh(const DentalArch& arch, const TriMesh& jaw);

}  // namespace torso
