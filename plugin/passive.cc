// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "plugin/passive.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <new>

#include "plugin/facet_collider.h"
#include "plugin/limit.h"
#include "plugin/point_velocity.h"

namespace torso::plugin {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

DiscPose worldFrame(const mjData* d, int body, const DiscPose& local) {
  const mjtNum *p = d->xpos + 3 * body, *q = d->xquat + 4 * body;
  const Quaterniond rotation(q[0], q[1], q[2], q[3]);
  DiscPose X;
  X.position = Vector3d(p[0], p[1], p[2]) + rotation * local.position;
  X.rotation = rotation * local.rotation;
  return X;
}

// qfrc += J' (force, moment at point), as mj_applyFT, but only along the body's own chain of dofs.
void addWrench(const mjModel* m, const mjData* d, int body, const Vector3d& force,
               const Vector3d& moment, const Vector3d& point, mjtNum* qfrc) {
  while (body && !m->body_dofnum[body]) body = m->body_parentid[body];
  if (!body) return;
  const mjtNum* com = d->subtree_com + 3 * m->body_rootid[body];
  const Vector3d about_com = moment + (point - Vector3d(com[0], com[1], com[2])).cross(force);
  for (int i = m->body_dofadr[body] + m->body_dofnum[body] - 1; i >= 0; i = m->dof_parentid[i]) {
    const mjtNum* axis = d->cdof + 6 * i;
    qfrc[i] += axis[0] * about_com[0] + axis[1] * about_com[1] + axis[2] * about_com[2] +
               axis[3] * force[0] + axis[4] * force[1] + axis[5] * force[2];
  }
}

// Stiffest gains of the servos between a disc's bones, as they are now; none while actuation is
// off. kp: the actuator's own; kv: bias parameter 3, which MuJoCo leaves to us (see writeActuators
// in tools/torso_mjcf.cc).
void servoGains(const mjModel* m, const WeldEntry& weld, double* kp, double* kv) {
  *kp = *kv = 0;
  if (m->opt.disableflags & mjDSBL_ACTUATION) return;
  for (int i : weld.servos) {
    if (m->actuator_biastype[i] != mjBIAS_AFFINE) continue;
    const mjtNum* bias = m->actuator_biasprm + mjNBIAS * i;
    const mjtNum* gear = m->actuator_gear + 6 * i + 3;
    const double gear2 = gear[0] * gear[0] + gear[1] * gear[1] + gear[2] * gear[2];
    *kp = std::max(*kp, -bias[1] * gear2);
    *kv = std::max(*kv, -bias[3] * gear2);
  }
}

// Length of a ligament segment after one step at the present velocities.
double lengthAhead(const mjModel* m, const mjData* d, int tendon) {
  const int* sites = m->wrap_objid + m->tendon_adr[tendon];
  const mjtNum *a = d->site_xpos + 3 * sites[0], *b = d->site_xpos + 3 * sites[1];
  const Vector3d velocity = pointVelocity(m, d, m->site_bodyid[sites[1]], b) -
                            pointVelocity(m, d, m->site_bodyid[sites[0]], a);
  return (Vector3d(b[0] - a[0], b[1] - a[1], b[2] - a[2]) + m->opt.timestep * velocity).norm();
}

// Fingerprint of the discs' poses that a double holds exactly.
double poseKey(const DiscPose* poses, int n) {
  std::uint64_t hash = 14695981039346656037ull;
  const auto add = [&hash](const double* x, int count) {
    for (int i = 0; i < count; i++) {
      std::uint64_t bits;
      std::memcpy(&bits, x + i, sizeof bits);
      hash = (hash ^ bits) * 1099511628211ull;
      hash ^= hash >> 32;
    }
  };
  for (int i = 0; i < n; i++) {
    add(poses[i].position.data(), 3);
    add(poses[i].rotation.coeffs().data(), 4);
  }
  return static_cast<double>(hash >> 11);
}

// Adds a value to column `dof` of three neighbouring rows of the constraint Jacobian that have the
// same columns.
void addToRows(const mjModel* m, mjData* d, int first_row, int dof, const mjtNum value[3]) {
  if (!mj_isSparse(m)) {
    for (int k = 0; k < 3; k++) d->efc_J[m->nv * (first_row + k) + dof] += value[k];
    return;
  }
  const int* columns = d->efc_J_colind + d->efc_J_rowadr[first_row];
  const int* end = columns + d->efc_J_rownnz[first_row];
  const int* column = std::lower_bound(columns, end, dof);
  if (column == end || *column != dof) return;  // a dof that moves both bodies alike
  for (int k = 0; k < 3; k++)
    d->efc_J[d->efc_J_rowadr[first_row + k] + (column - columns)] += value[k];
}

// Copies three such rows of the sparse Jacobian into its transpose.
void transposeRows(mjData* d, int first_row) {
  const int *columns = d->efc_J_colind + d->efc_J_rowadr[first_row],
            *adr = d->efc_J_rowadr + first_row;
  for (int i = 0; i < d->efc_J_rownnz[first_row]; i++) {
    const int dof = columns[i];
    // In the transpose the three entries stand side by side.
    const int* rows = d->efc_JT_colind + d->efc_JT_rowadr[dof];
    const int* row = std::lower_bound(rows, rows + d->efc_JT_rownnz[dof], first_row);
    mjtNum* entry = d->efc_JT + d->efc_JT_rowadr[dof] + (row - rows);
    for (int k = 0; k < 3; k++) entry[k] = d->efc_J[adr[k] + i];
  }
}

// Takes the Jacobian of a weld's three translational rows at one common point of its two bodies,
// body2's anchor, instead of at the two anchors. Those part as the disc deforms, and opposite
// forces at two places would turn the body. The entries are made anew, not corrected: this may run
// again on the same rows (finite differences).
void useCommonPoint(const mjModel* m, mjData* d, int equality, int first_row) {
  const int bodies[2] = {m->eq_obj1id[equality], m->eq_obj2id[equality]};
  mjtNum point[3];
  mju_rotVecMat(point, m->eq_data + mjNEQDATA * equality, d->xmat + 9 * bodies[1]);
  mju_addTo3(point, d->xpos + 3 * bodies[1]);
  const bool sparse = mj_isSparse(m);
  for (int row = first_row; row < first_row + 3; row++) {
    mju_zero(d->efc_J + (sparse ? d->efc_J_rowadr[row] : m->nv * row),
             sparse ? d->efc_J_rownnz[row] : m->nv);
  }
  for (int side : {0, 1}) {
    int body = bodies[side];
    while (body && !m->body_dofnum[body]) body = m->body_parentid[body];
    if (!body) continue;
    mjtNum offset[3];
    mju_sub3(offset, point, d->subtree_com + 3 * m->body_rootid[body]);
    for (int i = m->body_dofadr[body] + m->body_dofnum[body] - 1; i >= 0; i = m->dof_parentid[i]) {
      mjtNum velocity[3];
      mju_cross(velocity, d->cdof + 6 * i, offset);
      mju_addTo3(velocity, d->cdof + 6 * i + 3);
      if (side) mju_scl3(velocity, velocity, -1);
      addToRows(m, d, first_row, i, velocity);
    }
  }
  if (sparse) transposeRows(d, first_row);
}

}  // namespace

