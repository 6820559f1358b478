// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace torso::tools {

// Content of a JSON file. Throws Error that names it if it cannot be read or is not JSON.
nlohmann::json readJsonFile(const std::string& path);

}  // namespace torso::tools
