// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Pairs of limbs in a tree of bodies, and what their names say.

#include <array>
#include <string>
#include <vector>

#include "tools/graft_host.h"
#include "tools/part_names.h"

namespace torso::tools {

// Two children of one body that mirror each other by name, or by number of bodies and mass.
struct LimbPair {
  std::array<int, 2> body;  // siblings, in the order of the file
  int leg_words;            // words for legs less words for arms among its names
  double mass;
};

// The pairs below a body, none inside the limb of another.
std::vector<LimbPair> limbPairs(const Host& host, int root);

// A body and all below it, by id.
std::vector<int> below(const Host& host, int body);

// The child with the heaviest subtree, -1 if there is none.
int heaviestChild(const Host& host, int body);

// The first body of a limb that is no part of the trunk: it has a joint and is no clavicle. Throws
// Error if there is none.
int limbStart(const Host& host, int body, bool arm);

// Sorts both pairs left, right into thigh and upper_arm of `parts`. True if names say which side is
// left, false if the feet do; throws Error if neither does.
bool orderSides(const Host& host, const LimbPair& legs, const LimbPair& arms, HostParts& parts);

bool isClavicle(const std::string& name);

}  // namespace torso::tools
