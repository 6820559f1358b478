// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// What must hold of any humanoid that is grafted, for each form in which people write them.

#include <algorithm>
#include <set>

#include "tests/tools/graft_fixture.h"
#include "tools/graft_host.h"
#include "tools/graft_names.h"

namespace torso::tools {
namespace {

class GraftHosts : public GraftFixture, public testing::WithParamInterface<HumanoidForm> {
 protected:
  // Grafts the form; `in` and `out` are the models.
  void graftForm() {
    report_ = graftTo(write("in.xml", GetParam().text));
    in_ = loadModel(at("in.xml"));
    out_ = loadModel(at("out.xml"));
  }
  // Names of the two thighs.
  std::vector<std::string> thighs() const {
    std::vector<std::string> names;
    for (const RecognisedPart& p : report_.parts) {
      if (p.part == "left_thigh" || p.part == "right_thigh") names.push_back(p.bodies.at(0));
    }
    return names;
  }
  // Joints of a limb in the order of the model.
  static std::vector<int> jointsBelow(const mjModel* m, const std::string& limb) {
    const int top = idOf(m, mjOBJ_BODY, limb);
    std::vector<int> joints;
    for (int j = 0; j < m->njnt; j++) {
      int b = m->jnt_bodyid[j];
      while (b > top) b = m->body_parentid[b];
      if (b == top) joints.push_back(j);
    }
    return joints;
  }
  static bool hasName(const mjModel* m, mjtObj type, const std::string& name) {
    return mj_name2id(m, type, name.c_str()) >= 0;
  }