DiscPlacement placeDisc(const mjData* d, const DiscEntry& disc) {
  DiscPlacement X;
  X.world = worldFrame(d, disc.lower_body, disc.lower_frame);
  const DiscPose upper = worldFrame(d, disc.upper_body, disc.upper_frame);
  const Quaterniond to_lower = X.world.rotation.conjugate();
  X.relative.position = to_lower * (upper.position - X.world.position);
  X.relative.rotation = (to_lower * upper.rotation).normalized();
  if (X.relative.rotation.w() < 0) X.relative.rotation.coeffs() *= -1;
  return X;
}

void applyDiscs(const mjModel* m, mjData* d, const Instance& instance) {
  const StateLayout& layout = instance.state;
  mjtNum* state = d->userdata + layout.adr;
  const int nd = instance.batch->size(), n = instance.batch->stateSize();
  const int mark = d->pstack;
  auto address = reinterpret_cast<std::uintptr_t>(mj_stackAlloc(d, instance.scratch_entries));
  address = (address + 63) & ~std::uintptr_t{63};
  auto* poses = reinterpret_cast<DiscPose*>(address);
  address = (address + nd * sizeof(DiscPose) + 63) & ~std::uintptr_t{63};
  auto* wrenches = reinterpret_cast<DiscWrench*>(address);
  address = (address + nd * sizeof(DiscWrench) + 63) & ~std::uintptr_t{63};

  for (int i = 0; i < nd; i++) {
    new (poses + i) DiscPose(placeDisc(d, instance.discs[i]).relative);
    new (wrenches + i) DiscWrench();
  }
  const double key = poseKey(poses, nd);
  if (state[layout.valid] != 0 && state[layout.time] != d->time && state[layout.poses] != key) {
    mju_copy(state + layout.committed, state + layout.pending, n);
  }
  instance.batch->evaluate(poses, state + layout.committed, state + layout.pending, wrenches,
                           reinterpret_cast<void*>(address), DiscBatch::Options());

  for (int i = 0; i < nd; i++) {
    const DiscEntry& disc = instance.discs[i];
    const DiscPose X = worldFrame(d, disc.lower_body, disc.lower_frame);
    const Vector3d force = X.rotation * wrenches[i].force;
    const Vector3d moment = X.rotation * wrenches[i].moment;
    addWrench(m, d, disc.upper_body, force, moment, X.position, d->qfrc_passive);
    addWrench(m, d, disc.lower_body, -force, -moment, X.position, d->qfrc_passive);
    mjtNum* result = state + layout.result + StateLayout::kResult * i;
    mju_copy3(result, force.data());
    mju_copy3(result + 3, moment.data());
    mju_copy3(result + 6, X.position.data());
    result[9] = wrenches[i].pressure;
    result[10] = wrenches[i].nucleus_pressure;
  }
  d->pstack = mark;
  state[layout.time] = d->time;
  state[layout.poses] = key;
  state[layout.valid] = 1;
}

