// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/muscle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <stdexcept>

#include "model/muscle_stress.h"
#include "model/person.h"

namespace torso {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

const Anatomy& tables() {
  static const Anatomy anatomy = Anatomy::load(TORSO_ANATOMY_DIR);
  return anatomy;
}

TEST(Muscle, AttachmentsAreAtTheirBones) {
  const Skeleton skeleton(tables(), {"pelvis", "ribcage", "L5", "L3", "L1", "T9"}, 2);
  int checked = 0;
  for (const MuscleLine& line : makeMuscles(tables())) {
    for (const MusclePoint& p : line.points) {
      if (!p.on_bone || !skeleton.has(p.body)) continue;
      EXPECT_LT(skeleton.whole(p.body).nearest(p.position).distance, 0.010)
          << line.name << " on " << p.body;
      checked++;
    }
  }
  EXPECT_GT(checked, 100);
}

TEST(Muscle, SidesMirrorEachOther) {
  const std::vector<MuscleLine> lines = makeMuscles(tables());
  ASSERT_EQ(lines.size(), 2 * tables().muscles.size());
  for (std::size_t i = 0; i < lines.size(); i += 2) {
    ASSERT_EQ(lines[i].points.size(), lines[i + 1].points.size());
    for (std::size_t k = 0; k < lines[i].points.size(); k++) {
      const Vector3d left = lines[i].points[k].position;
      EXPECT_GT(left.y(), 0) << lines[i].name;
      EXPECT_TRUE(lines[i + 1].points[k].position.isApprox(mirror(left)));
    }
  }
}

// Bogduk et al. 1992: 27.9 cm2 of erector spinae on a side; multifidus by Stokes and
// Gardner-Morse: 10.6.
TEST(Muscle, SectionsAddUpToThePublishedTotals) {
  std::map<std::string, double> sums;
  for (const Muscle& muscle : tables().muscles) sums[muscle.group] += muscle.section;
  EXPECT_NEAR(sums["longissimus_thoracis"] + sums["iliocostalis_lumborum"], 27.9e-4, 1e-4);
  EXPECT_NEAR(sums["multifidus"], 10.6e-4, 1e-4);
}

TEST(Muscle, GoesWithThePerson) {
  Person person;
  person.stature = 1.87;
  person.mass = 80;
  const Anatomy tall = personalAnatomy(tables(), person);
  const std::vector<MuscleLine> ours = makeMuscles(tables()), theirs = makeMuscles(tall);
  const double length = 1.87 / 1.70;
  for (std::size_t i = 0; i < ours.size(); i++) {
    for (std::size_t k = 0; k < ours[i].points.size(); k++) {
      EXPECT_LT((theirs[i].points[k].position - length * ours[i].points[k].position).norm(), 0.004)
          << ours[i].name;
    }
    EXPECT_NEAR(theirs[i].section / ours[i].section, 80. / 72 / length, 1e-3);
  }
}

TEST(Muscle, NamesTheSiteThatDoesNotExist) {
  Anatomy anatomy = tables();
  anatomy.muscles[0].sites[0] = "elbow:L3";
  try {
    makeMuscles(anatomy);
    FAIL();
  } catch (const std::runtime_error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr(anatomy.muscles[0].name));
    EXPECT_THAT(e.what(), testing::HasSubstr("'elbow:L3'"));
  }
}

// Two extensors share as arm times section squared: the minimum of f1^2/s1^2 + f2^2/s2^2 with
// r1 f1 + r2 f2 = b.
TEST(LeastStress, TwoMusclesShareByArmAndSection) {
  MatrixXd A(1, 2);
  A << 0.05, 0.03;
  const VectorXd s = Eigen::Vector2d(4e-4, 8e-4), b = VectorXd::Constant(1, 10);
  const VectorXd f = leastStressForces(A, b, s, 1e6);
  EXPECT_NEAR(f[0] / f[1], (0.05 * 16) / (0.03 * 64), 1e-6);
  EXPECT_NEAR((A * f)[0], 10, 0.02);
}

// No small change that muscles can make lowers the cost.
TEST(LeastStress, IsTheLeastAmongRandomNeighbours) {
  srand(1);
  const int moments = 6, muscles = 40;
  const MatrixXd A = 0.06 * MatrixXd::Random(moments, muscles);
  const VectorXd s = 2e-4 * (VectorXd::Random(muscles).array() + 1.2);
  const double stress = 1e6;
  // The last cannot be had.
  for (const double size : {5., 20., 500.}) {
    const VectorXd b = size * VectorXd::Random(moments);
    const auto cost = [&](const VectorXd& f) {
      return (f.cwiseQuotient(s) / stress).squaredNorm() + (A * f - b).squaredNorm();
    };
    const VectorXd f = leastStressForces(A, b, s, stress);
    EXPECT_GE(f.minCoeff(), 0);
    EXPECT_LE((f - stress * s).maxCoeff(), 1e-9);
    for (int k = 0; k < 2000; k++) {
      const VectorXd g = (f + std::pow(10., -(k % 4)) * VectorXd::Random(muscles))
                             .cwiseMax(0)
                             .cwiseMin(stress * s);
      EXPECT_GE(cost(g), cost(f) * (1 - 1e-9)) << size;
    }
  }
}

}  // namespace
}  // namespace torso
