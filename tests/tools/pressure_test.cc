// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/pressure_study.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <set>

#include "tests/tools/command_fixture.h"
#include "tools/bone_files.h"
#include "tools/error.h"
#include "tools/muscle_arms.h"

namespace torso::tools {
namespace {

using Eigen::MatrixXd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

class Pressure : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    installHandlers();
    anatomy_ = new Anatomy(measuredMan(Anatomy::load(TORSO_ANATOMY_DIR)));
    skeleton_ = new Skeleton(
        readSkeleton(*anatomy_, std::string(TORSO_MJCF) + "/assets", bodyNames(*anatomy_)));
    body_ = new PosedBody(*anatomy_, *skeleton_);
    moments_ = new MuscleMoments(body_->model());
  }
  static void TearDownTestSuite() {
    delete moments_;
    delete body_;
    delete skeleton_;
    delete anatomy_;
  }
  static Activity activity(const std::string& name) {
    for (const Activity& a : readActivities(TORSO_ANATOMY_DIR)) {
      if (a.name == name) return a;
    }
    throw std::runtime_error("no activity " + name);
  }

  static Anatomy* anatomy_;
  static Skeleton* skeleton_;
  static PosedBody* body_;
  static MuscleMoments* moments_;
};
Anatomy* Pressure::anatomy_;
Skeleton* Pressure::skeleton_;
PosedBody* Pressure::body_;
MuscleMoments* Pressure::moments_;

double potentialEnergy(const mjModel* m, const mjData* d) {
  double energy = 0;
  for (int b = 1; b < m->nbody; b++) {
    energy -= m->body_mass[b] * mju_dot3(m->opt.gravity, d->xipos + 3 * b);
  }
  return energy;
}

// By virtual work: turn all that is above a disc about its centre, and a muscle of moment arm r
// grows shorter by r times the angle; weight loses energy by its moment times the angle.
TEST_F(Pressure, MomentsAreVirtualWork) {
  body_->take(activity("bent"));
  mjModel* m = body_->model();
  mjData* d = body_->data();
  const MatrixXd arms = moments_->arms(d);
  const std::vector<std::string> below[] = {{"pelvis"}, {"pelvis", "L5", "L4", "L3", "L2"}};
  const std::size_t cuts[] = {0, 4};  // L5/S1, L1/L2
  const Eigen::VectorXd weight = moments_->externalMoments(d);
  const double energy = potentialEnergy(m, d);
  const std::vector<mjtNum> qpos(d->qpos, d->qpos + m->nq);
  const std::vector<mjtNum> length(d->ten_length, d->ten_length + m->ntendon);
  constexpr double kAngle = 1e-6;
  for (int k = 0; k < 2; k++) {
    const Vector3d centre(d->site_xpos + 3 * moments_->cuts()[cuts[k]].site);
    for (int axis = 0; axis < 3; axis++) {
      const Quaterniond turn(Eigen::AngleAxisd(kAngle, Vector3d::Unit(axis)));
      for (int j = 0; j < m->njnt; j++) {
        if (m->jnt_type[j] != mjJNT_FREE) continue;
        const std::string name = nameOf(m, mjOBJ_BODY, m->jnt_bodyid[j]);
        if (std::count(below[k].begin(), below[k].end(), name)) continue;
        mjtNum* q = d->qpos + m->jnt_qposadr[j];
        const Vector3d p = centre + turn * (Vector3d(q) - centre);
        const Quaterniond r = turn * Quaterniond(q[3], q[4], q[5], q[6]);
        mju_copy3(q, p.data());
        q[3] = r.w(), q[4] = r.x(), q[5] = r.y(), q[6] = r.z();
      }
      mj_kinematics(m, d);
      mj_comPos(m, d);
      mj_tendon(m, d);
      EXPECT_NEAR((energy - potentialEnergy(m, d)) / kAngle, weight[3 * cuts[k] + axis], 1e-3);
      for (std::size_t i = 0; i < moments_->muscles().size(); i++) {
        const int tendon = m->actuator_trnid[2 * moments_->muscles()[i]];
        EXPECT_NEAR((length[tendon] - d->ten_length[tendon]) / kAngle, arms(3 * cuts[k] + axis, i),
                    1e-5)
            << m->names + m->name_tendonadr[tendon];
      }
      std::copy(qpos.begin(), qpos.end(), d->qpos);
    }
  }
}

