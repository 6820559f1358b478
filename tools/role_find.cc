// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/error.h"
#include "tools/part_names.h"
#include "tools/role.h"
#include "tools/role_names.h"
#include "tools/role_tree.h"

namespace torso::tools {
namespace {

using Eigen::Vector3d;

// Two branches of one joint that mirror each other.
struct BranchPair {
  int base;
  std::array<int, 2> branch;
  int leg_words;  // words of legs less words of arms among its names
  double reach;
  bool named;  // mirrored by name, else by length
};

// A pair of limbs is at least this share of the longest pair; fingers, ears and eyes are less.
constexpr double kLimbShare = 0.4;

class RoleFinder {
 public:
  RoleFinder(const Clip& clip, const PartMap& map, const RoleTree& tree, int root)
      : clip_(clip), map_(map), tree_(tree), root_(root) {}

  Roles find();
  // Pairs of branches below root that can be limbs.
  std::vector<BranchPair> pairs() const;

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(clip_.path + ": " + what); }
  const std::string& name(int joint) const { return clip_.joints[joint].name; }
  std::string plain(int joint) const { return plainName(name(joint)); }
  bool isGiven(const std::string& part) const { return map_.bodies.count(part) > 0; }
  std::vector<int> given(const std::string& part) const;
  bool givenPair(const std::string& part, std::array<int, 2>& pair) const;
  bool inLimb(int joint) const;
  void findLimbs();
  void findSides(std::array<int, 2>& legs, std::array<int, 2>& arms);
  void placeLimb(bool leg, const std::array<int, 2>& branches);
  void giveLimb(bool leg);
  int pelvisOf(int base) const;
  void findTrunk();
  void findHead(int arm_base);
  void refuseAnimals() const;
  void note(const std::string& part, const std::vector<int>& joints, const std::string& sureness,
            const std::string& reason);
  void report();

