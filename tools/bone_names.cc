// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/bone_names.h"

#include <algorithm>
#include <cctype>
#include <regex>

namespace torso::tools {
namespace {

std::string lowered(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return text;
}

bool finds(const std::string& name, const char* pattern) {
  return std::regex_search(name, std::regex(pattern));
}

struct Word {
  const char* pattern;
  const char* body;
  bool paired;
};
// The first that matches counts.
const Word kWords[] = {
    {"sacr|(^|[^a-z])s1([^0-9]|$)", "pelvis", false},
    {"pelvi|hip_?bone|ilium|iliac|innominate|coxa", "pelvis", false},
    {"rib_?cage|thorax|(^|[^a-z])ribs?([^a-z]|$)|costa|chest", "ribcage", false},
    {"skull|crani|mandib|(^|[^a-z])jaw|(^|[^a-z])head", "head", false},
    {"shoulder_?blade|scapul", "scapula", true},
    {"clavic|collar_?bone", "clavicle", true},
    {"shoulder", "shoulder", true},
    {"humer|upper_?arm", "upper_arm", true},
    {"radius|ulna|fore_?arm|lower_?arm", "lower_arm", true},
    {"(^|[^a-z])hand([^a-z]|$)", "hand", true},
    {"femur|thigh", "thigh", true},
    {"tibia|fibula|shin|shank|patella", "shin", true},
    {"(^|[^a-z])foot([^a-z]|$)", "foot", true},
    {"spine|spinal|lumbar|vertebra", "spine", false},
};

}  // namespace

std::string sideOfName(const std::string& name) {
  const std::string n = lowered(name);
  if (finds(n, "left|(^|[^a-z0-9])(l|lt)([^a-z0-9]|$)")) return "left";
  if (finds(n, "right|(^|[^a-z0-9])(r|rt)([^a-z0-9]|$)")) return "right";
  return "";
}

std::vector<std::string> bodiesOfName(const std::string& name) {
  const std::string n = lowered(name);
  if (finds(n, "disc|disk|(^|[^a-z])(ivd|body|pedicle|lamina|process|endplate|arch|nucleus)")) {
    return {};
  }
  std::smatch match;
  const std::regex level(
      "(^|[^a-z])(l|lum|lumbar|t|th|thor|thoracic|dorsal|c|cerv|cervical)[ _-]?"
      "(vertebra)?[ _-]?0?([0-9]{1,2})([^0-9]|$)");
  if (std::regex_search(n, match, level)) {
    const char region = match[2].str()[0] == 'd' ? 't' : match[2].str()[0];
    const int number = std::stoi(match[4].str());
    if (region == 'l' && number >= 1 && number <= 5) return {"L" + std::to_string(number)};
    if (region == 't' && number >= 1 && number <= 12) return {"T" + std::to_string(number)};
    if (region == 'c' && number >= 3 && number <= 7) return {"C" + std::to_string(number)};
    if (region == 'c' && number >= 1 && number <= 2) return {"C2"};
  }
  if (finds(n, "atlas|(^|[^a-z])axis([^a-z]|$)")) return {"C2"};
  for (const Word& word : kWords) {
    if (!finds(n, word.pattern)) continue;
    std::string side = sideOfName(name);
    if (!word.paired) return {word.body};
    if (!side.empty()) side += "_";
    if (word.body == std::string("shoulder")) return {side + "clavicle", side + "scapula"};
    return {side + word.body};
  }
  return {};
}

}  // namespace torso::tools
