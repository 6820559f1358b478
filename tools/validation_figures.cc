// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/validation_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace torso::tools {

std::string number(double x, const std::string& unit) {
  const bool whole = std::abs(x) >= 1000 || x == std::round(x);
  const std::string digits =
      whole && std::abs(x) < 1e7 ? fmt::format("{:.0f}", x) : fmt::format("{:.3g}", x);
  return unit.empty() ? digits : digits + " " + unit;
}

std::string number(const Json& x, const std::string& unit) {
  return x.is_null() ? "-" : number(x.get<double>(), unit);
}

std::string range(const Json& low, const Json& high) {
  return low.is_null() && high.is_null() ? ""
                                         : fmt::format(" ({} - {})", number(low), number(high));
}

std::string text(std::string key) {
  std::replace(key.begin(), key.end(), '_', ' ');
  return key;
}

Row count(const std::string& what, const std::vector<Row>& rows, const std::string& published) {
  const auto compared = std::count_if(rows.begin(), rows.end(),
                                      [](const Row& row) { return row.inside.has_value(); });
  const auto inside = std::count_if(rows.begin(), rows.end(),
                                    [](const Row& row) { return row.inside.value_or(false); });
  Row sum{what, fmt::format("{} of {}", inside, compared), published, inside == compared};
  sum.headline = true;
  return sum;
}

Row headline(Row row) {
  row.headline = true;
  return row;
}

}  // namespace torso::tools