// Or nearly: ranges are of a muscle's centroid in a scan, not of its fascicles.
TEST_F(Pressure, ArmsAreInThePublishedRanges) {
  constexpr double kNear = 0.005;
  body_->take(activity("standing"));
  for (const MuscleArm& a :
       measureArms(*anatomy_, TORSO_ANATOMY_DIR, body_->model(), body_->data(), *moments_)) {
    SCOPED_TRACE(a.muscle + " at " + a.disc);
    EXPECT_GT(a.behind, a.behind_low - kNear);
    EXPECT_LT(a.behind, a.behind_high + kNear);
    EXPECT_GT(a.beside, a.beside_low - kNear);
    EXPECT_LT(a.beside, a.beside_high + kNear);
  }
}

// In balance the muscles press on the disc what they pull across it, on top of the weight above;
// what the servos did is all but gone.
TEST_F(Pressure, MusclesCompressTheDiscsThatServosDoNot) {
  const ActivityLoads loads = measureActivity(*body_, *moments_, activity("hold_close"), true);
  const mjModel* m = body_->model();
  const mjData* d = body_->data();
  const double moment = std::abs(loads.servos.servo_moments[1]);
  EXPECT_GT(moment, 30);
  EXPECT_LT(std::abs(loads.muscles.servo_moments[1]), 0.1 * moment);
  // Pull along the disc's axis of each line that passes from above L4/L5 to below it.
  const Cut& cut = moments_->cuts()[1];
  const Vector3d axis(d->site_xmat[9 * cut.site + 2], d->site_xmat[9 * cut.site + 5],
                      d->site_xmat[9 * cut.site + 8]);
  const std::set<std::string> low = {"pelvis", "L5", "left_thigh", "right_thigh"};
  double pull = 0;
  for (const int muscle : moments_->muscles()) {
    const int tendon = m->actuator_trnid[2 * muscle];
    for (int k = 1; k < m->tendon_num[tendon]; k++) {
      int a = m->wrap_objid[m->tendon_adr[tendon] + k - 1],
          b = m->wrap_objid[m->tendon_adr[tendon] + k];
      const auto isLow = [&](int site) {
        return low.count(nameOf(m, mjOBJ_BODY, m->site_bodyid[site])) > 0;
      };
      if (isLow(a) == isLow(b)) continue;
      if (isLow(a)) std::swap(a, b);
      const Vector3d line = Vector3d(d->site_xpos + 3 * a) - Vector3d(d->site_xpos + 3 * b);
      pull += -d->actuator_force[muscle] * line.normalized().dot(axis);
    }
  }
  EXPECT_GT(pull, 400);
  const Balance& balance = loads.balance[1];
  EXPECT_NEAR(balance.muscle_pull, pull, 1e-6 * pull);
  // Facets and ligaments carry the difference.
  EXPECT_NEAR(loads.muscles.at("L4/L5").compression - loads.servos.at("L4/L5").compression,
              pull - balance.abdomen_push, 0.1 * pull);
  // The disc is in the posture of the tables: what it takes itself is small.
  EXPECT_LT(std::abs(balance.passive()), 0.2 * balance.external);
  EXPECT_GT(loads.muscles.at("L4/L5").nucleus_pressure,
            1.5 * loads.servos.at("L4/L5").nucleus_pressure);
}

// A line over the belly that is held to both bones would turn about and push them apart.
TEST_F(Pressure, NoMusclePushesTheBentSpine) {
  body_->take(activity("lift_back"));
  EXPECT_GT(moments_->pulls(body_->data()).minCoeff(), -0.1);
}

TEST_F(Pressure, MeasuredManHasHisMassAndDisc) {
  EXPECT_NEAR(anatomy_->mass(), 70, 1e-9);
  const mjModel* m = body_->model();
  const int disc = torso_discId(m, kMeasuredDisc);
  EXPECT_NEAR(body_->discArea(disc), 1800e-6, 1e-9);
  // The mesh that is simulated is as wide: 0.82 x width x depth is its area (model/disc.h).
  int nnode = 0, ntet = 0;
  ASSERT_EQ(torso_discSize(m, disc, &nnode, &ntet), 0);
  std::vector<mjtNum> nodes(3 * nnode);
  torso_discRest(m, disc, nodes.data());
  const DiscShape& shape = anatomy_->discs[disc].shape;
  double left = 0;
  for (std::size_t i = 1; i < nodes.size(); i += 3) left = std::max(left, nodes[i]);
  EXPECT_NEAR(2 * left, shape.width, 0.01 * shape.width);
  EXPECT_NEAR(0.82 * shape.width * shape.depth, 1800e-6, 10e-6);
}

// What lies on a bed is neither pulled nor pressed along the body: the disc that stands upright in
// it, L3/L4, carries nothing. What L4/L5 carries is the lean of that disc.
TEST_F(Pressure, BedDoesNotPullAlongTheBody) {
  for (const char* name : {"supine", "prone", "side"}) {
    const ActivityLoads loads = measureActivity(*body_, *moments_, activity(name), true);
    EXPECT_NEAR(loads.muscles.at("L3/L4").compression, 0, 4) << name;
  }
}

