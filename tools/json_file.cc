// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/json_file.h"

#include <fmt/format.h>

#include <fstream>

#include "tools/error.h"

namespace torso::tools {

nlohmann::json readJsonFile(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw Error(path + ": cannot be opened");
  try {
    return nlohmann::json::parse(file);
  } catch (const nlohmann::json::exception& e) {
    throw Error(fmt::format("{}: not JSON: {}", path, e.what()));
  }
}

}  // namespace torso::tools
