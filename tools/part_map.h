// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Map files, by which a user says which body or joint of a file is what part of a person: a JSON
// object such as
//
//   {"pelvis": "hips", "waist": ["spine1", "spine2"], "head": null, "left_thigh": "l_leg", ...}
//
// with a name, a list of names, or null for "none". What it does not mention is recognised.

#include <map>
#include <string>
#include <vector>

namespace torso::tools {

// The parts that a kind of map knows.
struct MapParts {
  std::vector<std::string> names;     // in the order in which they are written
  std::vector<std::string> lists;     // those of several bodies
  std::vector<std::string> optional;  // those that may be null, lists apart
};

struct PartMap {
  std::string path;                                        // for messages; "" if there is no file
  std::map<std::string, std::vector<std::string>> bodies;  // by part: names
};

// Throws Error that names the file and the wrong entry.
PartMap readPartMap(const std::string& path, const MapParts& parts);

// As readPartMap reads it.
std::string writePartMap(const PartMap& map, const MapParts& parts);

// What was recognised as a part, and how sure that is.
struct RecognisedPart {
  std::string part;                 // one of MapParts::names
  std::vector<std::string> bodies;  // names; none: there is no such part
  std::string sureness;             // "given" (by the map), "sure", "likely" or "unsure"
  std::string reason;
};

}  // namespace torso::tools