// The measured man against his body.
TEST_F(Pressure, IsTheMeasuredOne) {
  const std::set<std::string> near = {"standing", "hold_close", "hold_far"};
  std::vector<std::pair<double, double>> upright;  // measured, ours
  for (const Activity& a : readActivities(TORSO_ANATOMY_DIR)) {
    SCOPED_TRACE(a.name);
    const ActivityLoads loads = measureActivity(*body_, *moments_, a, true);
    const double ours = loads.muscles.at(kMeasuredDisc).pressureOnSubjectsArea();
    const double tolerance = near.count(a.name) ? 0.15 : 0.3;
    EXPECT_NEAR(ours / a.pressure, 1, tolerance);
    if (a.held == Held::kBed) continue;
    upright.emplace_back(a.pressure, ours);
    // Least in full flexion, where the spine itself carries most.
    EXPECT_GT(loads.muscles.at(kMeasuredDisc).compression,
              1.1 * loads.servos.at(kMeasuredDisc).compression);
    // Muscles are strong enough.
    for (const double moment : loads.muscles.servo_moments) EXPECT_LT(std::abs(moment), 4);
  }
  std::sort(upright.begin(), upright.end());
  for (std::size_t i = 1; i < upright.size(); i++) {
    EXPECT_GT(upright[i].second, upright[i - 1].second) << upright[i].first;
  }
}

TEST_F(Pressure, LoadsDoNotBendTheThorax) {
  const mjModel* m = body_->model();
  const mjData* d = body_->data();
  const auto turn = [&](const char* bone) {
    const mjtNum* q = d->xquat + 4 * mj_name2id(m, mjOBJ_BODY, bone);
    return Quaterniond(q[0], q[1], q[2], q[3]);
  };
  body_->take(activity("hold_far"));
  const Quaterniond posed = turn("T12").conjugate() * turn("T3");
  body_->settle();
  EXPECT_LT(posed.angularDistance(turn("T12").conjugate() * turn("T3")), 0.03);
}

TEST_F(Pressure, WhatIsDrawnWeighsNothing) {
  PosedBody drawn(*anatomy_, *skeleton_, std::string(TORSO_MJCF) + "/assets");
  EXPECT_NEAR(mj_getTotalmass(drawn.model()), mj_getTotalmass(body_->model()), 1e-9);
}

TEST_F(Pressure, RefusesImpossiblePoses) {
  const auto complaint = [](const Activity& a) -> std::string {
    try {
      body_->take(a);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(complaint(activity("hold_far")), "");
  Activity heavy = activity("hold_far"), far = heavy, bent = heavy;
  heavy.load = 100;
  far.load_distance = 0.8;
  bent.lumbar_flexion = 2;
  EXPECT_NE(complaint(heavy).find("hold_far: no lean"), std::string::npos) << complaint(heavy);
  EXPECT_NE(complaint(far).find("beyond the hands"), std::string::npos) << complaint(far);
  EXPECT_NE(complaint(bent).find("bends L5/S1"), std::string::npos) << complaint(bent);
}

// Mairiaux et al. 1984 and Cholewicki et al. 1997.
TEST(Trunk, FollowsPublishedPressureAndCoactivation) {
  EXPECT_EQ(abdominalPressure(10), 0);
  EXPECT_NEAR(abdominalPressure(100), 6.8e3, 50);
  EXPECT_DOUBLE_EQ(coactivation(0), 0.017);
  EXPECT_DOUBLE_EQ(coactivation(32), 0.029);
}

using PressureCommand = Command;

TEST_F(PressureCommand, NamesTheActivitiesThereAre) {
  const Result result = run("pressure --activity flying");
  EXPECT_NE(result.status, 0);
  EXPECT_NE(result.err.find("flying"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("hold_close"), std::string::npos) << result.err;
}

TEST_F(PressureCommand, StandsUnderItsWeightWithoutMuscles) {
  const Result result = run("pressure --activity standing --no-muscles --json");
  ASSERT_EQ(result.status, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  const auto& activity = json["activities"][0];
  EXPECT_FALSE(activity.contains("muscles"));
  // The tables' masses above L4/L5 are 35.4 kg or 347 N; the disc leans by 11 degrees.
  for (const auto& disc : activity["servos"]["discs"]) {
    if (disc["disc"] == "L4/L5") {
      EXPECT_NEAR(disc["compression_n"].get<double>(), 347, 20);
    }
  }
}

}  // namespace
}  // namespace torso::tools
