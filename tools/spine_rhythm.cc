// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/spine_rhythm.h"

#include <map>
#include <string>
#include <utility>

#include "tools/mujoco_support.h"

namespace torso::tools {

SpineRhythm::SpineRhythm(const mjModel* torso) {
  std::map<std::string, std::vector<Servo>> groups;  // "L_flexion"
  for (int i = 0; i < torso->nu; i++) {
    const std::string name = nameOf(torso, mjOBJ_ACTUATOR, i);
    const mjtNum* range = torso->actuator_ctrlrange + 2 * i;
    groups[name.substr(0, 1) + name.substr(name.find('_'))].push_back({i, range[1], -range[0]});
  }
  for (auto& [name, group] : groups) {
    double up = 0, down = 0;
    for (const Servo& servo : group) up += servo.up, down += servo.down;
    for (Servo& servo : group) servo.up /= up, servo.down /= down;
    groups_.push_back(std::move(group));
  }
}

void SpineRhythm::apply(mjData* d) const {
  for (const std::vector<Servo>& group : groups_) {
    double whole = 0;
    for (const Servo& servo : group) whole += d->actuator_length[servo.id];
    for (const Servo& servo : group) {
      d->ctrl[servo.id] = whole * (whole > 0 ? servo.up : servo.down);
    }
  }
}

}  // namespace torso::tools
