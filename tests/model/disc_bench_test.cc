// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/disc_bench.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "model/disc_reference.h"

namespace torso {
namespace {

using Eigen::Vector3d;
using Quantity = DiscTest::Quantity;

constexpr double kDegree = M_PI / 180;
constexpr DiscShape kShape = {0.048, 0.034, 0.014, 0.007};  // wedged, L4/L5-like
constexpr DiscMaterial kMaterial = {2.5e6, 0.4, 10e6, 10, 30 * kDegree, 0.3e6, 100e6};

DiscBench bench() { return DiscBench(makeDiscMesh(kShape), kMaterial); }

// Forces, and moments over a length of the disc's size: comparable numbers.
Vector6d scaled(Vector6d load) {
  load.tail<3>() /= 0.02;
  return load;
}

// Motion in equal steps with rest as the reference, without the kink that fibres make there.
Matrix6d withoutFibres() {
  DiscMaterial soft = kMaterial;
  soft.fibre_modulus = 0;
  return stiffnessMatrix(DiscBench(makeDiscMesh(kShape), soft), 1e-7);
}

TEST(DiscBench, BearsTheLoadAsked) {
  DiscBench disc = bench();
  for (const Vector6d& load : {Vector6d{0, 0, -1000, 0, 0, 0}, Vector6d{80, -40, -300, 2, 3, -2},
                               Vector6d{0, 0, 0, 0, 5, 0}, Vector6d{0, 0, 400, 0, 0, 0}}) {
    disc.setLoad(load);
    EXPECT_LT(scaled(disc.load() - load).norm(), 1e-6);
  }
}

// The converged plain solver, moved to the pose that the bench found, gives the opposite wrench.
TEST(DiscBench, AgreesWithTheReferenceSolver) {
  DiscBench disc = bench();
  const Vector6d load{60, 30, -500, 2, 4, 1};
  disc.setLoad(load);
  ReferenceDisc reference(makeDiscMesh(kShape), kMaterial, ReferenceDisc::Method::kNewton);
  reference.solve(disc.pose(), 200, 1e-9);
  const DiscWrench w = reference.wrench();
  Vector6d answer;
  answer << w.force, w.moment - disc.pose().position.cross(w.force);
  EXPECT_LT(scaled(answer + load).norm(), 1e-5);
  EXPECT_NEAR(disc.nucleusPressure(), w.nucleus_pressure, 1e-5 * w.nucleus_pressure);
}

TEST(DiscBench, HeldMotionsStay) {
  DiscBench disc = bench();
  disc.setLoad({0, 0, -600, 0, 0, 0}, kHoldRotation);
  EXPECT_LT(disc.displacement().tail<3>().norm(), 1e-12);
  EXPECT_NEAR(disc.load()[2], -600, 1e-6);
  EXPECT_GT(std::abs(disc.load()[4]), 1e-3);  // the reaction of a wedge
}

// Without Poisson effect a column under compression has F = diag(1, 1, 1 + e): E A / h throughout;
// a nucleus of the same material makes no difference.
TEST(DiscBench, ColumnHasClosedForm) {
  const double E = 3e6, h = 0.011;
  const DiscMesh mesh = makeDiscMesh({0.05, 0.035, h, h});
  const DiscBench column(mesh, homogeneousMaterial(E, 0));
  const double A = upperEndplateArea(mesh);
  EXPECT_NEAR(stiffnessMatrix(column, 1e-7)(2, 2), E * A / h, 1e-5 * E * A / h);
  EXPECT_NEAR(column.tangent()(2, 2), E * A / h, 1e-9 * E * A / h);
}

TEST(DiscBench, StiffnessIsSymmetricAndPositive) {
  DiscBench disc = bench();
  disc.setLoad({0, 0, -400, 0, 0, 0});
  const Matrix6d K = disc.tangent();
  Vector6d scale;
  scale << 1, 1, 1, 0.02, 0.02, 0.02;
  const Matrix6d S = scale.cwiseInverse().asDiagonal() * K * scale.cwiseInverse().asDiagonal();
  EXPECT_LT((S - S.transpose()).norm(), 1e-8 * S.norm());
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6d>(S).eigenvalues()[0], 0);
}

// Away from the kink at rest, small displacements and the derivative are the same.
TEST(DiscBench, SmallDisplacementsGiveTheTangent) {
  DiscBench disc = bench();
  disc.setLoad({0, 0, -400, 0, 0, 0});
  const Matrix6d K = disc.tangent(), D = stiffnessMatrix(disc, 1e-7);
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      EXPECT_NEAR(D(i, j), K(i, j), 2e-4 * std::sqrt(K(i, i) * K(j, j))) << i << j;
    }
  }
}

