// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "model/disc_field.h"
#include "plugin/facet_collider.h"
#include "plugin/last_error.h"
#include "plugin/mujoco_torso.h"
#include "plugin/passive.h"
#include "plugin/registry.h"
#include "plugin/sensor.h"

namespace torso::plugin {
namespace {

int copyText(const std::string& text, char* buffer, int size) {
  if (buffer && size > 0) {
    const int n = std::min(static_cast<int>(text.size()), size - 1);
    std::memcpy(buffer, text.data(), n);
    buffer[n] = '\0';
  }
  return static_cast<int>(text.size());
}

// The model's instance, or null and a message.
const Instance* instanceOf(const mjModel* m) {
  if (!m) {
    last_error = "the model is null";
    return nullptr;
  }
  const Instance* instance = findInstance(m);
  if (!instance) {
    const char* fault = instanceFault(m);
    last_error = fault ? fault : "the model holds no torso (no numeric 'mujoco_torso')";
  }
  return instance;
}

bool inRange(int index, std::size_t count, const char* what) {
  if (index >= 0 && static_cast<std::size_t>(index) < count) return true;
  last_error = std::string(what) + " " + std::to_string(index) + " does not exist, there are " +
               std::to_string(count);
  return false;
}

const Instance* withDisc(const mjModel* m, int disc) {
  const Instance* instance = instanceOf(m);
  return instance && inRange(disc, instance->discs.size(), "disc") ? instance : nullptr;
}

const Instance* withFacet(const mjModel* m, int facet) {
  const Instance* instance = instanceOf(m);
  return instance && inRange(facet, instance->facets.size(), "facet") ? instance : nullptr;
}

template <typename Entry>
int indexOf(const std::vector<Entry>& entries, const char* name, const char* what) {
  for (std::size_t i = 0; name && i < entries.size(); i++) {
    if (entries[i].name == name) return static_cast<int>(i);
  }
  last_error = std::string("no ") + what + " is called '" + (name ? name : "(null)") + "'";
  return -1;
}

}  // namespace
}  // namespace torso::plugin

using namespace torso::plugin;

int torso_version(void) { return TORSO_VERSION; }
const char* torso_versionString(void) { return TORSO_VERSION_STRING; }

int torso_lastError(char* buf, int buf_sz) { return copyText(last_error, buf, buf_sz); }

int torso_info(const mjModel* m, torsoInfo* info, char* error, int error_sz) {
  copyText("", error, error_sz);
  if (m && !hasTorso(m)) return 0;
  const Instance* instance = instanceOf(m);
  if (!instance) {
    copyText(last_error, error, error_sz);
    return -1;
  }
  if (info) {
    info->ntorso = instance->torsos;
    info->ndisc = static_cast<int>(instance->discs.size());
    info->nligament = static_cast<int>(instance->ligaments.size());
    info->nligsegment = 0;
    for (const auto& ligament : instance->ligaments) {
      info->nligsegment += static_cast<int>(ligament.tendons.size());
    }
    info->nfacet = static_cast<int>(instance->facets.size());
    info->nfacetpoint = 4 * info->nfacet;
    info->nuserdata = instance->state.adr + instance->state.size;
  }
  return 1;
}

void torso_reset(const mjModel* m, mjData* d) {
  const Instance* instance = instanceOf(m);
  if (instance) mju_zero(d->userdata + instance->state.adr, instance->state.size);
}

int torso_discId(const mjModel* m, const char* name) {
  const Instance* instance = instanceOf(m);
  return instance ? indexOf(instance->discs, name, "disc") : -1;
}

const char* torso_discName(const mjModel* m, int disc) {
  const Instance* instance = withDisc(m, disc);
  return instance ? instance->discs[disc].name.c_str() : nullptr;
}

int torso_discBodies(const mjModel* m, int disc, int bodyid[2]) {
  const Instance* instance = withDisc(m, disc);
  if (!instance) return -1;
  bodyid[0] = instance->discs[disc].lower_body;
  bodyid[1] = instance->discs[disc].upper_body;
  return 0;
}

int torso_discSize(const mjModel* m, int disc, int* nnode, int* ntet) {
  const Instance* instance = withDisc(m, disc);
  if (!instance) return -1;
  const torso::DiscMesh& mesh = instance->batch->disc(disc).mesh;
  if (nnode) *nnode = static_cast<int>(mesh.rest_positions.size());
  if (ntet) *ntet = static_cast<int>(mesh.tets.size());
  return 0;
}

int torso_discTets(const mjModel* m, int disc, int* tet) {
  const Instance* instance = withDisc(m, disc);
  if (!instance) return -1;
  for (const auto& t : instance->batch->disc(disc).mesh.tets) {
    for (int node : t) *tet++ = node;
  }
  return 0;
}

int torso_discCells(const mjModel* m, int disc, int* cell) {
  const Instance* instance = withDisc(m, disc);
  if (!instance) return -1;
  const std::vector<int>& cells = instance->batch->disc(disc).mesh.cells;
  std::copy(cells.begin(), cells.end(), cell);
  return 0;
}

int torso_discRest(const mjModel* m, int disc, mjtNum* pos) {
  const Instance* instance = withDisc(m, disc);
  if (!instance) return -1;
  for (const Eigen::Vector3d& x : instance->batch->disc(disc).mesh.rest_positions) {
    mju_copy3(pos, x.data());
    pos += 3;
  }
  return 0;
}

