// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/located_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

#include "tools/error.h"
#include "tools/files.h"

namespace torso::tools {
namespace {

using nlohmann::json;

// Walks over a text and tells others how far it has come.
class Reader {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  Reader(const char* at, const char** shared) : at_(at), shared_(shared) {}
  const char& operator*() const { return *at_; }
  Reader& operator++() {
    *shared_ = ++at_;
    return *this;
  }
  Reader operator++(int) {
    Reader before = *this;
    ++*this;
    return before;
  }
  bool operator==(const Reader& other) const { return at_ == other.at_; }
  bool operator!=(const Reader& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  const char** shared_;
};

std::string escaped(const std::string& key) {
  std::string text;
  for (const char c : key) {
    if (c == '~') {
      text += "~0";
    } else if (c == '/') {
      text += "~1";
    } else {
      text += c;
    }
  }
  return text;
}

}  // namespace

LocatedJson::LocatedJson(const std::string& path) : path_(path) {
  const std::string text = readFile(path);
  const char* at = text.data();
  const auto here = [&text, &at](std::size_t back) {
    const auto end = static_cast<std::size_t>(at - text.data());
    const std::string before = text.substr(0, end - std::min(end, back));
    const std::size_t line_start = before.rfind('\n') + 1;  // 0 if there is none
    return Place{static_cast<int>(std::count(before.begin(), before.end(), '\n')) + 1,
                 static_cast<int>(before.size() - line_start) + 1};
  };

  // What the parser is in: an object at a key, or an array at an index.
  struct Level {
    bool array;
    int index;
    std::string pointer;  // of the value at hand
  };
  std::vector<Level> levels;
  const auto begin = [&] {  // of any value
    if (levels.empty() || !levels.back().array) return;
    const std::string parent = levels.size() > 1 ? levels[levels.size() - 2].pointer : "";
    levels.back().pointer = fmt::format("{}/{}", parent, levels.back().index++);
    places_[levels.back().pointer] = here(1);
  };
  std::string twice;
  const auto watch = [&](int, json::parse_event_t event, json& parsed) {
    using Event = json::parse_event_t;
    if (event == Event::key) {
      const std::string key = parsed.get<std::string>();
      const std::string parent = levels.size() > 1 ? levels[levels.size() - 2].pointer : "";
      levels.back().pointer = parent + "/" + escaped(key);
      const bool fresh = places_.emplace(levels.back().pointer, here(key.size() + 2)).second;
      if (!fresh && twice.empty()) {
        const Place place = here(key.size() + 2);
        twice = fmt::format("{}:{}:{}: '{}' is there twice", path_, place.line, place.column, key);
      }
    } else if (event == Event::object_start || event == Event::array_start) {
      begin();
      levels.push_back({event == Event::array_start, 0, ""});
    } else if (event == Event::object_end || event == Event::array_end) {
      levels.pop_back();
    } else {
      begin();
    }
    return true;
  };
  try {
    value_ = json::parse(Reader(text.data(), &at), Reader(text.data() + text.size(), &at), watch);
  } catch (const json::exception& e) {
    const Place place = here(1);
    // "[json.exception...] parse error at line 1, column 2: <what>"
    const std::string what = e.what();
    const std::size_t colon = what.find(": ");
    throw Error(fmt::format("{}:{}:{}: not JSON: {}", path, place.line, place.column,
                            colon == std::string::npos ? what : what.substr(colon + 2)));
  }
  if (!twice.empty()) throw Error(twice);
  if (!value_.is_object()) throw Error(path + ": not a JSON object, {...}");
}

std::string LocatedValue::where() const {
  if (pointer_.empty()) return file_->path_;
  const LocatedJson::Place& place = file_->places_.at(pointer_);
  return fmt::format("{}:{}:{}: {}", file_->path_, place.line, place.column, pointer_.substr(1));
}

void LocatedValue::fail(const std::string& what) const { throw Error(where() + ": " + what); }

void LocatedValue::checkKeys(const std::vector<std::string>& known) const {
  for (const auto& [key, value] : members()) {
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      value.fail(fmt::format("no such key; there are: {}", fmt::join(known, ", ")));
    }
  }
}

bool LocatedValue::has(const std::string& key) const {
  return value_->is_object() && value_->contains(key);
}

LocatedValue LocatedValue::at(const std::string& key) const {
  if (!value_->is_object()) fail("not an object, {...}");
  if (!value_->contains(key)) fail(fmt::format("the key '{}' is missing", key));
  return {file_, &(*value_)[key], pointer_ + "/" + escaped(key)};
}

std::vector<LocatedValue> LocatedValue::elements() const {
  if (!value_->is_array()) fail("not a list, [...]");
  std::vector<LocatedValue> all;
  for (std::size_t i = 0; i < value_->size(); i++) {
    all.emplace_back(file_, &(*value_)[i], fmt::format("{}/{}", pointer_, i));
  }
  return all;
}

std::vector<std::pair<std::string, LocatedValue>> LocatedValue::members() const {
  if (!value_->is_object()) fail("not an object, {...}");
  std::vector<std::pair<std::string, LocatedValue>> all;
  for (const auto& [key, value] : value_->items()) {
    all.emplace_back(key, LocatedValue(file_, &value, pointer_ + "/" + escaped(key)));
  }
  return all;
}

std::string LocatedValue::text() const {
  if (!value_->is_string()) fail("not a text in quotes");
  return value_->get<std::string>();
}

bool LocatedValue::flag() const {
  if (!value_->is_boolean()) fail("neither true nor false");
  return value_->get<bool>();
}

double LocatedValue::number() const {
  if (!value_->is_number()) fail("not a number");
  const double x = value_->get<double>();
  if (!std::isfinite(x)) fail("not a finite number");
  return x;
}

double LocatedValue::number(double low, double high) const {
  const double x = number();
  if (x < low || x > high) fail(fmt::format("{} is not in [{}, {}]", x, low, high));
  return x;
}

int LocatedValue::integer(int low, int high) const {
  const double x = number(low, high);
  if (x != std::floor(x)) fail(fmt::format("{} is not a whole number", x));
  return static_cast<int>(x);
}

}  // namespace torso::tools
