// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Which body of a humanoid is what.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/error.h"
#include "tools/graft_host.h"
#include "tools/graft_limb_pairs.h"
#include "tools/mujoco_eigen.h"

namespace torso::tools {
namespace {

using Eigen::Vector3d;

// Parts of the trunk as the map calls them.
const std::pair<const char*, TrunkPart> kTrunkParts[] = {
    {"pelvis", TrunkPart::kPelvis},
    {"waist", TrunkPart::kWaist},
    {"chest", TrunkPart::kChest},
    {"neck", TrunkPart::kNeck},
    {"head", TrunkPart::kHead},
    {"left_clavicle", TrunkPart::kLeftClavicle},
    {"right_clavicle", TrunkPart::kRightClavicle}};

// Where a body goes that the map does not count among a part: to the part below it.
TrunkPart nearestEnd(TrunkPart part) {
  return part == TrunkPart::kPelvis || part == TrunkPart::kWaist ? TrunkPart::kPelvis
                                                                 : TrunkPart::kChest;
}

class Recogniser {
 public:
  Recogniser(const Host& host, const PartMap& map) : host_(host), map_(map), m_(host.model.get()) {}
  HostParts run();

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(host_.path + ": " + what); }
  std::string name(int body) const { return "'" + host_.bodyName(body) + "'"; }
  void nameTrunk(int pelvis, int chest, HostParts& parts);

  // Bodies that the map gives for a part; throws if there is no such body.
  bool isGiven(const std::string& part) const { return map_.bodies.count(part) > 0; }
  std::vector<int> given(const std::string& part) const;
  bool givenPair(const std::string& part, std::array<int, 2>& pair) const;
  void findRoot(HostParts& parts, std::vector<LimbPair>& pairs) const;
  void findLimbs(HostParts& parts);
  void checkMap(const HostParts& parts) const;
  void applyMap(HostParts& parts) const;
  int commonAncestor(int a, int b) const;
  void report(HostParts& parts, int pelvis, int chest) const;

