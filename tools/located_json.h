// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// JSON that people write: whatever is wrong with it is told by file, line, column and key.

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace torso::tools {

class LocatedJson;

// A value in a LocatedJson, which outlives it. All functions throw Error
// "<file>:<line>:<column>: <key>: what is wrong".
class LocatedValue {
 public:
  LocatedValue(const LocatedJson* file, const nlohmann::json* value, std::string pointer)
      : file_(file), value_(value), pointer_(std::move(pointer)) {}

  [[noreturn]] void fail(const std::string& what) const;
  // "<file>:<line>:<column>: <key>", for messages about it later.
  std::string where() const;

  // Refuses keys that are not among these.
  void checkKeys(const std::vector<std::string>& known) const;
  bool has(const std::string& key) const;
  // A member that there must be.
  LocatedValue at(const std::string& key) const;
  std::vector<LocatedValue> elements() const;                         // of an array
  std::vector<std::pair<std::string, LocatedValue>> members() const;  // of an object

  bool isText() const { return value_->is_string(); }
  std::string text() const;
  bool flag() const;
  double number() const;
  double number(double low, double high) const;  // in [low, high]
  int integer(int low, int high) const;

 private:
  const LocatedJson* file_;
  const nlohmann::json* value_;
  std::string pointer_;  // as of RFC 6901, "" for the whole
};

class LocatedJson {
 public:
  // Throws Error "<path>:<line>:<column>: ..." if it cannot be read, is not JSON or gives a key
  // twice.
  explicit LocatedJson(const std::string& path);
  LocatedValue root() const { return {this, &value_, ""}; }

 private:
  friend class LocatedValue;
  struct Place {
    int line, column;
  };
  std::string path_;
  nlohmann::json value_;
  std::map<std::string, Place> places_;  // by pointer
};

}  // namespace torso::tools
