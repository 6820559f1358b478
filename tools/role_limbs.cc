// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Arms and legs, left and right.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/part_names.h"
#include "tools/role_finder.h"

namespace torso::tools {

using Eigen::Vector3d;

// A pair of limbs is at least this share of the longest pair; fingers, ears and eyes are less.
constexpr double kLimbShare = 0.4;

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

}  // namespace torso::tools
