// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "plugin/instance.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "plugin/model_reader.h"
#include "plugin/note.h"

namespace torso::plugin {
namespace {

constexpr int kFormat = 2;  // of the torso data in a model

bool endsWith(const std::string& text, const char* end) {
  const std::size_t n = std::strlen(end);
  return text.size() >= n && text.compare(text.size() - n, n, end) == 0;
}

DiscMesh readMesh(const mjModel* m, int positions_id, int topology_id) {
  DiscMesh mesh;
  TextReader topology(m, topology_id);
  topology.expect("tets");
  const std::vector<int> tets = topology.integers();
  if (tets.empty() || tets.size() % 4) {
    fail(topology.where(),
         "tets has " + std::to_string(tets.size()) + " indices, which is not a multiple of 4");
  }
  for (std::size_t i = 0; i < tets.size(); i += 4) {
    mesh.tets.push_back({tets[i], tets[i + 1], tets[i + 2], tets[i + 3]});
  }
  topology.expect("lower");
  mesh.lower_nodes = topology.integers();
  topology.expect("upper");
  mesh.upper_nodes = topology.integers();
  topology.expect("cells");
  mesh.cells = topology.integers();
  topology.expect("hoops");
  const std::vector<int> hoops = topology.integers();
  if (hoops.size() % 2) {
    fail(topology.where(),
         "hoops has " + std::to_string(hoops.size()) + " indices, which is not a multiple of 2");
  }
  for (std::size_t i = 0; i < hoops.size(); i += 2) mesh.hoops.push_back({hoops[i], hoops[i + 1]});
  topology.finish();

  TextReader positions(m, positions_id);
  positions.expect("positions_mm");
  const std::vector<double> x = positions.numbers();
  positions.finish();
  if (x.empty() || x.size() % 3) {
    fail(positions.where(),
         "positions_mm has " + std::to_string(x.size()) + " numbers, which is not a multiple of 3");
  }
  for (std::size_t i = 0; i < x.size(); i += 3) {
    mesh.rest_positions.emplace_back(x[i] * 1e-3, x[i + 1] * 1e-3, x[i + 2] * 1e-3);
  }
  const std::string fault = checkDiscMesh(mesh);
  if (!fault.empty()) fail(positions.where(), fault);
  return mesh;
}

DiscPose siteFrame(const mjModel* m, int site) {
  const mjtNum *p = m->site_pos + 3 * site, *q = m->site_quat + 4 * site;
  DiscPose X;
  X.position = {p[0], p[1], p[2]};
  X.rotation = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized();
  return X;
}

// World pose of a body at qpos0.
DiscPose restFrame(const mjModel* m, int body) {
  DiscPose X;
  for (; body; body = m->body_parentid[body]) {
    const mjtNum *p = m->body_pos + 3 * body, *q = m->body_quat + 4 * body;
    const Eigen::Quaterniond rotation(q[0], q[1], q[2], q[3]);
    X.position = Eigen::Vector3d(p[0], p[1], p[2]) + rotation * X.position;
    X.rotation = rotation * X.rotation;
  }
  return X;
}

// World position of a geom's centre at qpos0.
Eigen::Vector3d restPosition(const mjModel* m, int geom) {
  const DiscPose X = restFrame(m, m->geom_bodyid[geom]);
  const mjtNum* p = m->geom_pos + 3 * geom;
  return X.position + X.rotation * Eigen::Vector3d(p[0], p[1], p[2]);
}

void checkWeld(const mjModel* m, const std::string& where, int equality) {
  if (m->eq_type[equality] != mjEQ_WELD) {
    fail(where, elementName(m, mjOBJ_EQUALITY, equality) + " must be a weld");
  }
}

}  // namespace

bool hasTorso(const mjModel* m) { return noteNumeric(m) >= 0; }

Instance::Instance(const mjModel* m) {
  weld_of_equality.assign(m->neq, -1);
  facet_of_geom.assign(m->ngeom, -1);
  sensor_of_tendon.resize(m->ntendon);
  is_ligament.assign(m->ntendon, 0);

  readHeaders(m);
  std::vector<DiscBatch::Disc> meshes;
  for (int i = 0; i < m->ntuple; i++) {
    // (prefix)KEY:NAME; the entry is called (prefix)NAME.
    const std::string full = nameOf(m, mjOBJ_TUPLE, i);
    const auto nameAfter = [&full](const char* key) -> std::string {
      const std::size_t at = full.find(key);
      if (at == std::string::npos) return "";
      return full.substr(0, at) + full.substr(at + std::strlen(key));
    };
    std::string name;
    if (!(name = nameAfter("disc:")).empty()) {
      addDisc(m, i, name, meshes);
    } else if (!(name = nameAfter("bushing:")).empty()) {
      addBushing(m, i);
    } else if (!(name = nameAfter("facet:")).empty()) {
      addFacet(m, i, name);
    } else if (!(name = nameAfter("ligament:")).empty()) {
      addLigament(m, i, name);
    }
  }
  if (discs.empty()) fail("custom", "no tuple 'disc:...' was found");

  batch = std::make_unique<DiscBatch>(meshes);
  boundWelds(m);
  findLevels(m);
  findSensors(m);
  findColumns();
  layOutState(m);
}

void Instance::readHeaders(const mjModel* m) {
  for (int i = 0; i < m->nnumeric; i++) {
    if (!endsWith(nameOf(m, mjOBJ_NUMERIC, i), kNoteName)) continue;
    const mjtNum* header = readNumeric(m, i, kNoteSize);
    if (header[0] != kFormat) {
      fail(elementName(m, mjOBJ_NUMERIC, i),
           "format " + std::to_string(static_cast<int>(header[0])) +
               " is not known to this version of the plugin, which reads format " +
               std::to_string(kFormat) + "; make the model anew with torso build or torso graft");
    }
    if (torsos++ == 0) state.adr = static_cast<int>(header[2]);
  }
}

void Instance::addDisc(const mjModel* m, int id, const std::string& name,
                       std::vector<DiscBatch::Disc>& meshes) {
  DiscEntry disc;
  disc.name = name;
  disc.tuple = id;
  TupleReader tuple(m, id);
  const int lower = tuple.take(mjOBJ_SITE), upper = tuple.take(mjOBJ_SITE);
  disc.lower_body = m->site_bodyid[lower];
  disc.upper_body = m->site_bodyid[upper];
  if (disc.lower_body == disc.upper_body) {
    fail(tuple.where(), "both sites are on one body; a disc lies between two");
  }
  disc.lower_frame = siteFrame(m, lower);
  disc.upper_frame = siteFrame(m, upper);
  WeldEntry weld = {};
  weld.equality = tuple.take(mjOBJ_EQUALITY);
  checkWeld(m, tuple.where(), weld.equality);
  const int numeric = tuple.take(mjOBJ_NUMERIC);
  const mjtNum* material = readNumeric(m, numeric, 8);
  DiscBatch::Disc batch_disc;
  batch_disc.material = {material[0], material[1], material[2], material[3],
                         material[4], material[5], material[6]};
  const std::string fault = checkDiscMaterial(batch_disc.material);
  if (!fault.empty()) {
    fail(elementName(m, mjOBJ_NUMERIC, numeric), fault);
  }
  if (material[7] < 0) {
    fail(elementName(m, mjOBJ_NUMERIC, numeric), "the retardation time is negative");
  }
  disc.retardation_time = material[7];
  const int positions = tuple.take(mjOBJ_TEXT), topology = tuple.take(mjOBJ_TEXT);
  batch_disc.mesh = readMesh(m, positions, topology);
  meshes.push_back(std::move(batch_disc));
  weld.disc = static_cast<int>(discs.size());
  weld_of_equality[weld.equality] = static_cast<int>(welds.size());
  welds.push_back(weld);
  discs.push_back(disc);
}

void Instance::addBushing(const mjModel* m, int id) {
  TupleReader tuple(m, id);
  WeldEntry weld = {};
  weld.disc = -1;
  weld.equality = tuple.take(mjOBJ_EQUALITY);
  checkWeld(m, tuple.where(), weld.equality);
  const mjtNum* k = readNumeric(m, tuple.take(mjOBJ_NUMERIC), 4);
  weld.stiffness[0] = k[0];
  weld.damping[0] = k[1];
  weld.stiffness[1] = k[2];
  weld.damping[1] = k[3];
  weld_of_equality[weld.equality] = static_cast<int>(welds.size());
  welds.push_back(weld);
}

void Instance::addFacet(const mjModel* m, int id, const std::string& name) {
  FacetEntry facet;
  facet.name = name;
  TupleReader tuple(m, id);
  facet.ellipsoid_geom = tuple.take(mjOBJ_GEOM, &facet.band);
  if (m->geom_type[facet.ellipsoid_geom] != mjGEOM_ELLIPSOID) {
    fail(tuple.where(), "its first geom must be an ellipsoid");
  }
  if (!(facet.band > 0 && facet.band < 1)) {
    fail(tuple.where(), "the band (prm of the ellipsoid) must lie between 0 and 1");
  }
  const int index = static_cast<int>(facets.size());
  facet_of_geom[facet.ellipsoid_geom] = index;
  for (int& point : facet.point_geoms) {
    point = tuple.take(mjOBJ_GEOM);
    if (m->geom_type[point] != mjGEOM_SPHERE) {
      fail(tuple.where(), elementName(m, mjOBJ_GEOM, point) + " must be a sphere");
    }
    facet_of_geom[point] = index;
  }
  const mjtNum* q = m->geom_quat + 4 * facet.ellipsoid_geom;
  const Eigen::Quaterniond to_ellipsoid =
      (restFrame(m, m->geom_bodyid[facet.ellipsoid_geom]).rotation *
       Eigen::Quaterniond(q[0], q[1], q[2], q[3]))
          .conjugate();
  for (int k = 0; k < 4; k++) {
    facet.rest[k] = to_ellipsoid *
                    (restPosition(m, facet.point_geoms[k]) - restPosition(m, facet.ellipsoid_geom));
  }
  facets.push_back(facet);
}

void Instance::addLigament(const mjModel* m, int id, const std::string& name) {
  Ligament ligament;
  ligament.name = name;
  TupleReader tuple(m, id);
  while (!tuple.done()) {
    const int tendon = tuple.take(mjOBJ_TENDON);
    const int adr = m->tendon_adr[tendon];
    if (m->tendon_num[tendon] != 2 || m->wrap_type[adr] != mjWRAP_SITE ||
        m->wrap_type[adr + 1] != mjWRAP_SITE) {
      fail(tuple.where(),
           elementName(m, mjOBJ_TENDON, tendon) + " must run straight between two sites");
    }
    ligament.tendons.push_back(tendon);
    is_ligament[tendon] = 1;
  }
  ligaments.push_back(ligament);
}

// Bound and viscosity of a disc's rows come from its stiffness near rest. The rows' axes are those
// of the world (translation) and of the lower body (rotation); the largest stiffness bounds them
// all.
void Instance::boundWelds(const mjModel* m) {
  for (WeldEntry& weld : welds) {
    if (weld.disc < 0) continue;
    const auto& K = batch->boundStiffness(weld.disc);
    weld.bound[0] = K.diagonal().head<3>().maxCoeff();
    // Ligaments and facets pull at this lever; as their directions turn with the bones, they add a
    // rotational stiffness that explicit steps of 5 ms do not bear. Bounded by the disc's own.
    constexpr double kLever = 0.015;
    weld.bound[1] = std::max(K.diagonal().tail<3>().maxCoeff(), kLever * kLever * weld.bound[0]);
    for (int k = 0; k < 2; k++) weld.damping[k] = discs[weld.disc].retardation_time * weld.bound[k];
    const DiscEntry& disc = discs[weld.disc];
    for (int i = 0; i < m->nu; i++) {
      if (m->actuator_trntype[i] != mjTRN_SITE) continue;
      const int site = m->actuator_trnid[2 * i], ref = m->actuator_trnid[2 * i + 1];
      if (ref < 0) continue;
      // Servos' sites are on bodies that are fixed to the bones.
      const int bone = m->body_weldid[m->site_bodyid[site]];
      const int ref_bone = m->body_weldid[m->site_bodyid[ref]];
      const int upper = m->body_weldid[disc.upper_body], lower = m->body_weldid[disc.lower_body];
      if ((bone == upper && ref_bone == lower) || (bone == lower && ref_bone == upper)) {
        weld.servos.push_back(i);
      }
    }
  }
}

void Instance::findLevels(const mjModel* m) {
  levels.resize(discs.size());
  for (std::size_t i = 0; i < discs.size(); i++) {
    // A bone is all that is fixed to it: the geoms of facets are on bodies of their own, and a
    // pelvis may be fixed to the world.
    const auto bone = [&](int body) { return m->body_weldid[body]; };
    const int lower = bone(discs[i].lower_body), upper = bone(discs[i].upper_body);
    const auto between = [&](int a, int b) {
      return (bone(a) == lower && bone(b) == upper) || (bone(a) == upper && bone(b) == lower);
    };
    for (const Ligament& ligament : ligaments) {
      for (int tendon : ligament.tendons) {
        const int adr = m->tendon_adr[tendon];
        if (between(m->site_bodyid[m->wrap_objid[adr]], m->site_bodyid[m->wrap_objid[adr + 1]])) {
          levels[i].tendons.push_back(tendon);
        }
      }
    }
    for (std::size_t f = 0; f < facets.size(); f++) {
      if (between(m->geom_bodyid[facets[f].ellipsoid_geom],
                  m->geom_bodyid[facets[f].point_geoms[0]])) {
        levels[i].facets.push_back(static_cast<int>(f));
      }
    }
  }
}

void Instance::findSensors(const mjModel* m) {
  for (int i = 0; i < m->nsensor; i++) {
    if (m->sensor_type[i] != mjSENS_USER || m->sensor_objtype[i] != mjOBJ_TUPLE) continue;
    for (std::size_t k = 0; k < discs.size(); k++) {
      if (discs[k].tuple != m->sensor_objid[i]) continue;
      const int what =
          m->nuser_sensor > 0 ? static_cast<int>(m->sensor_user[m->nuser_sensor * i]) : -1;
      const int dim[] = {3,
                         3,
                         1,
                         static_cast<int>(levels[k].tendons.size()),
                         static_cast<int>(levels[k].facets.size()),
                         1};
      const std::string where = elementName(m, mjOBJ_SENSOR, i);
      if (what < 0 || what > 5) {
        fail(where,
             "user[0] must be 0 force, 1 moment, 2 pressure, 3 ligament, 4 facet or 5 nucleus "
             "pressure");
      }
      if (m->sensor_dim[i] != dim[what]) {
        fail(where, "dim is " + std::to_string(m->sensor_dim[i]) + ", it must be " +
                        std::to_string(dim[what]));
      }
      sensors.push_back({i, static_cast<int>(k), what});
      if (what != 3) continue;
      for (std::size_t entry = 0; entry < levels[k].tendons.size(); entry++) {
        sensor_of_tendon[levels[k].tendons[entry]] = {i, static_cast<int>(entry)};
      }
    }
  }
}

void Instance::findColumns() {
  for (int i = 0; i < batch->size(); i++) {
    const DiscMesh& mesh = batch->disc(i).mesh;
    const auto& x = mesh.rest_positions;
    columns.emplace_back();
    for (int upper : mesh.upper_nodes) {
      int nearest = mesh.lower_nodes.front();
      for (int lower : mesh.lower_nodes) {
        const auto distance = [&](int node) { return (x[node] - x[upper]).head<2>().norm(); };
        if (distance(lower) < distance(nearest)) nearest = lower;
      }
      columns.back().push_back({nearest, upper});
    }
  }
}

void Instance::layOutState(const mjModel* m) {
  const int n = batch->stateSize(), nd = static_cast<int>(discs.size());
  state.pending = state.committed + n;
  state.result = state.pending + n;
  state.size = state.result + nd * StateLayout::kResult;
  if (state.adr < 0 || state.adr + state.size > m->nuserdata) {
    fail("size", "nuserdata is " + std::to_string(m->nuserdata) + ", the " + std::to_string(nd) +
                     " discs need " + std::to_string(state.adr + state.size) +
                     "; set <size nuserdata=\"" + std::to_string(state.adr + state.size) + "\"/>");
  }
  // Poses and wrenches of one evaluation, the solver's scratch, and room to align it.
  scratch_entries = static_cast<int>(
      (nd * (sizeof(DiscPose) + sizeof(DiscWrench)) + batch->scratchSize() + 256) / sizeof(mjtNum));
}

}  // namespace torso::plugin
