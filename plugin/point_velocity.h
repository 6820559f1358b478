// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Core>

namespace torso::plugin {

// Velocity [m/s] of the point of a body that is at `point` in the world, from positions and qvel
// alone: d->cvel is still that of the step before while collisions and constraints are made.
inline Eigen::Vector3d pointVelocity(const mjModel* m, const mjData* d, int body,
                                     const mjtNum* point) {
  while (body && !m->body_dofnum[body]) body = m->body_parentid[body];
  Eigen::Vector3d angular = Eigen::Vector3d::Zero(), linear = Eigen::Vector3d::Zero();
  if (!body) return linear;
  const mjtNum* com = d->subtree_com + 3 * m->body_rootid[body];
  for (int i = m->body_dofadr[body] + m->body_dofnum[body] - 1; i >= 0; i = m->dof_parentid[i]) {
    const mjtNum* axis = d->cdof + 6 * i;
    angular += d->qvel[i] * Eigen::Vector3d(axis[0], axis[1], axis[2]);
    linear += d->qvel[i] * Eigen::Vector3d(axis[3], axis[4], axis[5]);
  }
  const Eigen::Vector3d offset(point[0] - com[0], point[1] - com[1], point[2] - com[2]);
  return linear + angular.cross(offset);
}

}  // namespace torso::plugin
