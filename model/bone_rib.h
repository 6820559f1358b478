// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Ribs of the left side, 0 (the first) to 11. In the standing body [m].

#include <Eigen/Core>
#include <vector>

#include "model/anatomy.h"
#include "model/tri_mesh.h"

namespace torso {

constexpr int kRibs = 12, kTrueRibs = 7, kFalseRibs = 10;

// Middle lines of the bony ribs and the frames of their sections.
class RibLines {
 public:
  explicit RibLines(const Anatomy& anatomy);

  static constexpr int kPoints = 161;  // of a line, at equal distances

  // From the head to the front end.
  const std::vector<Eigen::Vector3d>& line(int rib) const { return lines_[rib]; }
  // At a share of the length: place, unit direction forwards, and unit normal out of the thorax.
  Eigen::Vector3d point(int rib, double share) const;
  Eigen::Vector3d heading(int rib, double share) const;
  Eigen::Vector3d outward(int rib, double share) const;
  // Share of the length where the tubercle lies, beside the transverse process.
  double tubercle(int rib) const { return tubercle_[rib]; }
  // Point of the rib cage that has these coordinates in a body of the tables' size [mm].
  Eigen::Vector3d placed(double x, double y, double z) const;

 private:
  void fitPlacement(const Anatomy& anatomy);
  void makeLine(const Anatomy& anatomy, int rib);

  Eigen::Matrix<double, 2, 3> sagittal_;  // (x, z, 1) -> (x, z)
  double breadth_;                        // y -> y
  std::vector<Eigen::Vector3d> lines_[kRibs];
  double tubercle_[kRibs];
};

// Half height of a rib along the thorax's surface and half thickness across it [m].
struct RibSection {
  double height, thickness;
};
RibSection ribEndSection(int rib);  // where the cartilage begins

TriMesh ribMesh(const RibLines& lines, int rib);

}  // namespace torso
