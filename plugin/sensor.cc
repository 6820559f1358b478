// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "plugin/sensor.h"

namespace torso::plugin {
namespace {

// As facetForce, of all facets in one pass over the contacts (nfacet x 3).
void facetForces(const mjData* d, const Instance& instance, mjtNum* force) {
  mju_zero(force, 3 * static_cast<int>(instance.facets.size()));
  for (int i = 0; i < d->ncon; i++) {
    const mjContact& con = d->contact[i];
    const int facet = instance.facet_of_geom[con.geom2];
    if (facet < 0 || facet != instance.facet_of_geom[con.geom1] || con.efc_address < 0) continue;
    mju_addToScl3(force + 3 * facet, con.frame, -d->efc_force[con.efc_address]);
  }
}

}  // namespace

const mjtNum* discResult(const mjData* d, const Instance& instance, int disc) {
  return d->userdata + instance.state.adr + instance.state.result + StateLayout::kResult * disc;
}

mjtNum tendonTension(const mjData* d, int tendon) {
  for (int i = d->ne + d->nf; i < d->nefc; i++) {
    if (d->efc_type[i] == mjCNSTR_LIMIT_TENDON && d->efc_id[i] == tendon) return d->efc_force[i];
  }
  return 0;
}

void facetForce(const mjModel*, const mjData* d, const Instance& instance, int facet,
                mjtNum force[3]) {
  mju_zero3(force);
  const int ellipsoid = instance.facets[facet].ellipsoid_geom;
  for (int i = 0; i < d->ncon; i++) {
    const mjContact& con = d->contact[i];
    if (con.geom2 != ellipsoid || con.efc_address < 0) continue;
    if (instance.facet_of_geom[con.geom1] != facet) continue;
    mju_addToScl3(force, con.frame, -d->efc_force[con.efc_address]);
  }
}

void fillSensors(const mjModel* m, mjData* d, const Instance& instance, int stage) {
  const int mark = d->pstack, nfacet = static_cast<int>(instance.facets.size());
  mjtNum* facet_force = mj_stackAlloc(d, 3 * nfacet);
  facetForces(d, instance, facet_force);
  for (const Sensor& sensor : instance.sensors) {
    if (m->sensor_needstage[sensor.id] != stage) continue;
    mjtNum* out = d->sensordata + m->sensor_adr[sensor.id];
    const mjtNum* result = discResult(d, instance, sensor.disc);
    const Level& level = instance.levels[sensor.disc];
    switch (sensor.what) {
      case 0:
        mju_copy3(out, result);
        break;
      case 1:
        mju_copy3(out, result + 3);
        break;
      case 2:
        *out = result[9];
        break;
      case 5:
        *out = result[10];
        break;
      case 3:
        mju_zero(out, static_cast<int>(level.tendons.size()));
        break;
      default:
        for (std::size_t k = 0; k < level.facets.size(); k++) {
          out[k] = mju_norm3(facet_force + 3 * level.facets[k]);
        }
    }
  }
  d->pstack = mark;
  // Ligament tensions in one pass over the limit rows.
  for (int i = d->ne + d->nf; i < d->nefc; i++) {
    if (d->efc_type[i] != mjCNSTR_LIMIT_TENDON) continue;
    const TendonSensor& slot = instance.sensor_of_tendon[d->efc_id[i]];
    if (slot.sensor < 0 || m->sensor_needstage[slot.sensor] != stage) continue;
    d->sensordata[m->sensor_adr[slot.sensor] + slot.entry] = d->efc_force[i];
  }
}

}  // namespace torso::plugin
