// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/graft_limb_pairs.h"

#include <algorithm>
#include <cmath>

namespace torso::tools {
namespace {

bool mirror(const Host& host, int a, int b) {
  const mjModel* m = host.model.get();
  int dof[2] = {0, 0};
  std::size_t count[2] = {0, 0};
  for (int k = 0; k < 2; k++) {
    const std::vector<int> bodies = below(host, k ? b : a);
    count[k] = bodies.size();
    for (int body : bodies) dof[k] += m->body_dofnum[body];
  }
  if (std::min(count[0], count[1]) < 2 || std::min(dof[0], dof[1]) < 3) return false;
  const double x = m->body_subtreemass[a], y = m->body_subtreemass[b];
  return sideByName(host.bodyName(a), host.bodyName(b)) != 0 ||
         (count[0] == count[1] && std::abs(x - y) < 0.05 * (x + y));
}

int legWords(const Host& host, int limb) {
  const mjModel* m = host.model.get();
  int words = 0;
  for (int b : below(host, limb)) {
    std::string names = host.bodyName(b);
    for (int j = 0; j < m->body_jntnum[b]; j++) {
      names += " " + nameOf(m, mjOBJ_JOINT, m->body_jntadr[b] + j);
    }
    names = lower(names);
    words += countWords(
        names, {"thigh", "hip", "femur", "leg", "knee", "shin", "tibia", "foot", "ankle", "toe"});
    words -= countWords(names, {"arm", "shoulder", "humerus", "elbow", "clav", "collar", "wrist",
                                "hand", "radius"});
  }
  return words;
}

}  // namespace

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

int countWords(const std::string& text, std::initializer_list<const char*> words) {
  return static_cast<int>(std::count_if(words.begin(), words.end(), [&](const char* word) {
    return text.find(word) != std::string::npos;
  }));
}

bool isClavicle(const std::string& name) {
  return countWords(lower(name), {"clav", "collar", "thorax", "scap"}) > 0;
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

std::vector<int> below(const Host& host, int body) {
  const mjModel* m = host.model.get();
  std::vector<int> bodies;
  for (int b = body; b < m->nbody; b++) {
    if (host.isBelow(b, body)) bodies.push_back(b);
  }
  return bodies;
}

int heaviestChild(const Host& host, int body) {
  const mjModel* m = host.model.get();
  int best = -1;
  for (int b : below(host, body)) {
    if (b == body || m->body_parentid[b] != body) continue;
    if (best < 0 || m->body_subtreemass[b] > m->body_subtreemass[best]) best = b;
  }
  return best;
}

std::vector<LimbPair> limbPairs(const Host& host, int root) {
  const mjModel* m = host.model.get();
  std::vector<LimbPair> pairs;
  for (int parent : below(host, root)) {
    const bool in_limb = std::any_of(pairs.begin(), pairs.end(), [&](const LimbPair& p) {
      return host.isBelow(parent, p.body[0]) || host.isBelow(parent, p.body[1]);
    });
    if (in_limb) continue;
    std::vector<int> children;
    for (int b : below(host, parent)) {
      if (b != parent && m->body_parentid[b] == parent) children.push_back(b);
    }
    for (std::size_t i = 0; i < children.size(); i++) {
      for (std::size_t k = i + 1; k < children.size(); k++) {
        const int a = children[i], b = children[k];
        if (!mirror(host, a, b)) continue;
        pairs.push_back({{a, b},
                         legWords(host, a) + legWords(host, b),
                         m->body_subtreemass[a] + m->body_subtreemass[b]});
      }
    }
  }
  return pairs;
}

}  // namespace torso::tools
