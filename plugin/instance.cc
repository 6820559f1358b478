// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "plugin/instance.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include "plugin/note.h"

namespace torso::plugin {
namespace {

const char* nameOf(const mjModel* m, int type, int id) {
  const char* name = mj_id2name(m, type, id);
  return name ? name : "";
}

bool endsWith(const std::string& text, const char* end) {
  const std::size_t n = std::strlen(end);
  return text.size() >= n && text.compare(text.size() - n, n, end) == 0;
}

[[noreturn]] void fail(const std::string& where, const std::string& what) {
  throw std::runtime_error("torso data, " + where + ": " + what);
}

// One tuple read front to back.
class TupleReader {
 public:
  TupleReader(const mjModel* m, int id) : m_(m), id_(id) {}
  std::string where() const { return std::string("tuple '") + nameOf(m_, mjOBJ_TUPLE, id_) + "'"; }
  bool done() const { return next_ >= m_->tuple_size[id_]; }
  // Id of the next element, which must have this type.
  int take(int type, double* prm = nullptr) {
    if (done()) {
      fail(where(), std::string("it ends where a ") + mju_type2Str(type) +
                        " must follow; run `torso build` or `torso graft` again");
    }
    const int adr = m_->tuple_adr[id_] + next_++;
    if (m_->tuple_objtype[adr] != type) {
      fail(where(), "element " + std::to_string(next_) + " is a " +
                        mju_type2Str(m_->tuple_objtype[adr]) + ", it must be a " +
                        mju_type2Str(type));
    }
    if (prm) *prm = m_->tuple_objprm[adr];
    return m_->tuple_objid[adr];
  }

 private:
  const mjModel* m_;
  int id_, next_ = 0;
};

// Numbers of a numeric; all must be finite.
const mjtNum* readNumeric(const mjModel* m, int id, int size) {
  const std::string where = std::string("numeric '") + nameOf(m, mjOBJ_NUMERIC, id) + "'";
  if (m->numeric_size[id] != size) {
    fail(where, "it holds " + std::to_string(m->numeric_size[id]) + " numbers, it must hold " +
                    std::to_string(size));
  }
  const mjtNum* data = m->numeric_data + m->numeric_adr[id];
  for (int i = 0; i < size; i++) {
    if (!std::isfinite(data[i])) fail(where, "number " + std::to_string(i) + " is not finite");
  }
  return data;
}

// Words of a text. Words that do not start like a number are keys.
class TextReader {
 public:
  TextReader(const mjModel* m, int id)
      : where_(std::string("text '") + nameOf(m, mjOBJ_TEXT, id) + "'"),
        next_(m->text_data + m->text_adr[id]) {}
  const std::string& where() const { return where_; }

  void expect(const char* key) {
    skip();
    const std::size_t n = std::strlen(key);
    if (std::strncmp(next_, key, n) != 0 || (next_[n] != ' ' && next_[n] != '\0')) {
      fail(where_, std::string("'") + key + "' is missing");
    }
    next_ += n;
  }
  // Numbers up to the next key or the end.
  std::vector<double> numbers() {
    std::vector<double> values;
    for (;;) {
      skip();
      char* end = nullptr;
      const double value = std::strtod(next_, &end);
      if (end == next_) return values;
      if (!std::isfinite(value)) {
        fail(where_, "number " + std::to_string(values.size()) + " is not finite");
      }
      next_ = end;
      values.push_back(value);
    }
  }
  std::vector<int> integers() {
    std::vector<int> values;
    for (double v : numbers()) {
      if (v != std::floor(v) || std::abs(v) > 1e9) fail(where_, "a node index is not an integer");
      values.push_back(static_cast<int>(v));
    }
    return values;
  }
  void finish() {
    skip();
    if (*next_) fail(where_, std::string("unexpected '") + std::string(next_).substr(0, 20) + "'");
  }

 private:
  void skip() {
    while (*next_ == ' ' || *next_ == '\n' || *next_ == '\t' || *next_ == '\r') next_++;
  }
  std::string where_;
  const char* next_;
};

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
    fail(where,
         std::string("equality '") + nameOf(m, mjOBJ_EQUALITY, equality) + "' must be a weld");
  }
}

}  // namespace

bool hasTorso(const mjModel* m) { return noteNumeric(m) >= 0; }

