// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// How figures of `torso validate` are written.

#include <string>
#include <vector>

#include "tools/validation.h"

namespace torso::tools {

// Three digits, more than any of these figures is good for; counts are whole.
std::string number(double x, const std::string& unit = "");
// "-" for null.
std::string number(const Json& x, const std::string& unit = "");
// " (low - high)", "" if both are null.
std::string range(const Json& low, const Json& high);
// A key's words: "_" is a space.
std::string text(std::string key);
// "106 of 115": those inside of the rows that are compared; a headline.
Row count(const std::string& what, const std::vector<Row>& rows, const std::string& published);
Row headline(Row row);

}  // namespace torso::tools
