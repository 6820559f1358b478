// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/part_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tools/error.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

PartMap readPartMap(const std::string& path, const MapParts& parts) {
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
    throw Error(fmt::format(R"({}: not a map; write {{"{}": "name of a body", ...}})", path,
                            parts.names.front()));
  }
  PartMap map;
  map.path = path;
  for (const auto& [part, value] : json.items()) {
    if (!has(parts.names, part)) {
      throw Error(fmt::format("{}: no part is called '{}'; known are {}", path, part,
                              fmt::join(parts.names, ", ")));
    }
    const bool list = has(parts.lists, part);
    std::vector<std::string>& names = map.bodies[part];
    if (value.is_string()) {
      names.push_back(value);
    } else if (value.is_array() && list) {
      for (const Json& name : value) {
        if (!name.is_string())
          throw Error(fmt::format("{}: '{}': not a list of names", path, part));
        names.push_back(name);
      }
    } else if (!value.is_null() || !(list || has(parts.optional, part))) {
      throw Error(fmt::format("{}: '{}': give the name of {}", path, part,
                              list ? "a body, a list of names, or null" : "one body"));
    }
  }
  return map;
}

std::string writePartMap(const PartMap& map, const MapParts& parts) {
  Json json = Json::object();
  for (const std::string& part : parts.names) {
    const auto found = map.bodies.find(part);
    if (found == map.bodies.end()) continue;
    const std::vector<std::string>& names = found->second;
    if (has(parts.lists, part)) {
      json[part] = names;
    } else {
      json[part] = names.empty() ? Json() : Json(names.front());
    }
  }
  return json.dump(2) + "\n";
}

}  // namespace torso::tools
