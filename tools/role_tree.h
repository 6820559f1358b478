// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// What the recognition of roles looks at: the tree of a clip's joints with the lengths of bones,
// and a sample of its frames.

#include <array>
#include <vector>

#include "tools/clip.h"

namespace torso::tools {

struct RoleTree {
  explicit RoleTree(const Clip& clip);

  const Clip& clip;
  std::vector<size_t> sample;              // frames, at most 40, evenly over the clip
  std::vector<std::vector<int>> children;  // by joint
  std::vector<double> length;              // from the parent to the joint, median of the sample
  std::vector<double> reach;               // longest way along bones from the parent to
                                           // an end, appendages apart
  std::vector<int> size;                   // joints in the subtree, itself included

  Eigen::Vector3d position(size_t frame, int joint) const {
    return clip.pose(frame, joint).translation();
  }
  bool isBelow(int joint, int ancestor) const;  // in its subtree, or itself
  bool turns(int joint) const;                  // against its parent, in the sample
  // Holds a mesh or is a helper: a joint or two that never turn, beside a sibling that carries more
  // or turns.
  bool isAppendage(int joint) const;
  // From a joint along the longest way to an end, both included.
  std::vector<int> chain(int joint) const;
  // From a to b through their last common ancestor, both included; empty if they are in two trees.
  std::vector<int> way(int a, int b) const;
  std::vector<int> below(int joint) const;  // itself included
  // Chains of the same bones: their lengths differ by less than a tenth of the whole.
  bool areAlike(int a, int b) const;
};

// The joints of a limb.
struct LimbJoints {
  std::vector<int> before;                         // of the girdle
  int upper = -1, lower = -1, end = -1, tip = -1;  // end: foot or hand; tip: toe or finger
  double name_score = 0, fit = 0;                  // of names; of names and lengths
};

// Among the chain of joints of a limb, those at which its two long bones begin and end.
LimbJoints limbJoints(const RoleTree& tree, const std::vector<int>& chain, bool leg);

}  // namespace torso::tools