  const Clip& clip_;
  const PartMap& map_;
  const RoleTree& tree_;
  const int root_;
  Roles roles_;
  int leg_base_ = -1, arm_base_ = -1;
  std::string leg_reason_, arm_reason_, side_reason_, head_reason_, hips_reason_;
  double leg_names_ = 0, arm_names_ = 0;
  bool sides_sure_ = true, limbs_sure_ = true, head_sure_ = true;
};

std::vector<int> RoleFinder::given(const std::string& part) const {
  std::vector<int> joints;
  const auto found = map_.bodies.find(part);
  if (found == map_.bodies.end()) return joints;
  for (const std::string& name : found->second) {
    int joint = -1;
    for (size_t j = 0; j < clip_.joints.size() && joint < 0; j++) {
      if (clip_.joints[j].name == name) joint = static_cast<int>(j);
    }
    if (joint < 0) {
      throw Error(fmt::format("{}: '{}': {} has no joint '{}'", map_.path, part, clip_.path, name));
    }
    joints.push_back(joint);
  }
  return joints;
}

bool RoleFinder::givenPair(const std::string& part, std::array<int, 2>& pair) const {
  const std::string left = "left_" + part, right = "right_" + part;
  if (!isGiven(left) && !isGiven(right)) return false;
  const std::vector<int> l = given(left), r = given(right);
  if (l.empty() != r.empty() || !isGiven(left) || !isGiven(right)) {
    throw Error(fmt::format("{}: give both of '{}' and '{}', or neither", map_.path, left, right));
  }
  pair = {-1, -1};
  if (!l.empty()) pair = {l[0], r[0]};
  return true;
}

std::vector<BranchPair> RoleFinder::pairs() const {
  std::vector<BranchPair> found;
  double longest = 0;
  const auto words = [&](int branch) {
    int sum = 0;
    for (int j : tree_.below(branch)) sum += legOrArm(plain(j));
    return sum;
  };
  for (int base : tree_.below(root_)) {
    const bool inside = std::any_of(found.begin(), found.end(), [&](const BranchPair& p) {
      return tree_.isBelow(base, p.branch[0]) || tree_.isBelow(base, p.branch[1]);
    });
    if (inside) continue;
    const std::vector<int>& c = tree_.children[base];
    // The best partner of each branch, the longest branches first.
    std::vector<BranchPair> here;
    for (size_t i = 0; i < c.size(); i++) {
      for (size_t k = i + 1; k < c.size(); k++) {
        const int a = c[i], b = c[k];
        if (std::min(tree_.size[a], tree_.size[b]) < 2) continue;
        const double ra = tree_.reach[a], rb = tree_.reach[b];
        const bool named = sideByName(name(a), name(b)) != 0 ||
                           (sideOf(name(a)) * sideOf(name(b)) == -1 && words(a) * words(b) >= 0);
        const bool alike = sideOf(name(a)) == 0 && sideOf(name(b)) == 0 && tree_.areAlike(a, b);
        // Ends of bones may be anywhere; words that say arm or leg on both sides weigh more.
        const bool similar = std::abs(ra - rb) < 0.35 * (ra + rb) || words(a) * words(b) > 0;
        if (!(named && similar) && !alike) continue;
        here.push_back({base, {a, b}, words(a) + words(b), std::min(ra, rb), named});
      }
    }
    std::stable_sort(here.begin(), here.end(), [](const BranchPair& a, const BranchPair& b) {
      return std::pair(a.named, a.reach) > std::pair(b.named, b.reach);
    });
    std::vector<int> taken;
    for (const BranchPair& p : here) {
      const auto used = [&](int j) { return std::count(taken.begin(), taken.end(), j) > 0; };
      if (used(p.branch[0]) || used(p.branch[1])) continue;
      taken.insert(taken.end(), p.branch.begin(), p.branch.end());
      // A chain that carries other pairs of limbs is the trunk of half of something else.
      found.push_back(p);
      longest = std::max(longest, p.reach);
    }
  }
  found.erase(std::remove_if(found.begin(), found.end(),
                             [&](const BranchPair& p) { return p.reach < kLimbShare * longest; }),
              found.end());
  return found;
}

bool RoleFinder::inLimb(int joint) const {
  for (const auto& pair : {roles_.thigh, roles_.upper_arm}) {
    for (int limb : pair) {
      if (limb >= 0 && tree_.isBelow(joint, limb)) return true;
    }
  }
  for (const auto& clavicle : roles_.clavicle) {
    if (!clavicle.empty() && tree_.isBelow(joint, clavicle.front())) return true;
  }
  return false;
}

void RoleFinder::findLimbs() {
  std::array<int, 2> legs = {-1, -1}, arms = {-1, -1};
  const bool legs_given = givenPair("thigh", legs), arms_given = givenPair("upper_arm", arms);
  std::vector<BranchPair> found = pairs();
  const auto overlaps = [&](const BranchPair& p, const std::array<int, 2>& limbs) {
    for (int a : p.branch) {
      for (int b : limbs) {
        if (b >= 0 && (tree_.isBelow(a, b) || tree_.isBelow(b, a))) return true;
      }
    }
    return false;
  };
  found.erase(std::remove_if(found.begin(), found.end(),
                             [&](const BranchPair& p) {
                               return (legs_given && overlaps(p, legs)) ||
                                      (arms_given && overlaps(p, arms));
                             }),
              found.end());
  const auto depth = [&](const BranchPair& p) { return tree_.way(root_, p.base).size(); };
  // Legs first: by words, then by nearness to the root, then by length.
  std::stable_sort(found.begin(), found.end(), [&](const BranchPair& a, const BranchPair& b) {
    const auto key = [&](const BranchPair& p) {
      const int words = p.leg_words > 0 ? 1 : p.leg_words < 0 ? -1 : 0;
      return std::tuple(-words, depth(p), -p.reach);
    };
    return key(a) < key(b);
  });
  if (!legs_given && !found.empty() && found.front().leg_words >= 0 &&
      (found.size() > 1 || found.front().leg_words > 0 || arms_given)) {
    legs = found.front().branch;
    leg_base_ = found.front().base;
    leg_reason_ = found.front().leg_words > 0 ? "names" : "the pair of limbs nearest the root";
    limbs_sure_ = limbs_sure_ && (found.front().leg_words > 0 || found.size() == 2);
    found.erase(found.begin());
  }
  if (!arms_given && !found.empty() && (found.back().leg_words <= 0)) {
    arms = found.back().branch;
    arm_base_ = found.back().base;
    arm_reason_ = found.back().leg_words < 0 ? "names" : "the pair of limbs farther from the root";
    limbs_sure_ = limbs_sure_ && (found.back().leg_words < 0 || found.size() == 1);
  }
  if (legs[0] < 0 && arms[0] < 0) {
    fail(fmt::format(
        "no arms and no legs: no two branches of '{}' mirror each other; this is no person, or a "
        "--map must name its 'left_thigh', 'right_thigh', 'left_upper_arm' and 'right_upper_arm'",
        name(root_)));
  }
  findSides(legs, arms);
  if (legs_given) {
    giveLimb(true);
  } else if (legs[0] >= 0) {
    placeLimb(true, legs);
  }
  if (arms_given) {
    giveLimb(false);
  } else if (arms[0] >= 0) {
    placeLimb(false, arms);
  }
}

// What a map says of a limb; from its upper bone on, the rest is found where it does not.
void RoleFinder::giveLimb(bool leg) {
  auto& upper = leg ? roles_.thigh : roles_.upper_arm;
  givenPair(leg ? "thigh" : "upper_arm", upper);
  (leg ? leg_reason_ : arm_reason_) = map_.path;
  if (upper[0] < 0) return;
  const std::array<int, 2> branches = upper;
  placeLimb(leg, branches);
  for (int k = 0; k < 2; k++) {
    auto& girdle = roles_.clavicle[k];
    if (!leg) girdle.clear();
    const int below = leg ? roles_.shin[k] : roles_.lower_arm[k];
    if (upper[k] != branches[k]) {
      upper[k] = branches[k];
      if (!tree_.isBelow(below, upper[k])) (leg ? roles_.shin : roles_.lower_arm)[k] = -1;
    }
  }
  int& base = leg ? leg_base_ : arm_base_;
  int a = branches[0];
  while (a >= 0 && !tree_.isBelow(branches[1], a)) a = clip_.joints[a].parent;
  if (a < 0) {
    throw Error(fmt::format("{}: '{}' and '{}' are in two skeletons", map_.path, name(branches[0]),
                            name(branches[1])));
  }
  if (a == branches[0] || a == branches[1]) {
    throw Error(fmt::format("{}: '{}' and '{}' are not two limbs", map_.path, name(branches[0]),
                            name(branches[1])));
  }
  base = a;
  if (leg) return;
  for (int k = 0; k < 2; k++) {
    for (int j = clip_.joints[branches[k]].parent; j != base; j = clip_.joints[j].parent) {
      roles_.clavicle[k].insert(roles_.clavicle[k].begin(), j);
    }
  }
}

void RoleFinder::placeLimb(bool leg, const std::array<int, 2>& branches) {
  double names = INFINITY;
  for (int k = 0; k < 2; k++) {
    const LimbJoints limb = limbJoints(tree_, tree_.chain(branches[k]), leg);
    if (limb.upper < 0) {
      fail(fmt::format("'{}' has no two bones of a limb below it; are bones of no length?",
                       name(branches[k])));
    }
    (leg ? roles_.thigh : roles_.upper_arm)[k] = limb.upper;
    (leg ? roles_.shin : roles_.lower_arm)[k] = limb.lower;
    (leg ? roles_.foot : roles_.hand)[k] = limb.end;
    if (leg) roles_.toe[k] = limb.tip;
    if (!leg) roles_.clavicle[k] = limb.before;
    names = std::min(names, limb.name_score);
  }
  (leg ? leg_names_ : arm_names_) = names;
}

// Sorts the pairs left, right.
void RoleFinder::findSides(std::array<int, 2>& legs, std::array<int, 2>& arms) {
  int votes = 0, voters = 0;
  for (auto* pair : {&legs, &arms}) {
    if ((*pair)[0] < 0) continue;
    if (isGiven(pair == &legs ? "left_thigh" : "left_upper_arm")) continue;
    voters++;
    int side = sideByName(name((*pair)[0]), name((*pair)[1]));
    if (side == 0) {
      for (int k = 0; k < 2; k++) {
        for (int j : tree_.chain((*pair)[k])) side += (k ? -1 : 1) * sideOf(name(j));
      }
    }
    if (side > 0) std::swap((*pair)[0], (*pair)[1]);
    votes += side != 0;
  }
  side_reason_ = "sides by name";
  if (voters == 0 || votes == voters) return;
  // Some pair is not named: where the toes point, and then the other pair goes with this one.
  sides_sure_ = false;
  side_reason_ = "sides by where the toes point";
  if (legs[0] < 0 || arms[0] < 0) {
    side_reason_ = "sides by the order in the file";
    return;
  }
  const std::vector<int> a = tree_.chain(legs[0]), b = tree_.chain(legs[1]);
  const LimbJoints la = limbJoints(tree_, a, true), lb = limbJoints(tree_, b, true);
  double sign = 0, together = 0;
  for (size_t f : tree_.sample) {
    const auto at = [&](int j) { return tree_.position(f, j); };
    const Vector3d up = at(arms[0]) + at(arms[1]) - at(legs[0]) - at(legs[1]);
    Vector3d forward = Vector3d::Zero();
    for (const LimbJoints& leg : {la, lb}) {
      if (leg.end < 0) continue;
      // Toes, or else the knee that bends forward.
      forward += leg.tip >= 0 ? Vector3d(at(leg.tip) - at(leg.end))
                              : Vector3d(at(leg.lower) - 0.5 * (at(leg.upper) + at(leg.end)));
    }
    const Vector3d across = at(legs[0]) - at(legs[1]);
    sign += up.cross(forward).dot(across);
    const Vector3d over = at(arms[0]) - at(arms[1]);
    together += across.dot(over);
  }
  const int leg_side = sideByName(name(legs[0]), name(legs[1]));
  if (leg_side == 0 && votes == 0 && sign < 0) {
    std::swap(legs[0], legs[1]);
    together = -together;
  }
  if (together < 0) std::swap(arms[0], arms[1]);
}

// The joint that carries the pelvis: the legs' base, or a joint near it by the name of pelvis if
// the hip joints keep their place on that one (Character Studio hangs thighs on the spine).
int RoleFinder::pelvisOf(int base) const {
  const auto looseness = [&](int joint) {
    double sum = 0;
    for (int thigh : roles_.thigh) {
      Vector3d mean = Vector3d::Zero();
      std::vector<Vector3d> places;
      for (size_t f : tree_.sample) {
        places.push_back(clip_.pose(f, joint).inverse() * tree_.position(f, thigh));
        mean += places.back();
      }
      mean /= static_cast<double>(places.size());
      for (const Vector3d& p : places) sum += (p - mean).norm();
    }
    return sum;
  };
  int best = base;
  double least = looseness(base);
  const double noise = 1e-4 * tree_.reach[base] * static_cast<double>(tree_.sample.size());
  std::vector<int> near;
  for (int j = clip_.joints[base].parent; j >= 0; j = clip_.joints[j].parent) near.push_back(j);
  for (int j : tree_.children[base]) near.push_back(j);
  for (int j : near) {
    if (!isPelvisName(plain(j)) || inLimb(j) || clip_.joints[j].end) continue;
    const double loose = looseness(j);
    // Clearly better, or as good with the better name.
    if (loose + noise < 0.5 * least || (loose <= least + noise && !isPelvisName(plain(best)))) {
      best = j;
      least = loose;
    }
  }
  return best;
}

void RoleFinder::findTrunk() {
  if (roles_.hasLegs()) {
    roles_.hips = pelvisOf(leg_base_);
    hips_reason_ = roles_.hips == leg_base_ ? "carries the legs"
                                            : "its name, and the hip joints keep their place on it";
  } else {
    roles_.hips = root_;
    for (int j : tree_.way(root_, arm_base_)) {
      if (isPelvisName(plain(j))) roles_.hips = j;
    }
    hips_reason_ = "no legs: the root of the trunk";
  }
  if (isGiven("hips")) roles_.hips = given("hips").at(0), hips_reason_ = map_.path;
  if (!roles_.hasArms()) arm_base_ = -1;
  if (arm_base_ >= 0) {
    const int from =
        leg_base_ >= 0 && tree_.way(roles_.hips, arm_base_).empty() ? leg_base_ : roles_.hips;
    for (int j : tree_.way(from, arm_base_)) {
      if (j != roles_.hips && j != leg_base_) roles_.trunk.push_back(j);
      // Thighs on the spine: the base of the legs is of the trunk and turns with it.
      if (j == leg_base_ && j != roles_.hips) roles_.trunk.push_back(j);
    }
  }
  findHead(arm_base_ >= 0 ? arm_base_ : roles_.hips);
  while (!roles_.trunk.empty() && isNeckName(plain(roles_.trunk.back()))) {
    roles_.neck.insert(roles_.neck.begin(), roles_.trunk.back());
    roles_.trunk.pop_back();
  }
  if (isGiven("trunk")) roles_.trunk = given("trunk");
  if (isGiven("neck")) roles_.neck = given("neck");
}

void RoleFinder::findHead(int base) {
  int head = -1;
  head_reason_ = "its name";
  for (int j : tree_.below(root_)) {
    if (inLimb(j) || clip_.joints[j].end || !isHeadName(plain(j))) continue;
    if (head < 0 || !tree_.isBelow(j, head)) {
      if (head < 0) head = j;
    }
  }
  if (head < 0) {
    head_sure_ = false;
    // The longest branch beyond the arms, to its last joint that carries another.
    int branch = -1;
    for (int j : tree_.children[base]) {
      if (inLimb(j) || j == roles_.hips || tree_.isBelow(roles_.hips, j)) continue;
      bool legs = false;
      for (int thigh : roles_.thigh) legs = legs || (thigh >= 0 && tree_.isBelow(thigh, j));
      if (legs) continue;
      if (branch < 0 || tree_.reach[j] > tree_.reach[branch]) branch = j;
    }
    if (branch >= 0 && !clip_.joints[branch].end) {
      head = branch;
      for (int j : tree_.chain(branch)) {
        if (!clip_.joints[j].end && (!tree_.children[j].empty() || j == branch)) head = j;
      }
      head_reason_ = "the longest branch beyond the arms";
    } else {
      head_reason_ = "no branch beyond the arms";
    }
  }
  if (isGiven("head")) {
    const std::vector<int> joints = given("head");
    head = joints.empty() ? -1 : joints[0];
  }
  roles_.head = head;
  if (head < 0 || !tree_.isBelow(head, base)) return;
  for (int j = clip_.joints[head].parent; j >= 0 && j != base; j = clip_.joints[j].parent) {
    roles_.neck.insert(roles_.neck.begin(), j);
  }
}

// A trunk that lies across its legs in the rest pose and all of the clip, on fore legs.
void RoleFinder::refuseAnimals() const {
  if (!map_.path.empty()) return;
  std::string animal;
  for (int j : tree_.below(root_)) {
    if (animal.empty() && isAnimalName(plain(j))) animal = name(j);
  }
  if (!roles_.hasArms() || !roles_.hasLegs() || roles_.foot[0] < 0 || roles_.hand[0] < 0) return;
  const auto across = [&](const auto& at) {
    const Vector3d trunk = at(roles_.upper_arm[0]) + at(roles_.upper_arm[1]) - at(roles_.thigh[0]) -
                           at(roles_.thigh[1]);
    int count = 0;
    std::array<Vector3d, 4> limbs;
    for (int k = 0; k < 2; k++) {
      limbs[k] = at(roles_.foot[k]) - at(roles_.thigh[k]);
      limbs[2 + k] = at(roles_.hand[k]) - at(roles_.upper_arm[k]);
    }
    for (const Vector3d& limb : limbs) {
      count += std::abs(limb.normalized().dot(trunk.normalized())) < 0.5;
    }
    return count == 4 && limbs[0].normalized().dot(limbs[2].normalized()) > 0.7 &&
           limbs[1].normalized().dot(limbs[3].normalized()) > 0.7;
  };
  bool all = across([&](int j) { return Vector3d(clip_.rest[j].translation()); });
  size_t often = 0;
  for (size_t f : tree_.sample) often += across([&](int j) { return tree_.position(f, j); });
  all = all && 2 * often > tree_.sample.size();
  if (!all && (animal.empty() || 2 * often <= tree_.sample.size())) return;
  fail(fmt::format(
      "this is an animal on four legs{}: its trunk lies across all four limbs in the rest pose and "
      "in {:.0f} % of the frames; only a human body can be retrofitted (a --map overrides this)",
      animal.empty() ? "" : " ('" + animal + "')",
      100.0 * static_cast<double>(often) / static_cast<double>(tree_.sample.size())));
}

void RoleFinder::note(const std::string& part, const std::vector<int>& joints,
                      const std::string& sureness, const std::string& reason) {
  RecognisedPart r = {
      part, {}, isGiven(part) ? "given" : sureness, isGiven(part) ? map_.path : reason};
  for (int j : joints) {
    if (j >= 0) r.bodies.push_back(name(j));
  }
  if (r.bodies.empty() && !isGiven(part)) r.reason = "the clip has none";
  roles_.recognised.push_back(r);
}

void RoleFinder::report() {
  const std::string trunk =
      roles_.trunk.empty() ? "no joint between legs and arms" : "between legs and arms";
  note("hips", {roles_.hips},
       isPelvisName(plain(roles_.hips)) || roles_.hasLegs() ? "sure" : "likely", hips_reason_);
  note("trunk", roles_.trunk, "sure", trunk);
  note("neck", roles_.neck, head_sure_ ? "sure" : "likely", "between trunk and head");
  note("head", {roles_.head}, head_sure_ ? "sure" : "likely", head_reason_);
  const auto limb = [&](bool leg, double names, const std::string& reason) {
    const std::string sureness = names >= 6 && sides_sure_   ? "sure"
                                 : limbs_sure_ && names > -1 ? "likely"
                                                             : "unsure";
    const std::string why = fmt::format("{}; {}; joints by {}", reason, side_reason_,
                                        names >= 6 ? "names and lengths" : "lengths");
    for (int k = 0; k < 2; k++) {
      const std::string side = k ? "right_" : "left_";
      if (leg) {
        note(side + "thigh", {roles_.thigh[k]}, sureness, why);
        note(side + "shin", {roles_.shin[k]}, sureness, why);
        note(side + "foot", {roles_.foot[k]}, sureness, why);
        note(side + "toe", {roles_.toe[k]}, sureness, why);
      } else {
        note(side + "clavicle", roles_.clavicle[k], sureness, why);
        note(side + "upper_arm", {roles_.upper_arm[k]}, sureness, why);
        note(side + "lower_arm", {roles_.lower_arm[k]}, sureness, why);
        note(side + "hand", {roles_.hand[k]}, sureness, why);
      }
    }
  };
  limb(false, arm_names_, arm_reason_);
  limb(true, leg_names_, leg_reason_);
}

Roles RoleFinder::find() {
  findLimbs();
  findTrunk();
  for (int k = 0; k < 2; k++) {  // single joints that the map gives
    const std::string side = k ? "right_" : "left_";
    const auto take = [&](const char* part, int& joint) {
      if (!isGiven(side + part)) return;
      const std::vector<int> joints = given(side + part);
      joint = joints.empty() ? -1 : joints[0];
    };
    take("lower_arm", roles_.lower_arm[k]);
    take("hand", roles_.hand[k]);
    take("shin", roles_.shin[k]);
    take("foot", roles_.foot[k]);
    take("toe", roles_.toe[k]);
    if (isGiven(side + "clavicle")) roles_.clavicle[k] = given(side + "clavicle");
  }
  refuseAnimals();
  report();
  return roles_;
}

// The joints each of which holds one person: where two or more branches have limbs of their own,
// it is they.
void listPersons(const Clip& clip, const RoleTree& tree, int joint, std::vector<int>& persons) {
  const auto limbs = [&](int root) {
    return RoleFinder(clip, PartMap(), tree, root).pairs().size();
  };
  std::vector<int> own;
  for (int child : tree.children[joint]) {
    if (tree.size[child] >= 9 && limbs(child) >= 2) own.push_back(child);
  }
  if (own.size() < 2) {
    persons.push_back(joint);
    return;
  }
  for (int child : own) listPersons(clip, tree, child, persons);
}

}  // namespace