// The row's force should be that of a linearly implicit step,
//   f = -k x - W v',  W = h (k + bound + kp) + c + kv,
// with v' the velocity at the end of the step: spring and damper of the bushing, damping of the
// servos, and the first-order change over the step of the forces that act beside the row (finite
// elements: bound, servos: kp). MuJoCo solves f = -D (J a - aref), aref = -B J v - K I pos, which
// is this force with D = h W, B = 1 / h, K I = k / (h W). A weld's rotational rows hold s =
// torquescale / 2 times the relative angular velocity, and as position the vector part of a
// quaternion, half the angle.
void rewriteWelds(const mjModel* m, mjData* d, const Instance& instance) {
  const double h = m->opt.timestep;
  for (int row = 0; row < d->ne;) {
    const int equality = d->efc_id[row];
    const int index = instance.weld_of_equality[equality];
    if (index < 0) {
      row++;
      continue;
    }
    const WeldEntry& weld = instance.welds[index];
    double kp, kv;
    servoGains(m, weld, &kp, &kv);
    useCommonPoint(m, d, equality, row);
    for (int k = 0; k < 6; k++, row++) {
      const bool rotation = k >= 3;
      const double s = rotation ? 0.5 * m->eq_data[mjNEQDATA * equality + 10] : 1;
      const double half = rotation ? 0.5 : 1;
      const double spring = weld.stiffness[rotation];
      double W = h * (spring + weld.bound[rotation]) + weld.damping[rotation];
      if (rotation) W += h * kp + kv;
      W = std::max(W, 1e-12);
      d->efc_R[row] = std::max(s * s / (h * W), mjMINVAL);
      d->efc_D[row] = 1 / d->efc_R[row];
      d->efc_KBIP[4 * row] = spring * s / (half * h * W);
      d->efc_KBIP[4 * row + 1] = 1 / h;
      d->efc_KBIP[4 * row + 2] = 1;
    }
  }
}

void rewriteLimits(const mjModel* m, mjData* d, const Instance& instance) {
  constexpr double kSoftness = 0.001;  // R over the row's own inverse inertia
  const double h = m->opt.timestep;
  for (int row = d->ne + d->nf; row < d->nefc; row++) {
    const int id = d->efc_id[row];
    if (d->efc_type[row] == mjCNSTR_LIMIT_TENDON) {
      if (!instance.is_ligament[id]) continue;
      const double limit = m->tendon_range[2 * id + 1];
      d->efc_pos[row] = limitGap(limit - d->ten_length[id], limit - lengthAhead(m, d, id));
    } else if (d->efc_type[row] == mjCNSTR_CONTACT_FRICTIONLESS) {
      const mjContact& con = d->contact[id];
      const int facet = instance.facet_of_geom[con.geom2];
      if (facet < 0 || facet != instance.facet_of_geom[con.geom1]) continue;
      d->efc_pos[row] = facetLimitGap(m, d, instance.facets[facet], con.geom1);
    } else {
      continue;
    }
    d->efc_margin[row] = 0;
    d->efc_R[row] = std::max(kSoftness * d->efc_diagApprox[row], mjMINVAL);
    d->efc_D[row] = 1 / d->efc_R[row];
    // aref = -B v - K I (pos - margin)
    d->efc_KBIP[4 * row] = 1 / (h * h);
    d->efc_KBIP[4 * row + 1] = 0;
    d->efc_KBIP[4 * row + 2] = 1;
  }
}

}  // namespace torso::plugin
