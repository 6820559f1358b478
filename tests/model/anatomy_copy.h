// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace torso {

// A copy of the anatomy's tables that a test may damage; removed with the object.
class AnatomyCopy {
 public:
  explicit AnatomyCopy(const std::string& original) {
    folder_ = testing::TempDir() + "anatomy_XXXXXX";
    if (!mkdtemp(folder_.data())) throw std::runtime_error("no temporary folder");
    for (const auto& entry : std::filesystem::directory_iterator(original)) {
      std::filesystem::copy(entry.path(), folder_);
    }
  }
  ~AnatomyCopy() { std::filesystem::remove_all(folder_); }
  AnatomyCopy(const AnatomyCopy&) = delete;
  AnatomyCopy& operator=(const AnatomyCopy&) = delete;

  const std::string& folder() const { return folder_; }
  std::string path(const std::string& table) const { return folder_ + "/" + table; }

  void remove(const std::string& table) { std::filesystem::remove(path(table)); }

  // Replaces the first occurrence, which must exist; returns its line, counted from 1.
  int replace(const std::string& table, const std::string& from, const std::string& to) {
    std::string text = read(table);
    const std::size_t at =
        text.find("\n" + from) == std::string::npos ? text.find(from) : text.find("\n" + from) + 1;
    if (at == std::string::npos) throw std::runtime_error(table + " does not hold " + from);
    text.replace(at, from.size(), to);
    std::ofstream(path(table)) << text;
    return 1 + static_cast<int>(std::count(text.begin(), text.begin() + at, '\n'));
  }

  // Removes the line that starts like this.
  void eraseLine(const std::string& table, const std::string& start) {
    std::string text = read(table);
    const std::size_t at = text.find("\n" + start);
    if (at == std::string::npos) throw std::runtime_error(table + " has no line " + start);
    text.erase(at, text.find('\n', at + 1) - at);
    std::ofstream(path(table)) << text;
  }

 private:
  std::string read(const std::string& table) const {
    std::ifstream file(path(table));
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  }
  std::string folder_;
};

}  // namespace torso
