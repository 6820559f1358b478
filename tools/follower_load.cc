// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/follower_load.h"

#include <algorithm>
#include <string>

#include "tools/mujoco_support.h"

namespace torso::tools {

using Eigen::Vector3d;

namespace {

// The rib cage with what hangs on it rests on the vertebrae of its costal joints, T1 to T10, on all
// alike.
constexpr int kRibs = 10;

// Number of the vertebrae T1 .. T10 that are above a disc, whose lower bone is `lower`.
int ribsAbove(const std::string& lower) {
  if (lower[0] == 'C') return 0;
  if (lower[0] != 'T') return kRibs;
  return std::min(std::stoi(lower.substr(1)) - 1, kRibs);
}

}  // namespace

FollowerLoad::FollowerLoad(const mjModel* torso, const mjModel* human) {
  const auto subtreeMass = [&](const std::string& body) {
    return human->body_subtreemass[mj_name2id(human, mjOBJ_BODY, body.c_str())];
  };
  const int discs = torsoOf(torso, "torso").ndisc;
  discs_.resize(discs);
  double mass = subtreeMass("head");
  const double ribcage = subtreeMass("ribcage");
  // From the head down; a vertebra's subtree is itself, but for that of the head.
  for (int i = discs - 1; i >= 0; i--) {
    int bodies[2];
    torso_discBodies(torso, i, bodies);
    const std::string name = torso_discName(torso, i);
    const std::string lower = nameOf(torso, mjOBJ_BODY, bodies[0]);
    const int site = mj_name2id(torso, mjOBJ_SITE, (name + "_lower").c_str());
    discs_[i] = {bodies[0], bodies[1], site, 9.81 * (mass + ribcage * ribsAbove(lower) / kRibs)};
    mass += human->body_mass[mj_name2id(human, mjOBJ_BODY, lower.c_str())];
  }
}

void FollowerLoad::apply(const mjModel* torso, mjData* d, const Vector3d& up) const {
  mju_zero(d->xfrc_applied, 6 * torso->nbody);
  for (const Disc& disc : discs_) {
    const mjtNum* mat = d->site_xmat + 9 * disc.frame;
    const Vector3d axis(mat[2], mat[5], mat[8]);
    const Vector3d force = -disc.weight * up.dot(axis) * axis;
    const Eigen::Map<const Vector3d> centre(d->site_xpos + 3 * disc.frame);
    for (const int body : {disc.lower, disc.upper}) {
      const double sign = body == disc.upper ? 1 : -1;
      const Vector3d arm = centre - Eigen::Map<const Vector3d>(d->xipos + 3 * body);
      const Vector3d moment = sign * arm.cross(force);
      mjtNum* applied = d->xfrc_applied + 6 * body;
      for (int k = 0; k < 3; k++) {
        applied[k] += sign * force[k];
        applied[3 + k] += moment[k];
      }
    }
  }
}

}  // namespace torso::tools
