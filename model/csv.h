// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

namespace torso {

// A comma-separated table with a header row, read whole. Lines that start with '#' are comments.
class CsvTable {
 public:
  // Throws std::runtime_error "file:line: what is wrong" (missing file, row with too many or too
  // few cells, no header).
  explicit CsvTable(const std::string& path);

  int rows() const { return static_cast<int>(cells_.size()); }
  // Cell as text. Throws if the column does not exist.
  const std::string& text(int row, const std::string& column) const;
  // Cell as a finite number. Throws "file:line: column ... is not a number".
  double number(int row, const std::string& column) const;
  // Index in `words` of the cell. Throws "file:line: column ... is none of ..." if it is not there.
  int word(int row, const std::string& column, const std::vector<std::string>& words) const;
  bool empty(int row, const std::string& column) const { return text(row, column).empty(); }
  // First row whose `column` holds `value`; throws if there is none.
  int find(const std::string& column, const std::string& value) const;
  // "file:line" of a row, for messages about what its cells say together.
  std::string where(int row) const;

 private:
  std::string path_;
  std::unordered_map<std::string, int> columns_;
  std::vector<std::vector<std::string>> cells_;
  std::vector<int> lines_;
};

}  // namespace torso
