// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <string>
#include <vector>

#include "tools/mujoco_support.h"

namespace torso::tools {

// Leads the levels of the spine, the upper neck and the shoulder girdle along a course of turns, by
// springs that give no moment where the torso is on that course.
class JointLead {
 public:
  // torso: of BodyMjcf::torsoOnHolds, or a model of ledModel.
  explicit JointLead(const mjModel* torso);

  // A copy of the torso with the gains and inertias that apply() is made for.
  static ModelPtr ledModel(const mjModel* torso);

  // Levels and joints that are led: "L5/S1", "head", "left_sternoclavicular".
  const std::vector<std::string>& names() const { return names_; }
  // Whether it is one of two joints between which no bone is held or counted: those of the upper
  // neck, and those of a shoulder girdle.
  static bool isOneOfTwo(const std::string& name);
  // (3 x names) Turns from rest in the pose of d [rad].
  Eigen::Matrix3Xd turns(const mjModel* torso, mjData* d) const;
  // Adds to ctrl and qfrc_applied of d as Rhythm and SpineRhythm have set them. led: of ledModel.
  void apply(const mjModel* led, mjData* d, const Eigen::Matrix3Xd& goal) const;

 private:
  std::vector<std::string> names_;
  std::vector<int> servos_;  // of levels: the first of the three of each
  std::vector<int> balls_;   // joints
};

}  // namespace torso::tools
