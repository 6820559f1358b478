// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// The bodies with a fixed and a simple torso against the detailed one.

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <unistd.h>
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "tests/tools/shipped_anatomy.h"
#include "tools/build_models.h"
#include "tools/control_problem.h"
#include "tools/files.h"
#include "tools/mujoco_support.h"
#include "tools/task_scene.h"
#include "tools/torso_mjcf.h"

namespace torso::tools {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

ModelPtr human(TorsoKind kind, const std::string& anchored = "") {
  MjcfOptions options;
  options.limbs = true;
  options.bones = false;
  options.kind = kind;
  options.anchored = anchored;
  return compileModel(mjcfText(anatomy(), options), "human");
}

struct Whole {
  double mass = 0;
  Vector3d com = Vector3d::Zero();
  Matrix3d inertia = Matrix3d::Zero();  // about com
};

// Of the standing body.
Whole wholeOf(const mjModel* m) {
  const DataPtr d = makeData(m);
  mj_kinematics(m, d.get());
  Whole whole;
  const auto place = [&](int b) { return Vector3d(d->xipos + 3 * b); };
  for (int b = 1; b < m->nbody; b++) {
    whole.mass += m->body_mass[b];
    whole.com += m->body_mass[b] * place(b);
  }
  whole.com /= whole.mass;
  for (int b = 1; b < m->nbody; b++) {
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> R(d->ximat + 9 * b);
    const Vector3d r = place(b) - whole.com;
    whole.inertia += R * Vector3d(m->body_inertia + 3 * b).asDiagonal() * R.transpose() +
                     m->body_mass[b] * (r.squaredNorm() * Matrix3d::Identity() - r * r.transpose());
  }
  return whole;
}

std::vector<double> numbers(const mjtNum* x, int n) { return {x, x + n}; }

bool shoulder(const std::string& name) { return name.find("glenohumeral") != std::string::npos; }

// What each actuator on a limb's joint is, by name; of shoulders all but how far they go.
std::map<std::string, std::vector<double>> limbActuators(const mjModel* m) {
  std::map<std::string, std::vector<double>> all;
  for (int i = 0; i < m->nu; i++) {
    if (m->actuator_trntype[i] != mjTRN_JOINT) continue;
    const std::string name = nameOf(m, mjOBJ_ACTUATOR, i);
    const int joint = m->actuator_trnid[2 * i];
    std::vector<double>& values = all[name];
    for (const auto& part :
         {numbers(m->actuator_gear + 6 * i, 6), numbers(m->actuator_gainprm + mjNGAIN * i, 1),
          numbers(m->actuator_biasprm + mjNBIAS * i, 4), numbers(m->actuator_forcerange + 2 * i, 2),
          numbers(m->jnt_stiffness + joint, 1), numbers(m->jnt_pos + 3 * joint, 3),
          numbers(m->dof_damping + m->jnt_dofadr[joint], 1)}) {
      values.insert(values.end(), part.begin(), part.end());
    }
    if (shoulder(name)) continue;
    for (const mjtNum* range : {m->actuator_ctrlrange + 2 * i, m->jnt_range + 2 * joint}) {
      values.insert(values.end(), range, range + 2);
    }
  }
  return all;
}

// Place, size and bits of each geom that can touch, by name.
std::map<std::string, std::vector<double>> contactGeoms(const mjModel* m) {
  const DataPtr d = makeData(m);
  mj_kinematics(m, d.get());
  std::map<std::string, std::vector<double>> all;
  for (int g = 0; g < m->ngeom; g++) {
    if (!m->geom_contype[g] && !m->geom_conaffinity[g]) continue;
    std::vector<double>& values = all[nameOf(m, mjOBJ_GEOM, g)];
    values = numbers(d->geom_xpos + 3 * g, 3);
    // Of a capsule the axis; how it is turned about that is of no account.
    for (int k = 0; k < 3; k++) values.push_back(d->geom_xmat[9 * g + 3 * k + 2]);
    for (const auto& part : {numbers(m->geom_size + 3 * g, 3), numbers(m->geom_friction + 3 * g, 3),
                             numbers(m->geom_solref + mjNREF * g, mjNREF),
                             numbers(m->geom_solimp + mjNIMP * g, mjNIMP)}) {
      values.insert(values.end(), part.begin(), part.end());
    }
    values.push_back(m->geom_contype[g]);
    values.push_back(m->geom_conaffinity[g]);
  }
  return all;
}

// But for the digits of the file: a short capsule's axis turns by 1e-5.
void expectSame(const std::vector<double>& a, const std::vector<double>& b,
                const std::string& what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  for (std::size_t i = 0; i < a.size(); i++) EXPECT_NEAR(a[i], b[i], 1e-5) << what << " " << i;
}

// Pairs of geoms that touch when hips and arms are turned far over the trunk.
std::set<std::pair<std::string, std::string>> folded(const mjModel* m) {
  const DataPtr d = makeData(m);
  std::set<std::pair<std::string, std::string>> all;
  for (const double degrees : {-60., -110., -150.}) {
    for (const char* joint : {"left_hip", "right_hip", "left_glenohumeral", "right_glenohumeral"}) {
      const mjtNum axis[3] = {0, joint[std::strlen(joint) - 1] == 'p' ? 1. : -0.4, 0};
      mju_axisAngle2Quat(d->qpos + m->jnt_qposadr[mj_name2id(m, mjOBJ_JOINT, joint)], axis,
                         degrees * M_PI / 180);
    }
    mj_fwdPosition(m, d.get());
    for (int i = 0; i < d->ncon; i++) {
      std::string one = nameOf(m, mjOBJ_GEOM, d->contact[i].geom1);
      std::string two = nameOf(m, mjOBJ_GEOM, d->contact[i].geom2);
      if (d->contact[i].dist > 0 || one.find("collision") == std::string::npos) continue;
      if (two < one) std::swap(one, two);
      all.insert({one, two});
    }
  }
  return all;
}

class TorsoKinds : public testing::TestWithParam<TorsoKind> {
 protected:
  const ModelPtr detailed_ = human(TorsoKind::kDetailed), m_ = human(GetParam());
};

// The file has 7 digits; a moment of inertia is 0.1 to 14 kg m^2.
TEST_P(TorsoKinds, HaveTheSameMassAndInertia) {
  const Whole a = wholeOf(detailed_.get()), b = wholeOf(m_.get());
  EXPECT_NEAR(a.mass, anatomy().mass(), 1e-5);
  EXPECT_NEAR(b.mass, a.mass, 1e-5);
  EXPECT_LT((b.com - a.com).norm(), 1e-6);
  EXPECT_LT((b.inertia - a.inertia).norm(), 1e-5 * a.inertia.norm());
}

// Head, arms from the shoulder and legs: joints, servos and their gains.
TEST_P(TorsoKinds, HaveTheSameLimbs) {
  const auto theirs = limbActuators(detailed_.get()), ours = limbActuators(m_.get());
  int limbs = 0;
  for (const auto& [name, values] : theirs) {
    const bool girdle = name.find("clavicular") != std::string::npos;
    ASSERT_EQ(ours.count(name), girdle ? 0u : 1u) << name;
    if (girdle) continue;
    expectSame(ours.at(name), values, name);
    limbs++;
  }
  EXPECT_EQ(limbs, 3 + 2 * (9 + 9));
  const int trunk = GetParam() == TorsoKind::kSimple ? 9 : 0;
  EXPECT_EQ(static_cast<int>(ours.size()), limbs + trunk);
  EXPECT_EQ(m_->nu, limbs + trunk);
}

TEST_P(TorsoKinds, HaveTheSameContacts) {
  const auto theirs = contactGeoms(detailed_.get()), ours = contactGeoms(m_.get());
  ASSERT_EQ(ours.size(), theirs.size());
  for (const auto& [name, values] : theirs) {
    ASSERT_EQ(ours.count(name), 1u) << name;
    expectSame(ours.at(name), values, name);
  }
  // Limbs meet the same parts of the trunk, however it is cut into bodies.
  EXPECT_EQ(folded(m_.get()), folded(detailed_.get()));
  EXPECT_GT(folded(detailed_.get()).size(), 4u);
  // And the standing body touches nothing of itself.
  for (const mjModel* m : {detailed_.get(), m_.get()}) {
    const DataPtr d = makeData(m);
    mj_fwdPosition(m, d.get());
    EXPECT_EQ(d->ncon, 0);
  }
}

// How the body hangs from the bar of `torso optimize swing` before anything has moved, and what it
// does there while nothing is commanded.
struct Hang {
  double arm;      // turn of the left upper arm against the chest [deg]
  double lean;     // of the chest against the vertical [deg]
  double forward;  // centre of mass before the bar [m]
  double drift;    // of the centre of mass within the horizon [m]
};

Hang hang(TorsoKind kind) {
  MjcfOptions options;
  options.limbs = true;
  options.bones = false;
  options.kind = kind;
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("hang{}", getpid());
  const std::string path = folder / humanFile(kind);
  writeFiles({{path, mjcfText(anatomy(), options)}});
  const Task task = findTask("swing");
  const ModelPtr m = compileModel(sceneMjcf(path, task.scene, "."), path);
  std::filesystem::remove_all(folder);
  const ControlProblem problem(m.get(), task, path, 1);
  const Motion motion = problem.trajectory(std::vector<double>(problem.size(), 0)).motion;

  const DataPtr d = makeData(m.get());
  const auto id = [&](const char* body) { return mj_name2id(m.get(), mjOBJ_BODY, body); };
  const int chest = id("ribcage") < 0 ? id("pelvis") : id("ribcage");
  const auto turn = [&](int body) {
    const mjtNum* q = d->xquat + 4 * body;
    return Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
  };
  const auto place = [&](std::size_t frame) {
    mju_copy(d->qpos, motion.qpos.data() + frame * m->nq, m->nq);
    mj_kinematics(m.get(), d.get());
    mj_comPos(m.get(), d.get());
    return Vector3d(d->subtree_com);
  };
  mj_kinematics(m.get(), d.get());
  const auto chest0 = turn(chest), arm0 = chest0.conjugate() * turn(id("left_upper_arm"));
  const Vector3d end = place(motion.frames() - 1), start = place(0);
  const auto lean = turn(chest) * chest0.conjugate();
  constexpr double kDegree = M_PI / 180;
  return {(turn(chest).conjugate() * turn(id("left_upper_arm"))).angularDistance(arm0) / kDegree,
          std::acos((lean * Vector3d::UnitZ()).z()) / kDegree, start.x() - d->xpos[3 * id("bar")],
          (end - start).norm()};
}

// Where clavicle and scapula do not move, the shoulder joint makes up for them: on the bar the arms
// reach overhead as the detailed body's do, and nobody has a head start.
TEST_P(TorsoKinds, HangStraight) {
  const Hang theirs = hang(TorsoKind::kDetailed), ours = hang(GetParam());
  EXPECT_NEAR(ours.arm, theirs.arm, 20);
  EXPECT_LT(ours.lean, theirs.lean);
  for (const Hang& h : {theirs, ours}) {
    EXPECT_NEAR(h.forward, 0, 0.02);
    EXPECT_LT(h.drift, 0.02);
  }
}

INSTANTIATE_TEST_SUITE_P(All, TorsoKinds, testing::Values(TorsoKind::kFixed, TorsoKind::kSimple));

// Held by its pelvis the trunk stands on its servos, as the detailed one does: it leans by what the
// weight's moment about the lowest joint needs, some degrees at most, and comes to rest.
TEST(SimpleTorso, StandsOnItsServos) {
  const ModelPtr m = human(TorsoKind::kSimple, "pelvis");
  const DataPtr d = makeData(m.get());
  const auto tilt = [&] {
    const int cage = mj_name2id(m.get(), mjOBJ_BODY, "ribcage");
    return std::acos(d->xmat[9 * cage + 8]) * 180 / M_PI;
  };
  while (d->time < 2) mj_step(m.get(), d.get());
  EXPECT_LT(tilt(), 3);
  const int thoracic = m->jnt_dofadr[mj_name2id(m.get(), mjOBJ_JOINT, "thoracic")];
  EXPECT_LT(std::abs(d->qvel[thoracic + 1]), 0.01);
  // A command to bend bends it: half the range forward, most of which it reaches.
  const int flexion = mj_name2id(m.get(), mjOBJ_ACTUATOR, "lumbar_flexion");
  d->ctrl[flexion] = m->actuator_ctrlrange[2 * flexion + 1] / 2;
  const double before = tilt();
  while (d->time < 4) mj_step(m.get(), d.get());
  EXPECT_GT(tilt() - before, 0.7 * d->ctrl[flexion] * 180 / M_PI) << "from " << before << " deg";
}

}  // namespace
}  // namespace torso::tools
