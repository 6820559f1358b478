// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "plugin/model_reader.h"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

namespace torso::plugin {

const char* nameOf(const mjModel* m, int type, int id) {
  const char* name = mj_id2name(m, type, id);
  return name ? name : "";
}

std::string elementName(const mjModel* m, int type, int id) {
  return std::string(mju_type2Str(type)) + " '" + nameOf(m, type, id) + "'";
}

void fail(const std::string& where, const std::string& what) {
  throw std::runtime_error("torso data, " + where + ": " + what);
}

const mjtNum* readNumeric(const mjModel* m, int id, int size) {
  const std::string where = elementName(m, mjOBJ_NUMERIC, id);
  if (m->numeric_size[id] != size) {
    fail(where, "it holds " + std::to_string(m->numeric_size[id]) + " numbers, it must hold " +
                    std::to_string(size));
  }
  const mjtNum* data = m->numeric_data + m->numeric_adr[id];
  for (int i = 0; i < size; i++) {
    if (!std::isfinite(data[i])) fail(where, "number " + std::to_string(i) + " is not finite");
  }
  return data;
}

int TupleReader::take(int type, double* prm) {
  if (done()) {
    fail(where(), std::string("it ends where a ") + mju_type2Str(type) +
                      " must follow; run `torso build` or `torso graft` again");
  }
  const int adr = m_->tuple_adr[id_] + next_++;
  if (m_->tuple_objtype[adr] != type) {
    fail(where(), "element " + std::to_string(next_) + " is a " +
                      mju_type2Str(m_->tuple_objtype[adr]) + ", it must be a " +
                      mju_type2Str(type));
  }
  if (prm) *prm = m_->tuple_objprm[adr];
  return m_->tuple_objid[adr];
}

TextReader::TextReader(const mjModel* m, int id)
    : where_(elementName(m, mjOBJ_TEXT, id)), next_(m->text_data + m->text_adr[id]) {}

void TextReader::skip() {
  while (*next_ == ' ' || *next_ == '\n' || *next_ == '\t' || *next_ == '\r') next_++;
}

void TextReader::expect(const char* key) {
  skip();
  const std::size_t n = std::strlen(key);
  if (std::strncmp(next_, key, n) != 0 || (next_[n] != ' ' && next_[n] != '\0')) {
    fail(where_, std::string("'") + key + "' is missing");
  }
  next_ += n;
}

std::vector<double> TextReader::numbers() {
  std::vector<double> values;
  for (;;) {
    skip();
    char* end = nullptr;
    const double value = std::strtod(next_, &end);
    if (end == next_) return values;
    if (!std::isfinite(value)) {
      fail(where_, "number " + std::to_string(values.size()) + " is not finite");
    }
    next_ = end;
    values.push_back(value);
  }
}

std::vector<int> TextReader::integers() {
  std::vector<int> values;
  for (double v : numbers()) {
    if (v != std::floor(v) || std::abs(v) > 1e9) fail(where_, "a node index is not an integer");
    values.push_back(static_cast<int>(v));
  }
  return values;
}

void TextReader::finish() {
  skip();
  if (*next_) fail(where_, "unexpected '" + std::string(next_).substr(0, 20) + "'");
}

}  // namespace torso::plugin
