// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Which joint of a clip is what part of a person.

#include <array>
#include <string>
#include <vector>

#include "tools/clip.h"
#include "tools/part_map.h"

namespace torso::tools {

// Index of a joint, or of the end of a bone; -1: the clip has no such part.
struct Roles {
  int hips = -1;           // carries the pelvis
  std::vector<int> trunk;  // from above the hips to the one that carries the arms
  std::vector<int> neck;   // from below the head down to the trunk, in that order up
  int head = -1;
  std::array<std::vector<int>, 2> clavicle;  // left, right, as all pairs; from the trunk outwards
  std::array<int, 2> upper_arm{-1, -1}, lower_arm{-1, -1}, hand{-1, -1};
  std::array<int, 2> thigh{-1, -1}, shin{-1, -1}, foot{-1, -1}, toe{-1, -1};
  std::vector<RecognisedPart> recognised;  // one each of roleMapParts()

  bool hasArms() const { return upper_arm[0] >= 0; }
  bool hasLegs() const { return thigh[0] >= 0; }
  int chest() const { return trunk.empty() ? hips : trunk.back(); }
};

// Parts that a map of `torso retrofit --map` may mention: "hips", "trunk" (a list), "neck" (a
// list), "head", "left_clavicle" (a list), "left_upper_arm", "left_lower_arm", "left_hand",
// "left_thigh", "left_shin", "left_foot", "left_toe", "right_...". Values are names of joints.
const MapParts& roleMapParts();

// The persons in a clip, at least one. What the map gives is so; the rest is found: limbs are pairs
// of branches that mirror each other, by name or by length; names, or else their place in the tree,
// say which are legs; a limb's joints are those whose names and bone lengths fit best; names, or
// else the toes, say which side is left. With a map: the one person it is about.
// Throws Error that names the file and what is missing or wrong: no limbs, an animal, a map that
// names a joint that is not there.
std::vector<Roles> findRoles(const Clip& clip, const PartMap& map);

// The map that says the same as roles; as readPartMap reads it.
PartMap mapOf(const Clip& clip, const Roles& roles);

}  // namespace torso::tools
