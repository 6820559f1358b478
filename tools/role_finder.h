// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// How findRoles works on one person: limbs in role_limbs.cc, trunk and report in role_find.cc.

#include <array>
#include <string>
#include <vector>

#include "tools/error.h"
#include "tools/role.h"
#include "tools/role_names.h"
#include "tools/role_tree.h"

namespace torso::tools {

// Two branches of one joint that mirror each other.
struct BranchPair {
  int base;
  std::array<int, 2> branch;
  int leg_words;  // words of legs less words of arms among its names
  double reach;
  bool named;  // mirrored by name, else by length
};

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

}  // namespace torso::tools