TEST(DiscBench, SlopeAtZeroLoadIsTheTangent) {
  DiscMaterial material = kMaterial;
  material.fibre_modulus = 0;
  const DiscBench disc(makeDiscMesh(kShape), material);
  const Matrix6d compliance = withoutFibres().inverse();
  for (const auto& [quantity, dof] : {std::pair{Quantity::kFlexion, 4},
                                      {Quantity::kLateralBending, 3},
                                      {Quantity::kAxialTorsion, 5}}) {
    const DiscCurve curve = loadDisc(disc, discProtocol(Region::kLumbar, quantity), 1e-3, 0, 1);
    EXPECT_NEAR(curve.displacement.back() / 1e-3, compliance(dof, dof),
                1e-3 * compliance(dof, dof));
  }
}

// The mirror about the sagittal plane: y, rotations about x and z turn their sign.
TEST(DiscBench, MirroredLoadsGiveMirroredMotions) {
  const Vector6d mirror{1, -1, 1, -1, 1, -1}, load{50, 60, -300, 2, 1, 3};
  DiscBench one = bench(), other = bench();
  one.setLoad(load);
  other.setLoad(mirror.cwiseProduct(load));
  EXPECT_LT((one.displacement() - mirror.cwiseProduct(other.displacement())).norm(), 1e-8);
}

// The two bones seen from the upper one: the pose inverted is held by the opposite wrench, and the
// whole may be turned in space with it.
TEST(DiscBench, EnergyDoesNotDependOnTheFrame) {
  const DiscMesh mesh = makeDiscMesh(kShape);
  DiscMesh turned = mesh;  // by half a turn about x: upper and lower bone change places
  for (auto& p : turned.rest_positions) p = Vector3d(p.x(), -p.y(), -p.z());
  std::swap(turned.lower_nodes, turned.upper_nodes);
  const DiscBench one(mesh, kMaterial), other(turned, kMaterial);
  const Matrix6d A = stiffnessMatrix(one), B = stiffnessMatrix(other);
  // Of the motion of the other bone, seen in axes turned by half a turn about x.
  const Vector6d sign{1, -1, -1, 1, -1, -1};
  const Matrix6d expected = sign.asDiagonal() * B * sign.asDiagonal();
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      EXPECT_NEAR(A(i, j), expected(i, j), 1e-3 * std::sqrt(A(i, i) * A(j, j))) << i << j;
    }
  }
}

TEST(DiscBench, CurvesRiseAndStartAtRest) {
  for (Quantity quantity : {Quantity::kCompression, Quantity::kTension, Quantity::kAnteriorShear,
                            Quantity::kLateralShear, Quantity::kFlexion, Quantity::kAxialTorsion}) {
    const double top = quantity < Quantity::kFlexion ? 150 : 5;
    const DiscCurve curve = loadDisc(bench(), discProtocol(Region::kLumbar, quantity), top, 0, 4);
    ASSERT_EQ(curve.load.size(), 5u);
    EXPECT_EQ(curve.displacement[0], 0);
    for (int i = 1; i < 5; ++i) EXPECT_GT(curve.displacement[i], curve.displacement[i - 1]);
  }
}

TEST(DiscBench, NucleusPressureBalancesPartOfTheLoad) {
  const DiscCurve curve =
      loadDisc(bench(), discProtocol(Region::kLumbar, Quantity::kPressure), 1000, 0, 1);
  const double mean = 1000 / upperEndplateArea(makeDiscMesh(kShape));
  EXPECT_GT(curve.nucleus_pressure.back(), mean);
  EXPECT_LT(curve.nucleus_pressure.back(), mean / 0.43);  // all of the load on the nucleus alone
}

TEST(DiscBench, DiscThatIsFarTooSoftGivesWay) {
  DiscMaterial jelly = kMaterial;
  jelly.annulus_modulus = jelly.nucleus_modulus = 10;
  jelly.fibre_modulus = 0;
  DiscBench disc(makeDiscMesh(kShape), jelly);
  EXPECT_THROW(disc.setLoad({0, 0, 0, 0, 50, 0}), DiscGaveWay);
}

TEST(DiscBench, WhatIsNoLoadingHasNoProtocol) {
  EXPECT_THROW(discProtocol(Region::kLumbar, Quantity::kLossFactor), std::invalid_argument);
}

}  // namespace
}  // namespace torso