Instance::Instance(const mjModel* m) {
  std::vector<DiscBatch::Disc> batch_discs;
  weld_of_equality.assign(m->neq, -1);
  facet_of_geom.assign(m->ngeom, -1);
  sensor_of_tendon.resize(m->ntendon);
  is_ligament.assign(m->ntendon, 0);

  for (int i = 0; i < m->nnumeric; i++) {
    if (!endsWith(nameOf(m, mjOBJ_NUMERIC, i), kNoteName)) continue;
    const mjtNum* header = readNumeric(m, i, kNoteSize);
    if (header[0] != 1) {
      fail(std::string("numeric '") + nameOf(m, mjOBJ_NUMERIC, i) + "'",
           "format " + std::to_string(static_cast<int>(header[0])) +
               " is not known to this version of the plugin, which reads format 1");
    }
    if (torsos++ == 0) state.adr = static_cast<int>(header[2]);
  }

  for (int i = 0; i < m->ntuple; i++) {
    const std::string full = nameOf(m, mjOBJ_TUPLE, i);
    const auto nameAfter = [&](const char* key) -> std::string {
      const std::size_t at = full.find(key);
      if (at == std::string::npos) return "";
      return full.substr(0, at) + full.substr(at + std::strlen(key));
    };
    TupleReader tuple(m, i);
    std::string name;
    if (!(name = nameAfter("disc:")).empty()) {
      DiscEntry disc;
      disc.name = name;
      disc.tuple = i;
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
      const mjtNum* material = readNumeric(m, numeric, 3);
      DiscBatch::Disc batch_disc;
      batch_disc.material = {material[0], material[1]};
      const std::string fault = checkDiscMaterial(batch_disc.material);
      if (!fault.empty()) {
        fail(std::string("numeric '") + nameOf(m, mjOBJ_NUMERIC, numeric) + "'", fault);
      }
      if (material[2] < 0) {
        fail(std::string("numeric '") + nameOf(m, mjOBJ_NUMERIC, numeric) + "'",
             "the retardation time is negative");
      }
      disc.retardation_time = material[2];
      const int positions = tuple.take(mjOBJ_TEXT), topology = tuple.take(mjOBJ_TEXT);
      batch_disc.mesh = readMesh(m, positions, topology);
      batch_discs.push_back(std::move(batch_disc));
      weld.disc = static_cast<int>(discs.size());
      weld_of_equality[weld.equality] = static_cast<int>(welds.size());
      welds.push_back(weld);
      discs.push_back(disc);
    } else if (!(name = nameAfter("bushing:")).empty()) {
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
    } else if (!(name = nameAfter("facet:")).empty()) {
      FacetEntry facet;
      facet.name = name;
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
          fail(tuple.where(),
               std::string("geom '") + nameOf(m, mjOBJ_GEOM, point) + "' must be a sphere");
        }
        facet_of_geom[point] = index;
      }
      const mjtNum* q = m->geom_quat + 4 * facet.ellipsoid_geom;
      const Eigen::Quaterniond to_ellipsoid =
          (restFrame(m, m->geom_bodyid[facet.ellipsoid_geom]).rotation *
           Eigen::Quaterniond(q[0], q[1], q[2], q[3]))
              .conjugate();
      for (int k = 0; k < 4; k++) {
        facet.rest[k] = to_ellipsoid * (restPosition(m, facet.point_geoms[k]) -
                                        restPosition(m, facet.ellipsoid_geom));
      }
      facets.push_back(facet);
    } else if (!(name = nameAfter("ligament:")).empty()) {
      Ligament ligament;
      ligament.name = name;
      while (!tuple.done()) {
        const int tendon = tuple.take(mjOBJ_TENDON);
        const int adr = m->tendon_adr[tendon];
        if (m->tendon_num[tendon] != 2 || m->wrap_type[adr] != mjWRAP_SITE ||
            m->wrap_type[adr + 1] != mjWRAP_SITE) {
          fail(tuple.where(), std::string("tendon '") + nameOf(m, mjOBJ_TENDON, tendon) +
                                  "' must run straight between two sites");
        }
        ligament.tendons.push_back(tendon);
        is_ligament[tendon] = 1;
      }
      ligaments.push_back(ligament);
    }
  }
  if (discs.empty()) fail("custom", "no tuple 'disc:...' was found");

  batch = std::make_unique<DiscBatch>(batch_discs);

  // Weld rows of a disc: bound and viscosity from its stiffness at rest. The rows' axes are those
  // of the world (translation) and of the lower body (rotation); the largest stiffness bounds them
  // all.
  for (WeldEntry& weld : welds) {
    if (weld.disc < 0) continue;
    const auto& K = batch->restStiffness(weld.disc);
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
      const int body = m->site_bodyid[site], ref_body = m->site_bodyid[ref];
      if ((body == disc.upper_body && ref_body == disc.lower_body) ||
          (body == disc.lower_body && ref_body == disc.upper_body)) {
        weld.servos.push_back(i);
      }
    }
  }

  // Ligament segments and facets by level.
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

  for (int i = 0; i < m->nsensor; i++) {
    if (m->sensor_type[i] != mjSENS_USER || m->sensor_objtype[i] != mjOBJ_TUPLE) continue;
    for (std::size_t k = 0; k < discs.size(); k++) {
      if (discs[k].tuple != m->sensor_objid[i]) continue;
      const int what =
          m->nuser_sensor > 0 ? static_cast<int>(m->sensor_user[m->nuser_sensor * i]) : -1;
      const int dim[] = {3, 3, 1, static_cast<int>(levels[k].tendons.size()),
                         static_cast<int>(levels[k].facets.size())};
      const std::string where = std::string("sensor '") + nameOf(m, mjOBJ_SENSOR, i) + "'";
      if (what < 0 || what > 4) {
        fail(where, "user[0] must be 0 force, 1 moment, 2 pressure, 3 ligament or 4 facet");
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

  // Opposite nodes of the endplates: the lower node nearest in the plane of the disc.
  for (const DiscBatch::Disc& disc : batch_discs) {
    const auto& x = disc.mesh.rest_positions;
    columns.emplace_back();
    for (int upper : disc.mesh.upper_nodes) {
      int nearest = disc.mesh.lower_nodes.front();
      for (int lower : disc.mesh.lower_nodes) {
        const auto distance = [&](int node) { return (x[node] - x[upper]).head<2>().norm(); };
        if (distance(lower) < distance(nearest)) nearest = lower;
      }
      columns.back().push_back({nearest, upper});
    }
  }

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
