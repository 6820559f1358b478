// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Small helpers to write MJCF with tinyxml2.

#include <fmt/format.h>
#include <tinyxml2.h>

#include <Eigen/Geometry>
#include <initializer_list>
#include <string>

namespace torso::tools {

// Shortest text that keeps 0.1 micrometre in lengths and 7 digits elsewhere; no negative zero.
inline std::string mjcfNumber(double x) {
  if (std::abs(x) < 5e-9) return "0";
  return fmt::format("{:.7g}", std::abs(x) < 1e-3 ? x : std::round(x * 1e7) * 1e-7);
}

inline std::string mjcfText(double x) { return mjcfNumber(x); }
inline std::string mjcfText(int x) { return std::to_string(x); }
inline std::string mjcfText(const std::string& x) { return x; }
inline std::string mjcfText(const char* x) { return x; }
inline std::string mjcfText(std::initializer_list<double> values) {
  std::string text;
  for (double v : values) text += (text.empty() ? "" : " ") + mjcfNumber(v);
  return text;
}
inline std::string mjcfText(const Eigen::Vector3d& v) { return mjcfText({v.x(), v.y(), v.z()}); }
inline std::string mjcfText(const Eigen::Quaterniond& q) {
  return mjcfText({q.w(), q.x(), q.y(), q.z()});
}

// An element under construction: Element(parent, "geom").set("size", 0.1).set(...)
class Element {
 public:
  Element(tinyxml2::XMLNode* parent, const char* name)
      : element_(parent->GetDocument()->NewElement(name)) {
    parent->InsertEndChild(element_);
  }
  template <typename T>
  Element& set(const char* attribute, const T& value) {
    element_->SetAttribute(attribute, mjcfText(value).c_str());
    return *this;
  }
  Element& set(const char* attribute, std::initializer_list<double> values) {
    element_->SetAttribute(attribute, mjcfText(values).c_str());
    return *this;
  }
  operator tinyxml2::XMLElement*() const { return element_; }
  tinyxml2::XMLElement* operator->() const { return element_; }

 private:
  tinyxml2::XMLElement* element_;
};

}  // namespace torso::tools
