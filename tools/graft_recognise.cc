// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Which body of a humanoid is what.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/error.h"
#include "tools/graft_host.h"

namespace torso::tools {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d vector3(const mjtNum* x) { return {x[0], x[1], x[2]}; }

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

// -1: a is on the left of b by their names ("l_leg", "r_leg"), 1: on the right, 0: they do not say.
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

struct LimbPair {
  std::array<int, 2> body;  // siblings, in the order of the file
  int leg_words;            // words for legs less words for arms among its names
  double mass;
};

class Recogniser {
 public:
  explicit Recogniser(const Host& host) : host_(host), m_(host.model.get()) {}
  HostParts run();

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(host_.path + ": " + what); }
  std::string name(int body) const { return "'" + host_.bodyName(body) + "'"; }
  std::vector<int> below(int body) const;
  bool mirror(int a, int b) const;
  std::vector<LimbPair> limbPairs(int root) const;
  int legWords(int limb) const;
  // The first body of a limb that is no part of the trunk; the ones before it are skipped.
  int limbStart(int body, bool arm, TrunkPart part, HostParts& parts) const;
  int heaviestChild(int body) const;
  void orderSides(const LimbPair& legs, const LimbPair& arms, HostParts& parts) const;
  void nameTrunk(int pelvis, int chest, HostParts& parts) const;

  const Host& host_;
  const mjModel* m_;
};

std::vector<int> Recogniser::below(int body) const {
  std::vector<int> bodies;
  for (int b = body; b < m_->nbody; b++) {
    if (host_.isBelow(b, body)) bodies.push_back(b);
  }
  return bodies;
}

bool Recogniser::mirror(int a, int b) const {
  int dof[2] = {0, 0};
  std::size_t count[2] = {0, 0};
  for (int k = 0; k < 2; k++) {
    const std::vector<int> bodies = below(k ? b : a);
    count[k] = bodies.size();
    for (int body : bodies) dof[k] += m_->body_dofnum[body];
  }
  if (std::min(count[0], count[1]) < 2 || std::min(dof[0], dof[1]) < 3) return false;
  const double x = m_->body_subtreemass[a], y = m_->body_subtreemass[b];
  return sideByName(host_.bodyName(a), host_.bodyName(b)) != 0 ||
         (count[0] == count[1] && std::abs(x - y) < 0.05 * (x + y));
}

int Recogniser::legWords(int limb) const {
  int words = 0;
  for (int b : below(limb)) {
    std::string names = host_.bodyName(b);
    for (int j = 0; j < m_->body_jntnum[b]; j++) {
      names += " " + nameOf(m_, mjOBJ_JOINT, m_->body_jntadr[b] + j);
    }
    names = lower(names);
    words += countWords(
        names, {"thigh", "hip", "femur", "leg", "knee", "shin", "tibia", "foot", "ankle", "toe"});
    words -= countWords(names, {"arm", "shoulder", "humerus", "elbow", "clav", "collar", "wrist",
                                "hand", "radius"});
  }
  return words;
}

std::vector<LimbPair> Recogniser::limbPairs(int root) const {
  std::vector<LimbPair> pairs;
  for (int parent : below(root)) {
    const bool in_limb = std::any_of(pairs.begin(), pairs.end(), [&](const LimbPair& p) {
      return host_.isBelow(parent, p.body[0]) || host_.isBelow(parent, p.body[1]);
    });
    if (in_limb) continue;
    std::vector<int> children;
    for (int b : below(parent)) {
      if (b != parent && m_->body_parentid[b] == parent) children.push_back(b);
    }
    for (std::size_t i = 0; i < children.size(); i++) {
      for (std::size_t k = i + 1; k < children.size(); k++) {
        const int a = children[i], b = children[k];
        if (!mirror(a, b)) continue;
        pairs.push_back(
            {{a, b}, legWords(a) + legWords(b), m_->body_subtreemass[a] + m_->body_subtreemass[b]});
      }
    }
  }
  return pairs;
}

int Recogniser::heaviestChild(int body) const {
  int best = -1;
  for (int b : below(body)) {
    if (b == body || m_->body_parentid[b] != body) continue;
    if (best < 0 || m_->body_subtreemass[b] > m_->body_subtreemass[best]) best = b;
  }
  return best;
}

int Recogniser::limbStart(int body, bool arm, TrunkPart part, HostParts& parts) const {
  while (m_->body_jntnum[body] == 0 || (arm && isClavicle(host_.bodyName(body)))) {
    const int next = heaviestChild(body);
    if (next < 0) fail("the limb of " + name(body) + " has no joint");
    parts.trunk[body] = part;
    body = next;
  }
  return body;
}

