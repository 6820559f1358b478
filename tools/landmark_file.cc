// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/landmark_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "model/csv.h"
#include "tools/error.h"
#include "tools/json_file.h"

namespace torso::tools {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::json;

void checkName(const std::string& where, const std::string& name) {
  const auto& names = landmarkNames();
  if (std::find(names.begin(), names.end(), name) != names.end()) return;
  throw Error(fmt::format("{}: no landmark is called '{}'; there are {}", where, name,
                          fmt::join(names, ", ")));
}

std::map<std::string, GivenLandmarks> readCsv(const std::string& path) {
  const CsvTable table(path);
  std::map<std::string, GivenLandmarks> out;
  for (int i = 0; i < table.rows(); i++) {
    const auto number = [&](const char* column) {
      return table.empty(i, column) ? 0.0 : table.number(i, column);
    };
    const std::string name = table.text(i, "landmark");
    checkName(table.where(i), name);
    Landmark l;
    l.centre = {table.number(i, "x"), table.number(i, "y"), table.number(i, "z")};
    l.normal = {number("normal_x"), number("normal_y"), number("normal_z")};
    l.width = number("width");
    l.height = number("height");
    out[table.text(i, "level")][name] = l;
  }
  return out;
}

Vector3d vectorOf(const Json& json) {
  if (!json.is_array() || json.size() != 3) throw Error("must be three numbers");
  return {json[0].get<double>(), json[1].get<double>(), json[2].get<double>()};
}

std::map<std::string, GivenLandmarks> readJson(const std::string& path) {
  const Json root = readJsonFile(path);
  std::map<std::string, GivenLandmarks> out;
  if (!root.is_object()) throw Error(path + ": must be an object of levels");
  for (const auto& [level, landmarks] : root.items()) {
    if (!landmarks.is_object()) {
      throw Error(fmt::format("{}: {}: must be an object of landmarks", path, level));
    }
    for (const auto& [name, value] : landmarks.items()) {
      const std::string where = fmt::format("{}: {}: {}", path, level, name);
      checkName(path + ": " + level, name);
      Landmark l;
      try {
        if (value.is_object()) {
          l.centre = vectorOf(value.at("centre"));
          if (value.contains("normal")) l.normal = vectorOf(value.at("normal"));
          l.width = value.value("width", 0.0);
          l.height = value.value("height", 0.0);
        } else {
          l.centre = vectorOf(value);
        }
      } catch (const std::exception& e) {
        throw Error(fmt::format("{}: {}", where, e.what()));
      }
      out[level][name] = l;
    }
  }
  return out;
}

}  // namespace

std::map<std::string, GivenLandmarks> readLandmarkFile(const std::string& path) {
  const bool csv = path.size() > 4 && path.substr(path.size() - 4) == ".csv";
  auto out = csv ? readCsv(path) : readJson(path);
  for (const auto& [level, landmarks] : out) {
    for (const auto& [name, l] : landmarks) {
      if (l.centre.allFinite() && l.normal.allFinite() && l.width >= 0 && l.height >= 0) continue;
      throw Error(fmt::format("{}: {}: {}: its numbers must be finite, its sizes not negative",
                              path, level, name));
    }
  }
  return out;
}

}  // namespace torso::tools
