// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Grafts MuJoCo's own humanoid, and looks at the result with plain MuJoCo.

#include <sys/wait.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/tools/graft_fixture.h"
#include "tools/torso_mjcf.h"

namespace torso::tools {
namespace {

class Graft : public GraftFixture {};

DataPtr forward(const mjModel* m) {
  DataPtr d = makeData(m);
  mj_forward(m, d.get());
  return d;
}

double midDistance(const mjModel* m, const mjData* d) {
  double sum = 0;
  for (int k = 0; k < 3; k++) {
    const auto anchor = [&](const char* joint) {
      return d->xanchor[3 * idOf(m, mjOBJ_JOINT, joint) + k];
    };
    const double x = 0.5 * (anchor("left_shoulder1") + anchor("right_shoulder1") -
                            anchor("left_hip_x") - anchor("right_hip_x"));
    sum += x * x;
  }
  return std::sqrt(sum);
}

TEST_F(Graft, KeepsMassAndSizeAndLegs) {
  graftTo(kMujocoHumanoid);
  const ModelPtr before = loadModel(kMujocoHumanoid), after = loadModel(at("out.xml"));
  double mass[2] = {0, 0};
  for (int b = 0; b < before->nbody; b++) mass[0] += before->body_mass[b];
  for (int b = 0; b < after->nbody; b++) mass[1] += after->body_mass[b];
  EXPECT_NEAR(mass[1], mass[0], 0.01 * mass[0]);
  const DataPtr d0 = forward(before.get()), d1 = forward(after.get());
  EXPECT_NEAR(midDistance(after.get(), d1.get()), midDistance(before.get(), d0.get()), 0.0105);
  torsoInfo info;
  ASSERT_EQ(torso_info(after.get(), &info, nullptr, 0), 1);
  EXPECT_EQ(info.ndisc, 23);
  EXPECT_EQ(info.nligsegment, 440);
  EXPECT_EQ(info.nfacet, 74);
  for (const char* side : {"left", "right"}) {
    for (const char* part : {"_thigh", "_shin", "_foot"}) {
      const std::string name = std::string(side) + part;
      const int b0 = idOf(before.get(), mjOBJ_BODY, name), b1 = idOf(after.get(), mjOBJ_BODY, name);
      for (int k = 0; k < 9; k++) {
        EXPECT_NEAR(d1->xmat[9 * b1 + k], d0->xmat[9 * b0 + k], 1e-6);
        if (k < 3) {
          EXPECT_NEAR(d1->xpos[3 * b1 + k], d0->xpos[3 * b0 + k], 1e-6) << name;
        }
      }
    }
  }
}

// All that is kept is what it was, whatever the torso's defaults and settings.
TEST_F(Graft, KeptObjectsAreUnchangedAndTheOthersReported) {
  const GraftReport report = graftTo(kMujocoHumanoid);
  std::set<std::pair<std::string, std::string>> gone, changed;
  for (const GraftChange& c : report.changes) {
    EXPECT_FALSE(c.detail.empty());
    if (c.action == "changed") changed.emplace(c.kind, c.name);
    if (c.action == "removed" || c.action == "replaced") gone.emplace(c.kind, c.name);
  }
  const ModelPtr before = loadModel(kMujocoHumanoid), after = loadModel(at("out.xml"));
  const mjModel *a = before.get(), *b = after.get();
  int kept = 0;
  const auto compare = [&](mjtObj type, int n, const auto& same) {
    const std::string kind = mju_type2Str(type);
    int last = -1;
    for (int i = 0; i < n; i++) {
      const char* has_name = mj_id2name(a, type, i);
      if (!has_name) continue;
      const std::string name = has_name;
      if (gone.count({kind, name})) continue;
      const int j = mj_name2id(b, type, name.c_str());
      ASSERT_GE(j, 0) << kind << " " << name << " is neither kept nor reported";
      kept++;
      same(i, j, kind + " " + name);
      if (type == mjOBJ_ACTUATOR) {
        EXPECT_GT(j, last) << "order of " << name;
        last = j;
      }
    }
  };
  const auto equal = [](const mjtNum* x, const mjtNum* y, int n, const std::string& what) {
    for (int k = 0; k < n; k++) EXPECT_NEAR(y[k], x[k], 1e-6 * (1 + std::abs(x[k]))) << what;
  };
  compare(mjOBJ_BODY, a->nbody, [&](int i, int j, const std::string& what) {
    if (i == 0) return;
    equal(a->body_mass + i, b->body_mass + j, 1, what);
    equal(a->body_inertia + 3 * i, b->body_inertia + 3 * j, 3, what);
  });
  compare(mjOBJ_JOINT, a->njnt, [&](int i, int j, const std::string& what) {
    EXPECT_EQ(a->jnt_type[i], b->jnt_type[j]) << what;
    EXPECT_EQ(a->jnt_limited[i], b->jnt_limited[j]) << what;
    equal(a->jnt_range + 2 * i, b->jnt_range + 2 * j, 2, what);
    equal(a->jnt_axis + 3 * i, b->jnt_axis + 3 * j, 3, what);
    equal(a->jnt_stiffness + i, b->jnt_stiffness + j, 1, what);
    equal(a->jnt_solimp + 5 * i, b->jnt_solimp + 5 * j, 5, what);
    equal(a->dof_damping + a->jnt_dofadr[i], b->dof_damping + b->jnt_dofadr[j], 1, what);
    equal(a->dof_armature + a->jnt_dofadr[i], b->dof_armature + b->jnt_dofadr[j], 1, what);
  });
  compare(mjOBJ_GEOM, a->ngeom, [&](int i, int j, const std::string& what) {
    EXPECT_EQ(a->geom_type[i], b->geom_type[j]) << what;
    EXPECT_EQ(a->geom_condim[i], b->geom_condim[j]) << what;
    EXPECT_EQ(a->geom_contype[i], b->geom_contype[j]) << what;
    equal(a->geom_size + 3 * i, b->geom_size + 3 * j, 3, what);
    equal(a->geom_friction + 3 * i, b->geom_friction + 3 * j, 3, what);
    equal(a->geom_solref + 2 * i, b->geom_solref + 2 * j, 2, what);
    const int p = a->geom_matid[i], q = b->geom_matid[j];
    EXPECT_EQ(p < 0 ? "" : nameOf(a, mjOBJ_MATERIAL, p), q < 0 ? "" : nameOf(b, mjOBJ_MATERIAL, q));
  });
  compare(mjOBJ_ACTUATOR, a->nu, [&](int i, int j, const std::string& what) {
    if (!changed.count({"actuator", nameOf(a, mjOBJ_ACTUATOR, i)})) {
      equal(a->actuator_gear + 6 * i, b->actuator_gear + 6 * j, 6, what);
    }
    equal(a->actuator_ctrlrange + 2 * i, b->actuator_ctrlrange + 2 * j, 2, what);
  });
  const auto nothing = [](int, int, const std::string&) {};
  compare(mjOBJ_CAMERA, a->ncam, nothing);
  compare(mjOBJ_LIGHT, a->nlight, nothing);
  compare(mjOBJ_MATERIAL, a->nmat, nothing);
  compare(mjOBJ_TEXTURE, a->ntex, nothing);
  EXPECT_GT(kept, 60);
  EXPECT_EQ(a->ntex, b->ntex);

  // The camera in the head sees from the same place.
  const DataPtr d0 = forward(a), d1 = forward(b);
  const int c0 = idOf(a, mjOBJ_CAMERA, "egocentric"), c1 = idOf(b, mjOBJ_CAMERA, "egocentric");
  equal(d0->cam_xpos + 3 * c0, d1->cam_xpos + 3 * c1, 3, "egocentric");
  equal(d0->cam_xmat + 9 * c0, d1->cam_xmat + 9 * c1, 9, "egocentric");
}

TEST_F(Graft, NothingTouchesAtRest) {
  graftTo(kMujocoHumanoid);
  const ModelPtr m = loadModel(at("out.xml"));
  const DataPtr d = forward(m.get());
  for (int i = 0; i < d->ncon; i++) {
    const int g1 = d->contact[i].geom1, g2 = d->contact[i].geom2;
    const bool facet = !m->geom_contype[g1] && !m->geom_conaffinity[g1];
    EXPECT_TRUE(facet) << nameOf(m.get(), mjOBJ_GEOM, g1) << " touches "
                       << nameOf(m.get(), mjOBJ_GEOM, g2);
  }
}

TEST_F(Graft, StockMujocoLoadsAndStepsIt) {
  graftTo(kMujocoHumanoid);
  torso_uninstall();
  const ModelPtr m = loadModel(at("out.xml"));
  const DataPtr d = makeData(m.get());
  for (int i = 0; i < 600; i++) mj_step(m.get(), d.get());
  EXPECT_EQ(firstWarning(d.get()), "");
  torso_install();
}

TEST_F(Graft, DropsWithoutWarnings) {
  graftTo(kMujocoHumanoid);
  const ModelPtr m = loadModel(at("out.xml"));
  const DataPtr d = makeData(m.get());
  drop(m.get(), d.get(), 1, 1200);
  EXPECT_EQ(firstWarning(d.get()), "");
  EXPECT_LT(d->xpos[3 * idOf(m.get(), mjOBJ_BODY, "pelvis") + 2], 1.2);
}

// Lying on the side, turning, knees bent: legs as before, the torso undeformed and turning too.
TEST_F(Graft, KeyframesKeepTheirPose) {
  std::string humanoid = readFile(kMujocoHumanoid), qpos = "1 2 0.3 0.5 0.5 -0.5 0.5",
              qvel = "0.1 0.2 0.3 1 2 3";
  for (int i = 0; i < 21; i++) {
    qpos += i < 3 ? " 0" : " -0.2";
    qvel += i < 3 ? " 0" : " 0.5";
  }
  humanoid.insert(humanoid.find("</mujoco>"),
                  "<keyframe><key name='lying' time='3' qpos='" + qpos + "' qvel='" + qvel +
                      "' ctrl='.1 .1 .1 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2'/>"
                      "</keyframe>");
  graftTo(write("in.xml", humanoid));
  const ModelPtr a = loadModel(at("in.xml")), b = loadModel(at("out.xml"));
  ASSERT_EQ(b->nkey, 1);
  EXPECT_EQ(b->key_time[0], 3);
  const DataPtr d0 = makeData(a.get()), d1 = makeData(b.get());
  mj_resetDataKeyframe(a.get(), d0.get(), 0);
  mj_resetDataKeyframe(b.get(), d1.get(), 0);
  mj_forward(a.get(), d0.get());
  mj_forward(b.get(), d1.get());
  for (const char* foot : {"left_foot", "right_foot"}) {
    const int b0 = idOf(a.get(), mjOBJ_BODY, foot), b1 = idOf(b.get(), mjOBJ_BODY, foot);
    mjtNum v0[6], v1[6];
    mj_objectVelocity(a.get(), d0.get(), mjOBJ_XBODY, b0, v0, 0);
    mj_objectVelocity(b.get(), d1.get(), mjOBJ_XBODY, b1, v1, 0);
    for (int k = 0; k < 9; k++) EXPECT_NEAR(d1->xmat[9 * b1 + k], d0->xmat[9 * b0 + k], 1e-5);
    for (int k = 0; k < 3; k++) EXPECT_NEAR(d1->xpos[3 * b1 + k], d0->xpos[3 * b0 + k], 1e-5);
    for (int k = 0; k < 6; k++) EXPECT_NEAR(v1[k], v0[k], 1e-5) << k;
  }
  for (int t = 0; t < b->ntendon; t++) {
    EXPECT_NEAR(d1->ten_length[t], b->tendon_length0[t], 1e-5);
    EXPECT_NEAR(d1->ten_velocity[t], 0, 1e-4);
  }
  EXPECT_NEAR(d1->ctrl[idOf(b.get(), mjOBJ_ACTUATOR, "left_knee")], 0.2, 1e-9);
  EXPECT_EQ(d1->ctrl[idOf(b.get(), mjOBJ_ACTUATOR, "L5/S1_flexion")], 0);
}

// MuJoCo saves in radians and with all names of defaults spelled out.
TEST_F(Graft, RadiansAndSavedModelsGiveTheSame) {
  char error[500] = "";
  mjModel* original = mj_loadXML(kMujocoHumanoid, nullptr, error, sizeof(error));
  ASSERT_TRUE(mj_saveLastXML(at("saved.xml").c_str(), original, error, sizeof(error))) << error;
  mj_deleteModel(original);
  ASSERT_NE(readFile(at("saved.xml")).find("angle=\"radian\""), std::string::npos);
  graftTo(kMujocoHumanoid, "degree.xml");
  graftTo(at("saved.xml"), "radian.xml");
  const ModelPtr a = loadModel(at("degree.xml")), b = loadModel(at("radian.xml"));
  ASSERT_EQ(a->njnt, b->njnt);
  int limited = 0;
  for (int j = 0; j < a->njnt; j++) {
    EXPECT_EQ(nameOf(a.get(), mjOBJ_JOINT, j), nameOf(b.get(), mjOBJ_JOINT, j));
    EXPECT_EQ(a->jnt_limited[j], b->jnt_limited[j]);
    EXPECT_NEAR(a->jnt_range[2 * j + 1], b->jnt_range[2 * j + 1], 1e-5);
    limited += a->jnt_type[j] == mjJNT_BALL && a->jnt_limited[j];
  }
  EXPECT_EQ(limited, 5);  // head, sterno- and acromioclavicular joints
}

TEST_F(Graft, PrefixIsOnEveryNameOfTheTorso) {
  GraftOptions o = options(kMujocoHumanoid);
  o.prefix = "my_";
  const GraftReport report = graft(anatomy(), o);
  for (const GraftChange& c : report.changes) EXPECT_NE(c.action, "renamed") << c.name;
  const ModelPtr before = loadModel(kMujocoHumanoid), m = loadModel(at("out.xml"));
  for (int b = 1; b < m->nbody; b++) {
    const std::string name = nameOf(m.get(), mjOBJ_BODY, b);
    const bool theirs = mj_name2id(before.get(), mjOBJ_BODY, name.c_str()) > 0;
    EXPECT_TRUE(theirs || name.rfind("my_", 0) == 0) << name;
  }
  EXPECT_EQ(torso_info(m.get(), nullptr, nullptr, 0), 1);
}

TEST_F(Graft, DryRunWritesNothing) {
  GraftOptions o = options(kMujocoHumanoid);
  o.dry_run = true;
  const GraftReport report = graft(anatomy(), o);
  EXPECT_EQ(report.limb_joints, 18);
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

// As a user runs it.
TEST_F(Graft, CommandReportsAndExits) {
  const auto run = [&](const std::string& arguments) {
    const std::string line = "cd " + folder_.string() + " && " TORSO_COMMAND " graft " + arguments +
                             " > out.txt 2> err.txt < /dev/null";
    return WEXITSTATUS(std::system(line.c_str()));
  };
  EXPECT_EQ(run(std::string(kMujocoHumanoid) + " -o h.xml --json"), 0);
  EXPECT_EQ(readFile(at("err.txt")), "");
  const auto json = nlohmann::json::parse(readFile(at("out.txt")), nullptr, false);
  EXPECT_NEAR(json["mass_after_kg"], json["mass_before_kg"], 1e-3);
  EXPECT_FALSE(json["changes"].empty());
  EXPECT_TRUE(std::filesystem::exists(at("torso_assets/ribcage.stl")));

  EXPECT_EQ(run("h.xml -o again.xml"), 1);
  EXPECT_EQ(readFile(at("err.txt")),
            "torso graft: h.xml: it has a torso of ours already; give a second one a --prefix\n");
  EXPECT_EQ(run("h.xml -o again.xml --prefix b_"), 1);
  EXPECT_EQ(readFile(at("err.txt")),
            "torso graft: h.xml: it has a torso of ours already, and no other humanoid\n");
  EXPECT_EQ(run("missing.xml -o again.xml"), 1);
  EXPECT_EQ(readFile(at("err.txt")).rfind("torso graft: missing.xml: no such file", 0), 0u);
  EXPECT_EQ(run("h.xml"), 2);
  EXPECT_FALSE(std::filesystem::exists(at("again.xml")));
}

// A scaled anatomy gives a scaled model: lengths, masses and what follows from both.
TEST_F(Graft, ScaledAnatomyIsSimilar) {
  const double L = 0.7, M = 0.4;
  const auto compiled = [&](const Anatomy& a, double scale, const std::string& name) {
    tinyxml2::XMLDocument document;
    MjcfOptions options;
    options.mesh_scale = scale;
    options.mesh_dir = mjcfFolder() + "/assets";
    writeMjcf(a, options, document);
    tinyxml2::XMLPrinter printer;
    document.Print(&printer);
    return loadModel(write(name, printer.CStr()));
  };
  const ModelPtr a = compiled(anatomy(), 1, "a.xml");
  const ModelPtr b = compiled(anatomy().scaled(L, M), L, "b.xml");
  const auto ratio = [](const mjtNum* x, const mjtNum* y, int n, double expected, double tiny,
                        const char* what) {
    for (int i = 0; i < n; i++) {
      EXPECT_NEAR(y[i], expected * x[i], 2e-4 * std::abs(x[i]) + tiny) << what << " " << i;
    }
  };
  ASSERT_EQ(a->nbody, b->nbody);
  ratio(a->body_pos, b->body_pos, 3 * a->nbody, L, 1e-6, "body_pos");
  ratio(a->body_ipos, b->body_ipos, 3 * a->nbody, L, 1e-6, "body_ipos");
  ratio(a->body_mass, b->body_mass, a->nbody, M, 1e-7, "body_mass");
  ratio(a->body_inertia, b->body_inertia, 3 * a->nbody, M * L * L, 1e-7, "body_inertia");
  for (int g = 0; g < a->ngeom; g++) {
    if (a->geom_type[g] == mjGEOM_MESH) continue;
    const bool point = a->geom_type[g] == mjGEOM_SPHERE;  // a facet's point is drawn as it is
    ratio(a->geom_pos + 3 * g, b->geom_pos + 3 * g, 3, L, 1e-6, "geom_pos");
    if (point) continue;
    ratio(a->geom_size + 3 * g, b->geom_size + 3 * g, 3, L, 1e-6, "geom_size");
  }
  ratio(a->tendon_length0, b->tendon_length0, a->ntendon, L, 1e-6, "tendon_length0");
  for (int t = 0; t < a->ntendon; t++) {  // the lower bound is none
    ratio(a->tendon_range + 2 * t + 1, b->tendon_range + 2 * t + 1, 1, L, 1e-6, "tendon_range");
  }
  ratio(a->jnt_stiffness, b->jnt_stiffness, a->njnt, M * L * L, 1e-6, "jnt_stiffness");
  ratio(a->dof_damping, b->dof_damping, a->nv, M * L * L, 1e-6, "dof_damping");
  ratio(a->actuator_gainprm, b->actuator_gainprm, mjNGAIN * a->nu, M * L * L, 1e-6, "gainprm");
  ratio(a->actuator_ctrlrange, b->actuator_ctrlrange, 2 * a->nu, 1, 1e-6, "ctrlrange");
  ratio(a->actuator_forcerange, b->actuator_forcerange, 2 * a->nu, M * L * L, 1e-6, "forcerange");
}

}  // namespace
}  // namespace torso::tools
