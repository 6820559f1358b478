// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/csv.h"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace torso {
namespace {

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      cells.emplace_back();
    } else if (c != '\r') {
      cells.back() += c;
    }
  }
  return cells;
}

}  // namespace

CsvTable::CsvTable(const std::string& path) : path_(path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": cannot read this anatomy table");
  std::string line;
  int number = 0;
  while (std::getline(file, line)) {
    number++;
    if (line.empty() || line[0] == '#') continue;
    std::vector<std::string> row = split(line);
    if (columns_.empty()) {
      for (std::size_t i = 0; i < row.size(); i++) columns_[row[i]] = static_cast<int>(i);
      continue;
    }
    if (row.size() != columns_.size()) {
      throw std::runtime_error(path + ":" + std::to_string(number) + ": " +
                               std::to_string(row.size()) + " cells, the header has " +
                               std::to_string(columns_.size()));
    }
    cells_.push_back(std::move(row));
    lines_.push_back(number);
  }
  if (columns_.empty()) throw std::runtime_error(path + ": the table has no header row");
}

std::string CsvTable::where(int row) const { return path_ + ":" + std::to_string(lines_.at(row)); }

const std::string& CsvTable::text(int row, const std::string& column) const {
  const auto it = columns_.find(column);
  if (it == columns_.end()) {
    throw std::runtime_error(path_ + ": the table has no column '" + column + "'");
  }
  return cells_.at(row)[it->second];
}

double CsvTable::number(int row, const std::string& column) const {
  const std::string& cell = text(row, column);
  char* end = nullptr;
  const double value = std::strtod(cell.c_str(), &end);
  if (cell.empty() || *end != '\0' || !std::isfinite(value)) {
    throw std::runtime_error(where(row) + ": column '" + column + "' holds '" + cell +
                             "', which is not a number");
  }
  return value;
}

int CsvTable::word(int row, const std::string& column,
                   const std::vector<std::string>& words) const {
  const std::string& cell = text(row, column);
  std::string list;
  for (std::size_t i = 0; i < words.size(); i++) {
    if (cell == words[i]) return static_cast<int>(i);
    list += (i ? ", " : "") + words[i];
  }
  throw std::runtime_error(where(row) + ": column '" + column + "' holds '" + cell +
                           "', which is none of " + list);
}

int CsvTable::find(const std::string& column, const std::string& value) const {
  for (int row = 0; row < rows(); row++) {
    if (text(row, column) == value) return row;
  }
  throw std::runtime_error(path_ + ": no row has '" + value + "' in column '" + column + "'");
}

}  // namespace torso