int torso_discSkin(const mjModel* m, int disc) {
  const Instance* instance = withDisc(m, disc);
  if (!instance) return -1;
  const int tuple = instance->discs[disc].tuple, adr = m->tuple_adr[tuple];
  for (int i = adr; i < adr + m->tuple_size[tuple]; i++) {
    if (m->tuple_objtype[i] == mjOBJ_SKIN) return m->tuple_objid[i];
  }
  return -1;
}

int torso_discFrame(const mjModel* m, const mjData* d, int disc, mjtNum pos[3], mjtNum mat[9]) {
  const Instance* instance = withDisc(m, disc);
  if (!instance) return -1;
  const torso::DiscPose X = placeDisc(d, instance->discs[disc]).world;
  mju_copy3(pos, X.position.data());
  Eigen::Map<Eigen::Matrix<mjtNum, 3, 3, Eigen::RowMajor>> axes(mat);
  axes = X.rotation.toRotationMatrix();
  return 0;
}

int torso_discNodes(const mjModel* m, const mjData* d, int disc, mjtNum* xpos) {
  const Instance* instance = withDisc(m, disc);
  if (!instance) return -1;
  const DiscPlacement X = placeDisc(d, instance->discs[disc]);
  const mjtNum* shape = d->userdata + instance->state.adr + instance->state.pending;
  instance->batch->positions(disc, X.relative, shape, xpos);
  const int n = static_cast<int>(instance->batch->disc(disc).mesh.rest_positions.size());
  for (int i = 0; i < n; i++) {
    Eigen::Map<Eigen::Vector3d> x(xpos + 3 * i);
    x = X.world.position + X.world.rotation * Eigen::Vector3d(x);
  }
  return 0;
}

int torso_discStress(const mjModel* m, const mjData* d, int disc, mjtNum* stress, mjtNum* stretch) {
  const Instance* instance = withDisc(m, disc);
  if (!instance) return -1;
  const auto& [mesh, material] = instance->batch->disc(disc);
  std::vector<Eigen::Vector3d> x(mesh.rest_positions.size());
  torso_discNodes(m, d, disc, x[0].data());
  for (const torso::TetStress& tet : torso::discStress(mesh, material, x)) {
    if (stress) {
      mju_copy(stress, tet.cauchy.data(), 9);
      stress += 9;
    }
    if (stretch) {
      mju_copy(stretch, tet.fibre_stretch.data(), 2);
      stretch += 2;
    }
  }
  return 0;
}

int torso_discWrench(const mjModel* m, const mjData* d, int disc, mjtNum force[3], mjtNum moment[3],
                     mjtNum point[3]) {
  const Instance* instance = withDisc(m, disc);
  if (!instance) return -1;
  const mjtNum* result = discResult(d, *instance, disc);
  if (force) mju_copy3(force, result);
  if (moment) mju_copy3(moment, result + 3);
  if (point) mju_copy3(point, result + 6);
  return 0;
}

mjtNum torso_discPressure(const mjModel* m, const mjData* d, int disc) {
  const Instance* instance = withDisc(m, disc);
  return instance ? discResult(d, *instance, disc)[9] : 0;
}

mjtNum torso_discNucleusPressure(const mjModel* m, const mjData* d, int disc) {
  const Instance* instance = withDisc(m, disc);
  return instance ? discResult(d, *instance, disc)[10] : 0;
}

int torso_discThickness(const mjModel* m, const mjData* d, int disc, mjtNum ratio[3]) {
  const Instance* instance = withDisc(m, disc);
  if (!instance) return -1;
  const torso::DiscPose X = placeDisc(d, instance->discs[disc]).relative;
  const auto& rest = instance->batch->disc(disc).mesh.rest_positions;
  mjtNum least = mjMAXVAL, most = 0, now = 0, before = 0;
  for (const auto& [lower, upper] : instance->columns[disc]) {
    const mjtNum height = (X.position + X.rotation * rest[upper] - rest[lower]).z();
    const mjtNum rest_height = (rest[upper] - rest[lower]).z();
    least = std::min(least, height / rest_height);
    most = std::max(most, height / rest_height);
    now += height;
    before += rest_height;
  }
  ratio[0] = least;
  ratio[1] = now / before;
  ratio[2] = most;
  return 0;
}

int torso_facetId(const mjModel* m, const char* name) {
  const Instance* instance = instanceOf(m);
  return instance ? indexOf(instance->facets, name, "facet") : -1;
}

const char* torso_facetName(const mjModel* m, int facet) {
  const Instance* instance = withFacet(m, facet);
  return instance ? instance->facets[facet].name.c_str() : nullptr;
}

int torso_facetForce(const mjModel* m, const mjData* d, int facet, mjtNum force[3]) {
  const Instance* instance = withFacet(m, facet);
  if (!instance) return -1;
  facetForce(m, d, *instance, facet, force);
  return 0;
}

mjtNum torso_facetViolation(const mjModel* m, const mjData* d, int facet) {
  const Instance* instance = withFacet(m, facet);
  if (!instance) return 0;
  mjtNum most = 0;
  for (int point : instance->facets[facet].point_geoms) {
    most = std::max(most, pointGap(m, d, instance->facets[facet], point).violation);
  }
  return most;
}

mjtNum torso_ligamentTension(const mjModel*, const mjData* d, int tendonid) {
  return tendonTension(d, tendonid);
}
