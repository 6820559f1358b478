// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/graft_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tools/error.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

// Parts of several bodies: what is between two others.
bool isList(const std::string& part) {
  return part == "waist" || part == "neck" || part == "left_clavicle" || part == "right_clavicle";
}

}  // namespace

const std::vector<std::string>& bodyMapParts() {
  static const std::vector<std::string> parts = {
      "pelvis",      "waist",          "chest",          "neck",
      "head",        "left_clavicle",  "right_clavicle", "left_thigh",
      "right_thigh", "left_upper_arm", "right_upper_arm"};
  return parts;
}

BodyMap readBodyMap(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream content;
  content << file.rdbuf();
  if (!file) throw Error(path + ": cannot read this map");
  Json json;
  try {
    json = Json::parse(content.str());
  } catch (const Json::parse_error& e) {
    throw Error(fmt::format("{}: not JSON: byte {} is wrong", path, e.byte));
  }
  if (!json.is_object()) {
    throw Error(path + R"(: not a map; write {"pelvis": "name of a body", ...})");
  }
  BodyMap map;
  map.path = path;
  for (const auto& [part, value] : json.items()) {
    const auto& known = bodyMapParts();
    if (std::find(known.begin(), known.end(), part) == known.end()) {
      throw Error(fmt::format("{}: no part is called '{}'; known are {}", path, part,
                              fmt::join(known, ", ")));
    }
    std::vector<std::string>& names = map.bodies[part];
    if (value.is_string()) {
      names.push_back(value);
    } else if (value.is_array() && isList(part)) {
      for (const Json& name : value) {
        if (!name.is_string())
          throw Error(fmt::format("{}: '{}': not a list of names", path, part));
        names.push_back(name);
      }
    } else if (!value.is_null() || !(part == "head" || isList(part))) {
      throw Error(fmt::format("{}: '{}': give the name of {}", path, part,
                              isList(part) ? "a body, a list of names, or null" : "one body"));
    }
  }
  return map;
}

std::string writeBodyMap(const BodyMap& map) {
  Json json = Json::object();
  for (const std::string& part : bodyMapParts()) {
    const auto found = map.bodies.find(part);
    if (found == map.bodies.end()) continue;
    const std::vector<std::string>& names = found->second;
    if (isList(part)) {
      json[part] = names;
    } else {
      json[part] = names.empty() ? Json() : Json(names.front());
    }
  }
  return json.dump(2) + "\n";
}

}  // namespace torso::tools
