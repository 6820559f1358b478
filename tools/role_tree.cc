// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/role_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "model/median.h"
#include "tools/role_names.h"

namespace torso::tools {

RoleTree::RoleTree(const Clip& c) : clip(c) {
  const size_t joints = clip.joints.size(), frames = clip.frames();
  const size_t count = std::min<size_t>(frames, 40);
  for (size_t k = 0; k < count; k++) {
    sample.push_back(count == 1 ? 0 : k * (frames - 1) / (count - 1));
  }
  children.resize(joints);
  length.assign(joints, 0);
  reach.assign(joints, 0);
  size.assign(joints, 1);
  for (size_t j = 0; j < joints; j++) {
    const int parent = clip.joints[j].parent;
    if (parent < 0) continue;
    children[parent].push_back(static_cast<int>(j));
    std::vector<double> lengths;
    for (size_t f : sample) {
      lengths.push_back((position(f, static_cast<int>(j)) - position(f, parent)).norm());
    }
    length[j] = median(lengths);
  }
  for (size_t j = joints; j-- > 0;) {
    if (clip.joints[j].parent >= 0) size[clip.joints[j].parent] += size[j];
  }
  for (size_t j = joints; j-- > 0;) {
    reach[j] += length[j];
    const int parent = clip.joints[j].parent;
    if (parent < 0 || isAppendage(static_cast<int>(j))) continue;
    reach[parent] = std::max(reach[parent], reach[j]);
  }
}

bool RoleTree::turns(int joint) const {
  const int parent = clip.joints[joint].parent;
  const auto turn = [&](size_t frame) {
    return Eigen::Matrix3d(clip.pose(frame, parent).linear().transpose() *
                           clip.pose(frame, joint).linear());
  };
  return parent < 0 || std::any_of(sample.begin(), sample.end(), [&](size_t f) {
           return !turn(f).isApprox(turn(sample[0]), 1e-3);
         });
}

bool RoleTree::isAppendage(int joint) const {
  const int parent = clip.joints[joint].parent;
  if (parent < 0 || size[joint] > 2 || turns(joint)) return false;
  return std::any_of(children[parent].begin(), children[parent].end(), [&](int other) {
    return size[other] > size[joint] || (size[other] == size[joint] && turns(other));
  });
}

bool RoleTree::isBelow(int joint, int ancestor) const {
  while (joint > ancestor) joint = clip.joints[joint].parent;
  return joint == ancestor;
}

std::vector<int> RoleTree::chain(int joint) const {
  std::vector<int> joints = {joint};
  while (!children[joints.back()].empty()) {
    const auto& next = children[joints.back()];
    const auto far = [&](int j) { return isAppendage(j) ? -1 : reach[j]; };
    joints.push_back(
        *std::max_element(next.begin(), next.end(), [&](int a, int b) { return far(a) < far(b); }));
  }
  return joints;
}

std::vector<int> RoleTree::way(int a, int b) const {
  std::vector<int> up = {a}, down;
  while (!isBelow(b, up.back())) {
    const int parent = clip.joints[up.back()].parent;
    if (parent < 0) return {};
    up.push_back(parent);
  }
  for (int j = b; j != up.back(); j = clip.joints[j].parent) down.push_back(j);
  up.insert(up.end(), down.rbegin(), down.rend());
  return up;
}

std::vector<int> RoleTree::below(int joint) const {
  std::vector<int> joints;
  for (int j = joint; j < static_cast<int>(clip.joints.size()); j++) {
    if (isBelow(j, joint)) joints.push_back(j);
  }
  return joints;
}

bool RoleTree::areAlike(int a, int b) const {
  const std::vector<int> x = chain(a), y = chain(b);
  if (std::min(x.size(), y.size()) < 3) return false;
  double apart = 0;
  for (size_t k = 0; k < std::max(x.size(), y.size()); k++) {
    apart += std::abs((k < x.size() ? length[x[k]] : 0) - (k < y.size() ? length[y[k]] : 0));
  }
  return apart < 0.1 * (reach[a] + reach[b]) / 2;
}

LimbJoints limbJoints(const RoleTree& tree, const std::vector<int>& chain, bool leg) {
  const int n = static_cast<int>(chain.size());
  std::vector<double> along(n, 0);  // from the first joint
  for (int k = 1; k < n; k++) along[k] = along[k - 1] + tree.length[chain[k]];
  const double before = tree.length[chain[0]];
  const auto named = [&](LimbRole role, int k) {
    return tree.clip.joints[chain[k]].end
               ? 0.0
               : nameScore(role, plainName(tree.clip.joints[chain[k]].name));
  };
  const auto roles = leg ? std::array{LimbRole::kThigh, LimbRole::kShin, LimbRole::kFoot}
                         : std::array{LimbRole::kUpperArm, LimbRole::kLowerArm, LimbRole::kHand};
  // Lengths of a man's bones (model/anatomy/landmarks.csv): thigh to shin, upper arm to forearm,
  // and the share of both in the limb to its tip.
  const double ratio = leg ? 1.1 : 1.05, share = leg ? 0.85 : 0.75;
  LimbJoints best;
  best.fit = -INFINITY;
  const auto consider = [&](int u, int l, int e) {
    if (tree.clip.joints[chain[u]].end || tree.clip.joints[chain[l]].end) return;
    const double upper = along[l] - along[u], total = along[n - 1] - along[u];
    if (!(upper > 0.05 * total && total > 0)) return;
    double names = named(roles[0], u) + named(roles[1], l);
    double fit = -1.5 * (before + along[u]) / (before + along[n - 1]);
    if (e >= 0) {
      const double lower = along[e] - along[l];
      if (!(lower > 0.05 * total)) return;
      names += named(roles[2], e);
      fit -= 4 * std::abs(std::log(upper / lower / ratio)) +
             2 * std::abs(std::log((upper + lower) / total / share));
      if (!leg && tree.children[chain[e]].size() >= 3) fit += 1;
      if (tree.clip.joints[chain[e]].end) fit -= 0.5;  // a true joint rather than an end
    } else {
      fit -= 3;
    }
    for (int k = 0; k < u; k++) {
      if (!leg) names += std::max(0.0, named(LimbRole::kClavicle, k)) / 2;
    }
    if (fit + names <= best.fit) return;
    best.fit = fit + names;
    best.name_score = names;
    best.before.assign(chain.begin(), chain.begin() + u);
    best.upper = chain[u];
    best.lower = chain[l];
    best.end = e >= 0 ? chain[e] : -1;
    best.tip = e >= 0 && e + 1 < n ? chain[e + 1] : -1;
  };
  for (int u = 0; u + 1 < n; u++) {
    for (int l = u + 1; l < n; l++) {
      for (int e = l + 1; e < n; e++) consider(u, l, e);
      if (l == n - 1) consider(u, l, -1);
    }
  }
  return best;
}

}  // namespace torso::tools
