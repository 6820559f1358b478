// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// How the JSON of torso's commands becomes rows of the validation page. Each throws
// nlohmann::json::exception if the JSON is not as the command writes it.

#include <vector>

#include "tools/validation.h"

namespace torso::tools {

std::vector<Row> infoRows(const Json& j);
std::vector<Row> kindRows(const Json& j);  // of `torso info` on another kind of torso
std::vector<Row> graftRows(const Json& j);
std::vector<Row> boneRows(const Json& j);
std::vector<Row> discRows(const Json& j);
std::vector<Row> romRows(const Json& j);
std::vector<Row> wholeSpineRows(const Json& j);
std::vector<Row> preloadRows(const Json& j);
std::vector<Row> ablateRows(const Json& j);
std::vector<Row> shoulderRows(const Json& j);
std::vector<Row> pressureRows(const Json& j);
std::vector<Row> armRows(const Json& j);
std::vector<Row> identifyRows(const Json& j);
std::vector<Row> timestepRows(const Json& j);
std::vector<Row> benchRows(const Json& j);
std::vector<Row> runRows(const Json& j);
std::vector<Row> fallRows(const Json& j);
std::vector<Row> truthRows(const Json& j);
std::vector<Row> retrofitRows(const Json& csv);  // summary.csv
std::vector<Row> optimizeRows(const Json& j);
// The lines of Google Benchmark, by the benchmark's name.
std::vector<Row> benchmarkRows(const Json& text);
// The lines of tests that print figures, by the test's name.
std::vector<Row> testRows(const Json& text);
// Any numbers and texts, each by its path: "whole, forward bend, moment nm".
std::vector<Row> plainRows(const Json& j);

}  // namespace torso::tools