// Sorts both pairs left, right.
void Recogniser::orderSides(const LimbPair& legs, const LimbPair& arms, HostParts& parts) const {
  std::array<int, 2> leg = legs.body, arm = arms.body;
  const int leg_side = sideByName(host_.bodyName(leg[0]), host_.bodyName(leg[1]));
  const int arm_side = sideByName(host_.bodyName(arm[0]), host_.bodyName(arm[1]));
  const auto at = [&](int b) { return host_.jointCentre(b); };
  if (leg_side > 0) std::swap(leg[0], leg[1]);
  if (leg_side == 0 && arm_side != 0) {
    // As the arms: the leg on the side of the left arm is the left one.
    const Vector3d left = (at(arm[0]) - at(arm[1])) * (arm_side < 0 ? 1 : -1);
    if ((at(leg[0]) - at(leg[1])).dot(left) < 0) std::swap(leg[0], leg[1]);
  } else if (leg_side == 0) {
    // The feet, at the ends of the legs, point forward.
    const Vector3d up = 0.5 * (at(arm[0]) + at(arm[1]) - at(leg[0]) - at(leg[1]));
    Vector3d forward = Vector3d::Zero();
    for (int b : leg) {
      while (heaviestChild(b) >= 0) b = heaviestChild(b);
      forward += vector3(host_.data->xipos + 3 * b) - host_.pose(b).translation();
    }
    forward -= forward.dot(up) / up.squaredNorm() * up;
    if (forward.norm() < 0.01) {
      fail("cannot tell left from right: neither the names of " + name(leg[0]) + " and " +
           name(leg[1]) + " nor the feet say it");
    }
    if ((at(leg[0]) - at(leg[1])).dot(up.cross(forward)) < 0) std::swap(leg[0], leg[1]);
    parts.notes.push_back("left and right from where the feet point");
  }
  const Vector3d left = at(leg[0]) - at(leg[1]);
  if ((at(arm[0]) - at(arm[1])).dot(left) < 0) std::swap(arm[0], arm[1]);
  parts.thigh = leg;
  parts.upper_arm = arm;
}

void Recogniser::nameTrunk(int pelvis, int chest, HostParts& parts) const {
  const auto isLimb = [&](int b) {
    for (const auto& limbs : {parts.thigh, parts.upper_arm}) {
      for (int limb : limbs) {
        if (host_.isBelow(b, limb)) return true;
      }
    }
    return false;
  };
  const Vector3d mid_shoulder = 0.5 * (parts.shoulder[0] + parts.shoulder[1]);
  const Vector3d up = (mid_shoulder - 0.5 * (parts.hip[0] + parts.hip[1])).normalized();
  parts.trunk[pelvis] = TrunkPart::kPelvis;
  if (chest != pelvis) parts.trunk[chest] = TrunkPart::kChest;

  int head = -1;
  double highest = 0;
  for (int b : below(parts.root)) {
    if (isLimb(b) || parts.trunk.count(b)) continue;
    const double height = (vector3(host_.data->xipos + 3 * b) - mid_shoulder).dot(up);
    const bool named = countWords(lower(host_.bodyName(b)), {"head", "skull"}) > 0;
    if (named && (head < 0 || host_.isBelow(head, b))) {
      head = b;
      highest = INFINITY;
    } else if (height > highest) {
      head = b;
      highest = height;
    }
  }
  if (head >= 0) {
    parts.trunk[head] = TrunkPart::kHead;
    for (int b = m_->body_parentid[head]; b > 0 && !parts.trunk.count(b);
         b = m_->body_parentid[b]) {
      parts.trunk[b] = TrunkPart::kNeck;
    }
    parts.notes.push_back("head: " + name(head));
  } else {
    parts.notes.push_back("head: none; it is part of " + name(chest));
  }
  // Between pelvis and chest, whichever is the ancestor.
  for (int end : {pelvis, chest}) {
    const int other = end == pelvis ? chest : pelvis;
    if (!host_.isBelow(end, other)) continue;
    for (int b = m_->body_parentid[end]; b > 0 && b != other; b = m_->body_parentid[b]) {
      parts.trunk.emplace(b, TrunkPart::kWaist);
    }
  }
  for (int b : below(parts.root)) {
    if (isLimb(b) || parts.trunk.count(b)) continue;
    const auto parent = parts.trunk.find(m_->body_parentid[b]);
    parts.trunk[b] = parent == parts.trunk.end() ? TrunkPart::kPelvis : parent->second;
  }
}

