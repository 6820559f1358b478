// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/graft_limb_pairs.h"

#include <algorithm>
#include <cmath>

#include "tools/error.h"
#include "tools/mujoco_eigen.h"

namespace torso::tools {
namespace {

using Eigen::Vector3d;

constexpr const char* kMapLimbs =
    "; name 'left_thigh', 'right_thigh', 'left_upper_arm' and 'right_upper_arm' in a --map";

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

bool isClavicle(const std::string& name) {
  return countWords(lower(name), {"clav", "collar", "thorax", "scap"}) > 0;
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

int limbStart(const Host& host, int body, bool arm) {
  const mjModel* m = host.model.get();
  while (m->body_jntnum[body] == 0 || (arm && isClavicle(host.bodyName(body)))) {
    const int next = heaviestChild(host, body);
    if (next < 0) {
      throw Error(host.path + ": the limb of '" + host.bodyName(body) + "' has no joint" +
                  kMapLimbs);
    }
    body = next;
  }
  return body;
}

bool orderSides(const Host& host, const LimbPair& legs, const LimbPair& arms, HostParts& parts) {
  std::array<int, 2> leg = legs.body, arm = arms.body;
  const int leg_side = sideByName(host.bodyName(leg[0]), host.bodyName(leg[1]));
  const int arm_side = sideByName(host.bodyName(arm[0]), host.bodyName(arm[1]));
  const auto at = [&](int b) { return host.jointCentre(b); };
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
      while (heaviestChild(host, b) >= 0) b = heaviestChild(host, b);
      forward += vector3(host.data->xipos + 3 * b) - host.pose(b).translation();
    }
    forward -= forward.dot(up) / up.squaredNorm() * up;
    if (forward.norm() < 0.01) {
      throw Error(host.path + ": cannot tell left from right: neither the names of " + "'" +
                  host.bodyName(leg[0]) + "'" + " and " + "'" + host.bodyName(leg[1]) + "'" +
                  " nor the feet say it" + kMapLimbs);
    }
    if ((at(leg[0]) - at(leg[1])).dot(up.cross(forward)) < 0) std::swap(leg[0], leg[1]);
  }
  const Vector3d left = at(leg[0]) - at(leg[1]);
  if ((at(arm[0]) - at(arm[1])).dot(left) < 0) std::swap(arm[0], arm[1]);
  parts.thigh = leg;
  parts.upper_arm = arm;
  return leg_side != 0 || arm_side != 0;
}

}  // namespace torso::tools
