// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Reading of a model's custom fields, with errors that name the element at fault.

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

namespace torso::plugin {

const char* nameOf(const mjModel* m, int type, int id);  // "" if it has none

// "numeric 'disc:L4/L5'"
std::string elementName(const mjModel* m, int type, int id);

// Throws std::runtime_error "torso data, WHERE: WHAT".
[[noreturn]] void fail(const std::string& where, const std::string& what);

// The numbers of a numeric; throws unless there are `size` and all are finite.
const mjtNum* readNumeric(const mjModel* m, int id, int size);

// The elements of one tuple, front to back.
class TupleReader {
 public:
  TupleReader(const mjModel* m, int id) : m_(m), id_(id) {}
  std::string where() const { return elementName(m_, mjOBJ_TUPLE, id_); }
  bool done() const { return next_ >= m_->tuple_size[id_]; }
  // Id of the next element; throws unless it has this type. prm: its parameter, if not null.
  int take(int type, double* prm = nullptr);

 private:
  const mjModel* m_;
  int id_, next_ = 0;
};

// The words of one text: keys, each followed by numbers.
class TextReader {
 public:
  TextReader(const mjModel* m, int id);
  const std::string& where() const { return where_; }
  void expect(const char* key);   // throws unless the next word is the key
  std::vector<double> numbers();  // up to the next key or the end; throws if one is not finite
  std::vector<int> integers();    // likewise; throws if one is not an integer
  void finish();                  // throws unless this is the end

 private:
  void skip();

  std::string where_;
  const char* next_;
};

}  // namespace torso::plugin
