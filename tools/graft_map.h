// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The map file of `torso graft --map`: a JSON object that says which body of a humanoid is what,
//
//   {"pelvis": "hips", "waist": ["spine1", "spine2"], "head": null, "left_thigh": "l_leg", ...}
//
// with a name, a list of names, or null for "none". What it does not mention is recognised.

#include <map>
#include <string>
#include <vector>

namespace torso::tools {

struct BodyMap {
  std::string path;                                        // for messages; "" if there is no file
  std::map<std::string, std::vector<std::string>> bodies;  // by part: names
};

// Parts that a map may mention, from the pelvis up, then limbs.
const std::vector<std::string>& bodyMapParts();

// Throws Error that names the file and the wrong entry.
BodyMap readBodyMap(const std::string& path);

// As readBodyMap reads it.
std::string writeBodyMap(const BodyMap& map);

}  // namespace torso::tools