  GraftReport report_;
  ModelPtr in_, out_;
};

INSTANTIATE_TEST_SUITE_P(Forms, GraftHosts, testing::ValuesIn(humanoidForms()),
                         [](const auto& info) { return info.param.name; });

// Torques that swing both legs, by inverse dynamics with all else at rest.
std::vector<double> swingTorques(const mjModel* m, const std::vector<int>& joints) {
  std::vector<double> torques;
  const DataPtr d = makeData(m);
  for (double t = 0; t < 1; t += 0.1) {
    for (std::size_t i = 0; i < joints.size(); i++) {
      const int j = joints[i];
      const bool ball = m->jnt_type[j] == mjJNT_BALL;
      // Within the limits, whose soft forces depend on the inertia of the whole body.
      const mjtNum* range = m->jnt_range + 2 * j;
      const bool limited = m->jnt_limited[j] && !ball;
      const double mid = limited ? 0.5 * (range[0] + range[1]) : 0;
      const double size = limited ? 0.4 * (range[1] - range[0]) : 0.5;
      const double w = 4 + 0.3 * static_cast<double>(i);
      const double q = size * std::sin(w * t), v = size * w * std::cos(w * t), a = -w * w * q;
      const mjtNum axis[3] = {0.6, 0.8, 0};  // about which a ball joint swings
      if (ball) {
        mju_axisAngle2Quat(d->qpos + m->jnt_qposadr[j], axis, q);
        mju_scl3(d->qvel + m->jnt_dofadr[j], axis, v);
        mju_scl3(d->qacc + m->jnt_dofadr[j], axis, a);
      } else {
        d->qpos[m->jnt_qposadr[j]] = mid + q;
        d->qvel[m->jnt_dofadr[j]] = v;
        d->qacc[m->jnt_dofadr[j]] = a;
      }
    }
    mj_inverse(m, d.get());
    for (int j : joints) {
      for (int k = 0; k < (m->jnt_type[j] == mjJNT_BALL ? 3 : 1); k++) {
        torques.push_back(d->qfrc_inverse[m->jnt_dofadr[j] + k]);
      }
    }
  }
  return torques;
}

TEST_P(GraftHosts, LegSwingTakesTheSameTorques) {
  graftForm();
  std::vector<double> torques[2];
  for (int k = 0; k < 2; k++) {
    mjModel* m = k ? out_.get() : in_.get();
    m->opt.disableflags |= mjDSBL_CONTACT;
    std::vector<int> joints;
    for (const std::string& thigh : thighs()) {
      for (int j : jointsBelow(m, thigh)) joints.push_back(j);
    }
    torques[k] = swingTorques(m, joints);
  }
  ASSERT_EQ(torques[0].size(), torques[1].size());
  double largest = 0;
  for (double torque : torques[0]) largest = std::max(largest, std::abs(torque));
  EXPECT_GT(largest, 10);
  for (std::size_t i = 0; i < torques[0].size(); i++) {
    EXPECT_NEAR(torques[1][i], torques[0][i], 1e-4 * largest);
  }
}

// Each name of the input is in the output or in the report, and so is each geom without a name.
TEST_P(GraftHosts, NothingIsDroppedSilently) {
  graftForm();
  tinyxml2::XMLDocument out;
  ASSERT_EQ(out.LoadFile(at("out.xml").c_str()), tinyxml2::XML_SUCCESS);
  const Host host(at("in.xml"));
  const std::set<MjcfName> before = definedNames(host.root),
                           after = definedNames(out.RootElement());
  std::set<MjcfName> reported;
  int geoms_reported = 0;
  for (const GraftChange& c : report_.changes) {
    EXPECT_FALSE(c.detail.empty()) << c.name;
    reported.emplace(c.kind, c.name);
    geoms_reported += c.kind == "geom" && c.action == "removed";
  }
  int gone = 0;
  for (const MjcfName& name : before) {
    if (reported.count(name)) continue;
    EXPECT_TRUE(after.count(name)) << name.first << " " << name.second;
    gone += !after.count(name);
  }
  EXPECT_EQ(gone, 0);
  int kept = 0;
  for (int g = 0; g < out_->ngeom; g++) {
    const int body = out_->geom_bodyid[g];
    const std::string name = nameOf(out_.get(), mjOBJ_BODY, body);
    bool theirs = body == 0 || hasName(in_.get(), mjOBJ_BODY, name);
    for (const RecognisedPart& p : report_.parts) {
      // Our own bodies may have a name that one of the trunk's had.
      const bool limb = p.part.find("thigh") != std::string::npos ||
                        p.part.find("upper_arm") != std::string::npos;
      for (const std::string& b : p.bodies) theirs &= limb || b != name;
    }
    kept += theirs;
  }
  EXPECT_EQ(kept + geoms_reported, in_->ngeom);
  EXPECT_GT(geoms_reported, 0);
}

TEST_P(GraftHosts, KeepsMassSizeAndLimbJoints) {
  graftForm();
  EXPECT_NEAR(mj_getTotalmass(out_.get()), mj_getTotalmass(in_.get()),
              0.01 * mj_getTotalmass(in_.get()));
  // What the humanoid's compiler settings do to light bodies does not reach into the torso.
  const int t6 = idOf(out_.get(), mjOBJ_BODY, "T6");
  EXPECT_LT(out_->body_mass[t6], 0.3);
  EXPECT_LT(out_->body_inertia[3 * t6], 0.001);
  EXPECT_EQ(out_->body_mass[idOf(out_.get(), mjOBJ_BODY, "T6_facets")], 0);
  std::vector<Eigen::Vector3d> centres[2];
  for (int k = 0; k < 2; k++) {
    const mjModel* m = k ? out_.get() : in_.get();
    const DataPtr d = makeData(m);
    mj_forward(m, d.get());
    for (const RecognisedPart& p : report_.parts) {
      if (p.part.find("thigh") == std::string::npos && p.part.find("arm") == std::string::npos) {
        continue;
      }
      const std::vector<int> joints = jointsBelow(m, p.bodies.at(0));
      const mjtNum* x = d->xanchor + 3 * joints.at(0);
      centres[k].emplace_back(x[0], x[1], x[2]);
    }
  }
  const auto length = [](const std::vector<Eigen::Vector3d>& c) {
    return 0.5 * (c.at(2) + c.at(3) - c.at(0) - c.at(1)).norm();
  };
  EXPECT_NEAR(length(centres[1]), length(centres[0]), 0.02 * length(centres[0]));
  for (const RecognisedPart& p : report_.parts) {
    if (p.part.find("thigh") == std::string::npos && p.part.find("arm") == std::string::npos) {
      continue;
    }
    const std::vector<int> before = jointsBelow(in_.get(), p.bodies.at(0));
    const std::vector<int> after = jointsBelow(out_.get(), p.bodies.at(0));
    ASSERT_EQ(after.size(), before.size());
    for (std::size_t i = 0; i < before.size(); i++) {
      EXPECT_EQ(out_->jnt_type[after[i]], in_->jnt_type[before[i]]);
      const char *x = mj_id2name(in_.get(), mjOBJ_JOINT, before[i]),
                 *y = mj_id2name(out_.get(), mjOBJ_JOINT, after[i]);
      EXPECT_STREQ(x ? x : "", y ? y : "");
    }
  }
}

TEST_P(GraftHosts, DropsWithoutWarnings) {
  GraftOptions o = options(write("in.xml", GetParam().text));
  o.groups = true;
  graft(anatomy(), o);
  const ModelPtr m = loadModel(at("out.xml"));
  const DataPtr d = makeData(m.get());
  drop(m.get(), d.get(), 0.3, 500);
  EXPECT_EQ(firstWarning(d.get()), "");
}

}  // namespace
}  // namespace torso::tools
