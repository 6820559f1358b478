// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/part_names.h"

#include <algorithm>
#include <cctype>

namespace torso::tools {

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

int countWords(const std::string& text, std::initializer_list<const char*> words) {
  return static_cast<int>(std::count_if(words.begin(), words.end(), [&](const char* word) {
    return text.find(word) != std::string::npos;
  }));
}

int sideByName(const std::string& a, const std::string& b) {
  const std::string x = lower(a), y = lower(b);
  const std::size_t i = static_cast<std::size_t>(
      std::mismatch(x.begin(), x.end(), y.begin(), y.end()).first - x.begin());
  const std::string p = x.substr(i), q = y.substr(i);
  const auto pair = [](const std::string& left, const std::string& right) {
    return (left.rfind("left", 0) == 0 && right.rfind("right", 0) == 0 &&
            left.substr(4) == right.substr(5)) ||
           (left.rfind("l", 0) == 0 && right.rfind("r", 0) == 0 &&
            left.substr(1) == right.substr(1));
  };
  return pair(p, q) ? -1 : pair(q, p) ? 1 : 0;
}

}  // namespace torso::tools
