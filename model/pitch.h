// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Frames of the mid-plane. A pitch is a rotation about y [rad], positive leaning forward.

#include <Eigen/Geometry>
#include <cmath>

namespace torso {

inline Eigen::Matrix3d pitchMatrix(double pitch) {
  return Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()).toRotationMatrix();
}

inline Eigen::Isometry3d pitched(const Eigen::Vector3d& position, double pitch) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translate(position);
  X.rotate(pitchMatrix(pitch));
  return X;
}

// Pitch of a frame, seen from the side.
inline double pitchOf(const Eigen::Matrix3d& R) { return std::atan2(R(0, 2), R(2, 2)); }

// Unit vector along the z-axis of a pitched frame.
inline Eigen::Vector3d upAt(double pitch) { return {std::sin(pitch), 0, std::cos(pitch)}; }

}  // namespace torso
