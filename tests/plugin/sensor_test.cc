// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Sensors and C interface report what acts in the simulation.

#include <gtest/gtest.h>

#include <map>

#include <Eigen/Geometry>
#include <cmath>

#include "tests/plugin/fixture.h"

namespace torso {
namespace {

using Eigen::Vector3d;

class SensorTest : public PluginTest {
 protected:
  static const mjtNum* sensor(const mjModel* m, const mjData* d, const std::string& name) {
    const int id = mj_name2id(m, mjOBJ_SENSOR, name.c_str());
    if (id < 0) throw std::runtime_error("no sensor is called " + name);
    return d->sensordata + m->sensor_adr[id];
  }
  static Vector3d vector(const mjtNum* x) { return {x[0], x[1], x[2]}; }

  // Bent hard by the servos: ligaments are taut and facets at work.
  static DataPtr bent(const mjModel* m) {
    DataPtr d = makeData(m);
    randomControls(m, d.get(), 1, 8);
    for (int i = 0; i < 150; i++) mj_step(m, d.get());
    mj_forward(m, d.get());
    return d;
  }
};

TEST_F(SensorTest, DiscSensorsAgreeWithTheCInterface) {
  const ModelPtr m = loadModel("human.xml");
  const DataPtr d = bent(m.get());
  const torsoInfo info = torsoOf(m.get());
  EXPECT_EQ(info.ndisc, 23);
  for (int i = 0; i < info.ndisc; i++) {
    const std::string name = torso_discName(m.get(), i);
    EXPECT_EQ(torso_discId(m.get(), name.c_str()), i);
    mjtNum force[3], moment[3];
    ASSERT_EQ(torso_discWrench(m.get(), d.get(), i, force, moment, nullptr), 0);
    EXPECT_EQ(vector(sensor(m.get(), d.get(), name + "_force")), vector(force)) << name;
    EXPECT_EQ(vector(sensor(m.get(), d.get(), name + "_moment")), vector(moment)) << name;
    EXPECT_EQ(*sensor(m.get(), d.get(), name + "_pressure"),
              torso_discPressure(m.get(), d.get(), i));
    EXPECT_GT(vector(force).norm(), 0) << name;
  }
}

// Tendons by name, against the solver's own rows.
TEST_F(SensorTest, LigamentTensionIsTheConstraintForce) {
  const ModelPtr m = loadModel("human.xml");
  const DataPtr d = bent(m.get());
  std::vector<mjtNum> tension(m->ntendon, 0);
  int taut = 0;
  for (int i = 0; i < d->nefc; i++) {
    if (d->efc_type[i] != mjCNSTR_LIMIT_TENDON) continue;
    tension[d->efc_id[i]] = d->efc_force[i];
    taut += d->efc_force[i] > 0;
  }
  EXPECT_GT(taut, 3);
  int read = 0;
  for (int i = 0; i < 22; i++) {
    const std::string level = torso_discName(m.get(), i);
    const mjtNum* out = sensor(m.get(), d.get(), level + "_ligament_tension");
    int entry = 0;
    for (int t = 0; t < m->ntuple; t++) {  // ligaments in the model's order
      const std::string tuple = mj_id2name(m.get(), mjOBJ_TUPLE, t);
      if (tuple.rfind("ligament:", 0) != 0) continue;
      const std::string segment = tuple.substr(9) + "_" + level;
      const int tendon = mj_name2id(m.get(), mjOBJ_TENDON, segment.c_str());
      ASSERT_GE(tendon, 0) << segment;
      EXPECT_EQ(out[entry], tension[tendon]) << segment;
      EXPECT_EQ(torso_ligamentTension(m.get(), d.get(), tendon), tension[tendon]) << segment;
      EXPECT_GE(out[entry], 0) << "a ligament does not push";
      entry++;
      read++;
    }
  }
  EXPECT_EQ(read, 440);
}

TEST_F(SensorTest, FacetForceIsTheSumOfItsContacts) {
  const ModelPtr m = loadModel("human.xml");
  const DataPtr d = bent(m.get());
  const torsoInfo info = torsoOf(m.get());
  EXPECT_EQ(info.nfacet, 74);
  int loaded = 0;
  for (int f = 0; f < info.nfacet; f++) {
    const std::string name = torso_facetName(m.get(), f);
    const int ellipsoid = mj_name2id(m.get(), mjOBJ_GEOM, (name + "_ellipsoid").c_str());
    Vector3d expected = Vector3d::Zero();
    for (int c = 0; c < d->ncon; c++) {
      if (d->contact[c].geom2 != ellipsoid) continue;
      mjtNum force[6], world[3];
      mj_contactForce(m.get(), d.get(), c, force);
      mju_rotVecMatT(world, force, d->contact[c].frame);
      expected -= vector(world);  // MuJoCo's acts on geom2, the ellipsoid
    }
    mjtNum force[3];
    ASSERT_EQ(torso_facetForce(m.get(), d.get(), f, force), 0);
    EXPECT_LT((vector(force) - expected).norm(), 1e-9 * (1 + expected.norm())) << name;
    loaded += expected.norm() > 1;
  }
  EXPECT_GT(loaded, 5);
  for (int i = 0; i < 22; i++) {
    const std::string level = torso_discName(m.get(), i);
    const mjtNum* out = sensor(m.get(), d.get(), level + "_facet_force");
    int entry = 0;
    for (const char* side : {"_left", "_right"}) {
      mjtNum force[3];
      const int f = torso_facetId(m.get(), (level + side).c_str());
      ASSERT_EQ(torso_facetForce(m.get(), d.get(), f, force), 0);
      EXPECT_NEAR(out[entry++], mju_norm3(force), 1e-12) << level << side;
    }
  }
}

// The nodes that the C interface gives lie on the bones: attached nodes move with them.
TEST_F(SensorTest, NodesOfTheEndplatesMoveWithTheBones) {
  const ModelPtr m = loadModel("torso.xml");
  const DataPtr rest = makeData(m.get());
  mj_forward(m.get(), rest.get());
  const DataPtr d = bent(m.get());
  for (int i = 0; i < 23; i++) {
    int nodes, tets, body[2];
    torso_discSize(m.get(), i, &nodes, &tets);
    torso_discBodies(m.get(), i, body);
    EXPECT_EQ(nodes, 185);
    EXPECT_EQ(tets, 720);
    std::vector<mjtNum> before(3 * nodes), now(3 * nodes);
    torso_discNodes(m.get(), rest.get(), i, before.data());
    torso_discNodes(m.get(), d.get(), i, now.data());
    // In a body's frame its endplate's nodes, a fifth of all, have not moved; inner ones have.
    for (int side : {0, 1}) {
      int fixed = 0;
      for (int k = 0; k < nodes; k++) {
        const auto local = [&](const mjData* data, const mjtNum* x) {
          mjtNum offset[3], out[3];
          mju_sub3(offset, x, data->xpos + 3 * body[side]);
          mju_rotVecMatT(out, offset, data->xmat + 9 * body[side]);
          return vector(out);
        };
        fixed += (local(rest.get(), &before[3 * k]) - local(d.get(), &now[3 * k])).norm() < 1e-7;
      }
      EXPECT_EQ(fixed, 37) << torso_discName(m.get(), i);
    }
    // No cell has turned inside out or been crushed; single tets may be, for the energy knows the
    // volume of cells only.
    std::vector<int> tet(4 * tets), cell(tets);
    torso_discTets(m.get(), i, tet.data());
    torso_discCells(m.get(), i, cell.data());
    std::map<int, double> volume_now, volume_before;
    const auto volume = [&](int t, const std::vector<mjtNum>& positions) {
      Vector3d x[4];
      for (int k = 0; k < 4; k++) x[k] = vector(&positions[3 * tet[4 * t + k]]);
      return (x[1] - x[0]).cross(x[2] - x[0]).dot(x[3] - x[0]) / 6;
    };
    for (int t = 0; t < tets; t++) {
      volume_now[cell[t]] += volume(t, now);
      volume_before[cell[t]] += volume(t, before);
    }
    for (const auto& [c, v] : volume_now) {
      EXPECT_GT(v, 0.3 * volume_before[c]) << torso_discName(m.get(), i) << ", cell " << c;
    }
  }
}

// A standing trunk with its pelvis held: what crosses the gap L4/L5 carries what is above it.
TEST_F(SensorTest, DiscFacetsAndLigamentsCarryTheWeightAbove) {
  std::string text = modelText("human.xml");
  fixPelvis(&text);
  const ModelPtr m = loadText(text);
  m->opt.collision = mjCOL_PAIR;  // the legs hang free
  const DataPtr d = makeData(m.get());
  while (d->time < 3) mj_step(m.get(), d.get());
  mj_forward(m.get(), d.get());

  double weight = 0;
  for (int i = 1; i < m->nbody; i++) {
    const int root = m->body_rootid[i];
    const std::string name = mj_id2name(m.get(), mjOBJ_BODY, root);
    if (name != "pelvis" && name != "L5") weight += 9.81 * m->body_mass[i];
  }
  const int disc = torso_discId(m.get(), "L4/L5");
  mjtNum force[3], facets = 0, ligaments = 0;
  torso_discWrench(m.get(), d.get(), disc, force, nullptr, nullptr);
  for (const char* name : {"L4/L5_left", "L4/L5_right"}) {
    mjtNum f[3];
    torso_facetForce(m.get(), d.get(), torso_facetId(m.get(), name), f);
    facets += f[2];
  }
  for (int t = 0; t < m->ntendon; t++) {
    const std::string name = mj_id2name(m.get(), mjOBJ_TENDON, t);
    if (name.size() < 6 || name.substr(name.size() - 6) != "_L4/L5") continue;
    const int adr = m->tendon_adr[t];
    const Vector3d along = vector(d->site_xpos + 3 * m->wrap_objid[adr]) -
                           vector(d->site_xpos + 3 * m->wrap_objid[adr + 1]);
    ligaments += torso_ligamentTension(m.get(), d.get(), t) * along.normalized().z();
  }
  const double pressure = torso_discPressure(m.get(), d.get(), disc);
  std::printf(
      "L4/L5: disc %.1f N, facets %.1f N, ligaments %.1f N up; weight above %.1f N; "
      "pressure %.3f MPa\n",
      force[2], facets, ligaments, weight, 1e-6 * pressure);
  EXPECT_NEAR(force[2] + facets + ligaments, weight, 0.01 * weight);

  // The pressure is that force over the endplate: 0.82 x 48.4 mm x 34.3 mm (discs.csv, disc.h),
  // inclined to the disc's axis by half the wedge, 6.5 degrees.
  const int upper = mj_name2id(m.get(), mjOBJ_SITE, "L4/L5_upper");
  const mjtNum* R = d->site_xmat + 9 * upper;
  const double normal = force[0] * R[2] + force[1] * R[5] + force[2] * R[8];
  EXPECT_NEAR(pressure * 0.82 * 0.0484 * 0.0343, normal, 0.1 * normal);
  // In vivo 0.46 - 0.55 MPa upright (Wilke et al. 1999, Spine 24:755-762), of which muscles, that
  // this model does not have, make half and more.
  EXPECT_GT(pressure, 0.1e6);
  EXPECT_LT(pressure, 1e6);
}

}  // namespace
}  // namespace torso