const MapParts& roleMapParts() {
  static const MapParts parts = [] {
    MapParts p = {{"hips", "trunk", "neck", "head"},
                  {"trunk", "neck", "left_clavicle", "right_clavicle"},
                  {"head"}};
    for (const char* part :
         {"clavicle", "upper_arm", "lower_arm", "hand", "thigh", "shin", "foot", "toe"}) {
      for (const char* side : {"left_", "right_"}) {
        p.names.push_back(side + std::string(part));
        if (part != std::string("clavicle")) p.optional.push_back(side + std::string(part));
      }
    }
    return p;
  }();
  return parts;
}

std::vector<Roles> findRoles(const Clip& clip, const PartMap& map) {
  const RoleTree tree(clip);
  std::vector<int> roots, persons;
  for (size_t j = 0; j < clip.joints.size(); j++) {
    if (clip.joints[j].parent < 0) roots.push_back(static_cast<int>(j));
  }
  if (!map.path.empty()) {
    // The tree of the first joint that the map names.
    int named = -1;
    for (const auto& [part, names] : map.bodies) {
      for (size_t j = 0; j < clip.joints.size() && !names.empty(); j++) {
        if (named < 0 && clip.joints[j].name == names[0]) named = static_cast<int>(j);
      }
    }
    while (named >= 0 && clip.joints[named].parent >= 0) named = clip.joints[named].parent;
    if (named >= 0) return {RoleFinder(clip, map, tree, named).find()};
  }
  for (int root : roots) listPersons(clip, tree, root, persons);
  // Roots beside a person's are props, lights and controls.
  std::vector<Roles> found;
  std::string first_error;
  const int largest = *std::max_element(persons.begin(), persons.end(),
                                        [&](int a, int b) { return tree.size[a] < tree.size[b]; });
  for (int person : persons) {
    try {
      Roles roles = RoleFinder(clip, map, tree, person).find();
      found.push_back(std::move(roles));
    } catch (const Error& e) {
      if (person == largest) first_error = e.what();
    }
  }
  if (found.empty()) throw Error(first_error);
  const auto whole = [](const Roles& r) { return r.hasArms() && r.hasLegs(); };
  if (std::any_of(found.begin(), found.end(), whole)) {
    found.erase(
        std::remove_if(found.begin(), found.end(), [&](const Roles& r) { return !whole(r); }),
        found.end());
  }
  return found;
}

PartMap mapOf(const Clip& clip, const Roles& roles) {
  PartMap map;
  map.path = clip.path;
  for (const RecognisedPart& part : roles.recognised) map.bodies[part.part] = part.bodies;
  return map;
}

}  // namespace torso::tools