HostParts Recogniser::run() {
  HostParts parts;
  std::vector<LimbPair> pairs;
  parts.root = -1;
  std::vector<int> others;
  for (int b = 1; b < m_->nbody; b++) {
    if (m_->body_parentid[b] != 0) continue;
    const std::vector<LimbPair> found = limbPairs(b);
    if (found.size() >= 2) others.push_back(b);
    if (parts.root < 0 || found.size() > pairs.size()) {
      parts.root = b;
      pairs = found;
    }
  }
  if (parts.root < 0) fail("no bodies; give the MJCF of a humanoid");
  if (others.size() > 1) {
    fail("several humanoids (" + name(others[0]) + ", " + name(others[1]) +
         (others.size() > 2 ? ", ..." : "") + "); give a file with one");
  }
  if (pairs.empty())
    fail("no arms and no legs: no two bodies below " + name(parts.root) +
         " mirror each other; this is no humanoid");
  std::sort(pairs.begin(), pairs.end(), [](const LimbPair& a, const LimbPair& b) {
    return std::pair(a.leg_words, a.mass) > std::pair(b.leg_words, b.mass);
  });
  const LimbPair legs = pairs.front(), arms = pairs.back();
  if (pairs.size() == 1) {
    fail(fmt::format("no {}: {} and {} are the only pair of limbs",
                     legs.leg_words < 0 ? "thighs" : "arms", name(legs.body[0]),
                     name(legs.body[1])));
  }
  if (arms.leg_words > 0 || legs.leg_words < 0) {
    fail(fmt::format("no {}: {} and {} are {} too", legs.leg_words < 0 ? "thighs" : "arms",
                     name(arms.body[0]), name(legs.body[0]), legs.leg_words < 0 ? "arms" : "legs"));
  }
  orderSides(legs, arms, parts);
  parts.notes.push_back(fmt::format("legs by {}: {}, {}", legs.leg_words ? "name" : "mass",
                                    name(parts.thigh[0]), name(parts.thigh[1])));
  parts.notes.push_back(fmt::format("arms by {}: {}, {}", arms.leg_words ? "name" : "mass",
                                    name(parts.upper_arm[0]), name(parts.upper_arm[1])));
  const int pelvis = m_->body_parentid[legs.body[0]], chest = m_->body_parentid[arms.body[0]];
  for (int k = 0; k < 2; k++) {
    parts.thigh[k] = limbStart(parts.thigh[k], false, TrunkPart::kPelvis, parts);
    parts.upper_arm[k] = limbStart(parts.upper_arm[k], true,
                                   k ? TrunkPart::kRightClavicle : TrunkPart::kLeftClavicle, parts);
    parts.hip[k] = host_.jointCentre(parts.thigh[k]);
    parts.shoulder[k] = host_.jointCentre(parts.upper_arm[k]);
  }
  parts.notes.push_back(fmt::format("thighs: {}, {}; upper arms: {}, {}", name(parts.thigh[0]),
                                    name(parts.thigh[1]), name(parts.upper_arm[0]),
                                    name(parts.upper_arm[1])));
  parts.notes.push_back("pelvis: " + name(pelvis) + "; chest: " + name(chest));
  const Vector3d hip = 0.5 * (parts.hip[0] + parts.hip[1]);
  const Vector3d up = 0.5 * (parts.shoulder[0] + parts.shoulder[1]) - hip;
  if (up.norm() < 1e-3) fail("the shoulders are where the hips are");
  Vector3d leg = Vector3d::Zero();
  for (int k = 0; k < 2; k++) {
    leg += 0.5 * vector3(host_.data->subtree_com + 3 * parts.thigh[k]);
  }
  leg -= hip;
  if (leg.dot(up) > -0.3 * leg.norm() * up.norm()) {
    fail("in its pose qpos0 the legs are not below the trunk; is it a biped?");
  }
  nameTrunk(pelvis, chest, parts);
  return parts;
}

}  // namespace

HostParts recognise(const Host& host) { return Recogniser(host).run(); }

Matrix3d trunkAxes(const std::array<Vector3d, 2>& hip, const std::array<Vector3d, 2>& shoulder) {
  const Vector3d up = (shoulder[0] + shoulder[1] - hip[0] - hip[1]).normalized();
  Vector3d left = hip[0] - hip[1] + shoulder[0] - shoulder[1];
  left = (left - left.dot(up) * up).normalized();
  Matrix3d axes;
  axes << left.cross(up), left, up;
  return axes;
}

}  // namespace torso::tools
