// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// The trunk, and the persons of a clip.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/role_finder.h"

namespace torso::tools {

using Eigen::Vector3d;

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

namespace {

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
