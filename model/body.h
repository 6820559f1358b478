// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The rigid bodies made from the anatomy: names, frames, masses.
// Bodies: "pelvis", "L5" .. "C3", "ribcage", "head", and with "left_" or "right_" before them
// "clavicle", "scapula", "upper_arm", "lower_arm", "hand", "thigh", "shin", "foot".

#include <Eigen/Geometry>
#include <string>

#include "model/anatomy.h"

namespace torso {

struct Inertial {
  double mass = 0;                                // [kg]
  Eigen::Vector3d com = Eigen::Vector3d::Zero();  // standing body [m]
  Eigen::Matrix3d inertia =
      Eigen::Matrix3d::Zero();  // about com, axes of the standing body [kg m^2]
};

// Side and name without it: "left_hand" -> (kLeft, "hand"); middle if there is no such prefix.
std::pair<Side, std::string> splitSide(const std::string& body);

// "clavicle" on the left -> "left_clavicle"; bodies of the mid-line keep their name.
std::string pairedName(const Anatomy& anatomy, Side side, const std::string& name);

// Body that carries a level: "S1" -> "pelvis", "C2" -> "head", else the level itself.
std::string bodyOfLevel(const Anatomy& anatomy, const std::string& level);

// Frame of a body at rest, in the standing body. Vertebrae: the vertebra frame. All others have the
// standing axes; their origins: pelvis S1 endplate centre, rib cage suprasternal notch, others the
// joint that hangs them on their parent. Throws std::runtime_error for an unknown name.
Eigen::Isometry3d bodyFrame(const Anatomy& anatomy, const std::string& body);

Inertial bodyInertial(const Anatomy& anatomy, const std::string& body);

}  // namespace torso