  const Host& host_;
  const PartMap& map_;
  const mjModel* m_;
  std::string leg_sureness_, leg_reason_, arm_sureness_, arm_reason_, head_sureness_, head_reason_;
};

void Recogniser::nameTrunk(int pelvis, int chest, HostParts& parts) {
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
  // Between a joint of the limb and pelvis or chest.
  for (int k = 0; k < 2; k++) {
    for (int b = m_->body_parentid[parts.thigh[k]]; b > 0 && b != pelvis; b = m_->body_parentid[b])
      parts.trunk.emplace(b, TrunkPart::kPelvis);
    for (int b = m_->body_parentid[parts.upper_arm[k]]; b > 0 && b != chest;
         b = m_->body_parentid[b]) {
      parts.trunk.emplace(b, k ? TrunkPart::kRightClavicle : TrunkPart::kLeftClavicle);
    }
  }

  int head = -1, candidates = 0;
  double highest = 0;
  bool by_name = false;
  for (int b : below(host_, parts.root)) {
    if (isLimb(b) || parts.trunk.count(b)) continue;
    const double height = (vector3(host_.data->xipos + 3 * b) - mid_shoulder).dot(up);
    const bool named = countWords(lower(host_.bodyName(b)), {"head", "skull"}) > 0;
    candidates += height > 0 && m_->body_parentid[b] == chest;
    if (named && (head < 0 || !by_name || host_.isBelow(head, b))) {
      head = b;
      by_name = true;
    } else if (!by_name && height > highest) {
      head = b;
      highest = height;
    }
  }
  head_sureness_ = by_name ? "sure" : candidates > 1 ? "unsure" : "likely";
  head_reason_ = by_name     ? "its name"
                 : head >= 0 ? "the highest body above the shoulders"
                             : "no body is above the shoulders; it is part of the chest";
  if (isGiven("head")) {
    const std::vector<int> heads = given("head");
    head = heads.empty() ? -1 : heads[0];
  }
  if (head >= 0) {
    parts.trunk[head] = TrunkPart::kHead;
    for (int b = m_->body_parentid[head]; b > 0 && !parts.trunk.count(b);
         b = m_->body_parentid[b]) {
      parts.trunk[b] = TrunkPart::kNeck;
    }
  }
  // Between pelvis and chest, whichever is the ancestor.
  for (int end : {pelvis, chest}) {
    const int other = end == pelvis ? chest : pelvis;
    if (!host_.isBelow(end, other)) continue;
    for (int b = m_->body_parentid[end]; b > 0 && b != other; b = m_->body_parentid[b]) {
      parts.trunk.emplace(b, TrunkPart::kWaist);
    }
  }
  applyMap(parts);
  for (int b : below(host_, parts.root)) {
    if (isLimb(b) || parts.trunk.count(b)) continue;
    const auto parent = parts.trunk.find(m_->body_parentid[b]);
    parts.trunk[b] = parent == parts.trunk.end() ? TrunkPart::kPelvis : parent->second;
  }
}

std::vector<int> Recogniser::given(const std::string& part) const {
  std::vector<int> bodies;
  const auto found = map_.bodies.find(part);
  if (found == map_.bodies.end()) return bodies;
  for (const std::string& body : found->second) {
    bodies.push_back(mj_name2id(m_, mjOBJ_BODY, body.c_str()));
    if (bodies.back() <= 0) {
      throw Error(fmt::format("{}: '{}': {} has no body '{}'", map_.path, part, host_.path, body));
    }
  }
  return bodies;
}

bool Recogniser::givenPair(const std::string& part, std::array<int, 2>& pair) const {
  const std::string left = "left_" + part, right = "right_" + part;
  if (!isGiven(left) && !isGiven(right)) return false;
  if (!isGiven(left) || !isGiven(right)) {
    throw Error(fmt::format("{}: give both of '{}' and '{}', or neither", map_.path, left, right));
  }
  pair = {given(left).at(0), given(right).at(0)};
  if (host_.isBelow(pair[0], pair[1]) || host_.isBelow(pair[1], pair[0])) {
    throw Error(fmt::format("{}: '{}' and '{}' are not two limbs", map_.path, left, right));
  }
  return true;
}

// Bodies that the map gives for the trunk are of the trunk.
void Recogniser::checkMap(const HostParts& parts) const {
  for (const auto& [name, part] : kTrunkParts) {
    for (int body : given(name)) {
      for (int limb : {parts.thigh[0], parts.thigh[1], parts.upper_arm[0], parts.upper_arm[1]}) {
        if (host_.isBelow(body, limb)) {
          throw Error(fmt::format("{}: body '{}' of the trunk is part of the limb '{}'", map_.path,
                                  host_.bodyName(body), host_.bodyName(limb)));
        }
      }
    }
  }
}

// What the map gives for the trunk, over what was recognised.
void Recogniser::applyMap(HostParts& parts) const {
  for (const auto& [name, part] : kTrunkParts) {
    if (!isGiven(name)) continue;
    for (auto& [body, is] : parts.trunk) {
      if (is == part) is = nearestEnd(part);
    }
    for (int b : given(name)) {
      // A rigid trunk is pelvis and chest.
      if (part != TrunkPart::kChest || given("pelvis") != given("chest")) parts.trunk[b] = part;
    }
  }
}

int Recogniser::commonAncestor(int a, int b) const {
  while (!host_.isBelow(b, a)) a = m_->body_parentid[a];
  return a;
}

// The child of the world that holds the humanoid, and its pairs of limbs.
void Recogniser::findRoot(HostParts& parts, std::vector<LimbPair>& pairs) const {
  parts.root = -1;
  for (const std::string& part : bodyMapParts().names) {
    for (int b : given(part)) {
      while (m_->body_parentid[b] > 0) b = m_->body_parentid[b];
      if (parts.root < 0) parts.root = b;
      if (parts.root != b) {
        throw Error(fmt::format("{}: its bodies are in two trees, of {} and {}", map_.path,
                                name(parts.root), name(b)));
      }
    }
  }
  if (parts.root >= 0) {
    pairs = limbPairs(host_, parts.root);
    return;
  }
  std::vector<int> others;
  for (int b = 1; b < m_->nbody; b++) {
    if (m_->body_parentid[b] != 0) continue;
    const std::vector<LimbPair> found = limbPairs(host_, b);
    if (found.size() >= 2) others.push_back(b);
    if (parts.root < 0 || found.size() > pairs.size()) {
      parts.root = b;
      pairs = found;
    }
  }
  if (parts.root < 0) fail("no bodies; give the MJCF of a humanoid");
  if (others.size() > 1) {
    fail("several humanoids (" + name(others[0]) + ", " + name(others[1]) +
         (others.size() > 2 ? ", ..." : "") +
         "); give a file with one, or name the 'pelvis' of one in a --map");
  }
}

void Recogniser::findLimbs(HostParts& parts) {
  std::vector<LimbPair> pairs;
  findRoot(parts, pairs);
  std::sort(pairs.begin(), pairs.end(), [](const LimbPair& a, const LimbPair& b) {
    return std::pair(a.leg_words, a.mass) > std::pair(b.leg_words, b.mass);
  });
  LimbPair legs = {}, arms = {};
  const bool legs_given = givenPair("thigh", legs.body);
  const bool arms_given = givenPair("upper_arm", arms.body);
  const auto overlap = [&](const LimbPair& p, const LimbPair& q) {
    for (int a : p.body) {
      for (int b : q.body) {
        if (host_.isBelow(a, b) || host_.isBelow(b, a)) return true;
      }
    }
    return false;
  };
  if (legs_given || arms_given) {
    pairs.erase(std::remove_if(pairs.begin(), pairs.end(),
                               [&](const LimbPair& p) {
                                 return (legs_given && overlap(p, legs)) ||
                                        (arms_given && overlap(p, arms));
                               }),
                pairs.end());
  }
  if (legs_given && arms_given && overlap(legs, arms)) {
    throw Error(map_.path + ": thighs and upper arms are parts of each other");
  }
  if (!legs_given && !arms_given) {
    if (pairs.empty()) {
      fail("no arms and no legs: no two bodies below " + name(parts.root) +
           " mirror each other; this is no humanoid, or a --map must name its 'left_thigh', "
           "'right_thigh', 'left_upper_arm' and 'right_upper_arm'");
    }
    legs = pairs.front(), arms = pairs.back();
    const bool no_legs = legs.leg_words < 0;
    const std::string missing = no_legs ? "no thighs" : "no arms";
    const std::string mend = fmt::format("; if it has, name 'left_{0}' and 'right_{0}' in a --map",
                                         no_legs ? "thigh" : "upper_arm");
    if (pairs.size() == 1) {
      fail(fmt::format("{}: {} and {} are the only pair of limbs{}", missing, name(legs.body[0]),
                       name(legs.body[1]), mend));
    }
    if (arms.leg_words > 0 || no_legs) {
      fail(fmt::format("{}: {} and {} are {} too{}", missing, name(arms.body[0]),
                       name(legs.body[0]), no_legs ? "arms" : "legs", mend));
    }
  } else if (!legs_given || !arms_given) {
    if (pairs.empty()) {
      fail(fmt::format("no pair of limbs beside those of the map; name 'left_{0}' and 'right_{0}'",
                       legs_given ? "upper_arm" : "thigh"));
    }
    (legs_given ? arms : legs) = legs_given ? pairs.back() : pairs.front();
  }
  bool sides = true;
  if (legs_given && arms_given) {
    parts.thigh = legs.body;
    parts.upper_arm = arms.body;
  } else {
    sides = orderSides(host_, legs, arms, parts);
    if (legs_given) parts.thigh = legs.body;
    if (arms_given) parts.upper_arm = arms.body;
  }
  const auto judge = [&](bool is_given, const LimbPair& limbs, std::string& sureness,
                         std::string& reason) {
    const bool named = limbs.leg_words != 0;
    sureness = is_given                     ? "given"
               : named && sides             ? "sure"
               : named || pairs.size() <= 2 ? "likely"
                                            : "unsure";
    reason = fmt::format("{}, {}", named ? "names" : "masses of the pairs of limbs",
                         sides ? "sides by name" : "sides by where the feet point");
    if (is_given) reason = map_.path;
  };
  judge(legs_given, legs, leg_sureness_, leg_reason_);
  judge(arms_given, arms, arm_sureness_, arm_reason_);
  for (int k = 0; k < 2; k++) {
    if (!legs_given) parts.thigh[k] = limbStart(host_, parts.thigh[k], false);
    if (!arms_given) parts.upper_arm[k] = limbStart(host_, parts.upper_arm[k], true);
    parts.hip[k] = host_.jointCentre(parts.thigh[k]);
    parts.shoulder[k] = host_.jointCentre(parts.upper_arm[k]);
    for (int limb : {parts.thigh[k], parts.upper_arm[k]}) {
      if (limb == parts.root) fail(name(limb) + " cannot be a limb: it is the root");
    }
  }
}

void Recogniser::report(HostParts& parts, int pelvis, int chest) const {
  const auto add = [&](const std::string& part, const std::vector<int>& bodies,
                       std::string sureness, std::string reason) {
    if (isGiven(part)) sureness = "given", reason = map_.path;
    std::vector<std::string> names;
    for (int b : bodies) names.push_back(host_.bodyName(b));
    parts.recognised.push_back({part, names, sureness, reason});
  };
  const auto of = [&](TrunkPart part) {
    std::vector<int> bodies;
    for (const auto& [body, is] : parts.trunk) {
      if (is == part) bodies.push_back(body);
    }
    return bodies;
  };
  const auto named = [&](int body, std::initializer_list<const char*> words) {
    return countWords(lower(host_.bodyName(body)), words) > 0;
  };
  const auto end = [&](const std::string& part, int body, bool by_name, const char* where) {
    const std::vector<int> bodies = isGiven(part) ? given(part) : std::vector<int>{body};
    add(part, bodies, by_name ? "sure" : "likely", by_name ? "its name and its place" : where);
  };
  end("pelvis", pelvis, named(pelvis, {"pelvis", "hip", "root", "sacrum"}), "the legs are on it");
  add("waist", of(TrunkPart::kWaist), "sure", "between pelvis and chest");
  end("chest", chest, named(chest, {"chest", "thorax", "torso", "trunk", "rib", "back"}),
      "the arms are on it");
  add("neck", of(TrunkPart::kNeck), head_sureness_, "between chest and head");
  std::vector<int> head = of(TrunkPart::kHead);
  if (!head.empty()) head.resize(1);
  add("head", head, head_sureness_, head_reason_);
  add("left_clavicle", of(TrunkPart::kLeftClavicle), arm_sureness_, "before the upper arm");
  add("right_clavicle", of(TrunkPart::kRightClavicle), arm_sureness_, "before the upper arm");
  add("left_thigh", {parts.thigh[0]}, leg_sureness_, leg_reason_);
  add("right_thigh", {parts.thigh[1]}, leg_sureness_, leg_reason_);
  add("left_upper_arm", {parts.upper_arm[0]}, arm_sureness_, arm_reason_);
  add("right_upper_arm", {parts.upper_arm[1]}, arm_sureness_, arm_reason_);
}

HostParts Recogniser::run() {
  HostParts parts;
  findLimbs(parts);
  const std::vector<int> given_pelvis = given("pelvis"), given_chest = given("chest");
  const int pelvis =
      given_pelvis.empty() ? commonAncestor(parts.thigh[0], parts.thigh[1]) : given_pelvis[0];
  const int chest =
      given_chest.empty() ? commonAncestor(parts.upper_arm[0], parts.upper_arm[1]) : given_chest[0];
  const auto checkAbove = [&](const char* part, int body, const std::array<int, 2>& limbs) {
    for (int limb : limbs) {
      if (body == limb || !host_.isBelow(limb, body)) {
        throw Error(
            fmt::format("{}: '{}': {} does not carry {}", map_.path, part, name(body), name(limb)));
      }
    }
  };
  checkMap(parts);
  checkAbove("pelvis", pelvis, parts.thigh);
  checkAbove("chest", chest, parts.upper_arm);
  const Vector3d hip = 0.5 * (parts.hip[0] + parts.hip[1]);
  const Vector3d up = 0.5 * (parts.shoulder[0] + parts.shoulder[1]) - hip;
  if (!(up.norm() > 1e-3)) fail("the shoulders are where the hips are");
  const Vector3d left = parts.hip[0] - parts.hip[1] + parts.shoulder[0] - parts.shoulder[1];
  if (!(left.cross(up).norm() > 1e-3 * up.norm())) fail("left and right limbs are at one place");
  Vector3d leg = Vector3d::Zero();
  for (int k = 0; k < 2; k++) {
    leg += 0.5 * vector3(host_.data->subtree_com + 3 * parts.thigh[k]);
  }
  leg -= hip;
  if (leg.dot(up) > -0.3 * leg.norm() * up.norm()) {
    fail("in its pose qpos0 the legs are not below the trunk; is it a biped?");
  }
  nameTrunk(pelvis, chest, parts);
  report(parts, pelvis, chest);
  return parts;
}

}  // namespace

HostParts recognise(const Host& host, const PartMap& map) { return Recogniser(host, map).run(); }

}  // namespace torso::tools
