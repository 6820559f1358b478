// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/disc_field.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <random>

#include "model/disc_elasticity.h"
#include "model/disc_reference.h"

namespace torso {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

// Values of all sizes, none of which hides another; not those of a model.
constexpr DiscMaterial kMaterial = {3e5, 0.45, 4e7, 20, 0.5, 9e4, 3e7};
constexpr DiscShape kShape = {0.050, 0.035, 0.013, 0.009};

std::vector<Vector3d> deformed(const DiscMesh& mesh, const Matrix3d& F,
                               const Vector3d& shift = Vector3d::Zero()) {
  std::vector<Vector3d> x;
  for (const Vector3d& X : mesh.rest_positions) x.push_back(F * X + shift);
  return x;
}

std::vector<Vector3d> shaken(const DiscMesh& mesh, double amplitude, unsigned seed) {
  std::mt19937 rng(seed);
  std::normal_distribution<double> normal(0, amplitude);
  auto x = mesh.rest_positions;
  for (Vector3d& p : x) p += Vector3d(normal(rng), normal(rng), normal(rng));
  return x;
}

double volumeOf(const DiscMesh& mesh, const std::vector<Vector3d>& x, size_t e) {
  const auto& t = mesh.tets[e];
  return (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]).dot(x[t[3]] - x[t[0]]) / 6;
}

TEST(DiscField, RestIsWithoutStress) {
  const DiscMesh mesh = makeDiscMesh(kShape);
  for (const TetStress& s : discStress(mesh, kMaterial, mesh.rest_positions)) {
    EXPECT_LT(s.cauchy.norm(), 1e-6 * kMaterial.annulus_modulus);
    EXPECT_LT(s.piola.norm(), 1e-6 * kMaterial.annulus_modulus);
    EXPECT_LT((s.fibre_stretch - Eigen::Vector2d::Ones()).norm(), 1e-12);
  }
}

// A bar of Hooke's material under tension: stress E e along, none across.
TEST(DiscField, ColumnUnderASmallLoadObeysHooke) {
  const double E = 2e6, nu = 0.3, e = 1e-6;
  const DiscMesh mesh = makeDiscMesh(kShape);
  const Matrix3d F = Vector3d(1 - nu * e, 1 - nu * e, 1 + e).asDiagonal();
  for (const TetStress& s : discStress(mesh, homogeneousMaterial(E, nu), deformed(mesh, F))) {
    const Matrix3d expected = Vector3d(0, 0, E * e).asDiagonal();
    EXPECT_LT((s.cauchy - expected).norm(), 1e-5 * E * e);
    EXPECT_NEAR(vonMises(s.cauchy), E * e, 1e-5 * E * e);
    EXPECT_NEAR(pressure(s.cauchy), -E * e / 3, 1e-5 * E * e);
  }
}

// Principal stress of the neo-Hookean law with energy mu/2 (|F|^2 - 3) - mu (J - 1)
// + (lambda + mu)/2 (J - 1)^2, from its derivative with respect to the stretches.
TEST(DiscField, LargeStretchesObeyTheNeoHookeanLaw) {
  const double E = 2e6, nu = 0.3, mu = E / 2.6, lambda = E * nu / (1.3 * 0.4);
  const DiscMesh mesh = makeDiscMesh(kShape);
  const Vector3d stretch(1.3, 0.8, 0.7);
  const auto energy = [&](const Vector3d& s) {
    const double J = s.prod();
    return mu / 2 * (s.squaredNorm() - 3) - mu * (J - 1) + (lambda + mu) / 2 * (J - 1) * (J - 1);
  };
  Vector3d expected;
  for (int k = 0; k < 3; ++k) {
    const Vector3d h = 1e-5 * Vector3d::Unit(k);
    const double slope = (energy(stretch + h) - energy(stretch - h)) / 2e-5;
    expected[k] = slope * stretch[k] / stretch.prod();
  }
  const Matrix3d F = stretch.asDiagonal();
  for (const TetStress& s : discStress(mesh, homogeneousMaterial(E, nu), deformed(mesh, F))) {
    EXPECT_LT((s.cauchy - Matrix3d(expected.asDiagonal())).norm(), 1e-6 * E);
  }
}

// Squeezed alike from all sides: K times the loss of volume, no von Mises stress.
TEST(DiscField, PressureFromAllSidesIsTheBulkModulusTimesTheDilatation) {
  const DiscMesh mesh = makeDiscMesh(kShape);
  const double squeeze = 1e-6;  // by length
  const auto x = deformed(mesh, (1 - squeeze) * Matrix3d::Identity());
  const auto stress = discStress(mesh, kMaterial, x);
  const double annulus_bulk = kMaterial.annulus_modulus / (3 * (1 - 2 * kMaterial.annulus_poisson));
  for (size_t e = 0; e < stress.size(); ++e) {
    const double K =
        mesh.cells[e] == DiscMesh::kNucleus ? kMaterial.nucleus_bulk_modulus : annulus_bulk;
    EXPECT_NEAR(pressure(stress[e].cauchy), 3 * squeeze * K, 1e-4 * squeeze * K);
    EXPECT_LT(vonMises(stress[e].cauchy), 1e-4 * squeeze * K);
  }
}

TEST(DiscField, VonMisesOfTensionAndShear) {
  Matrix3d tension = Matrix3d::Zero(), shear = Matrix3d::Zero();
  tension(1, 1) = -7;
  shear(0, 2) = shear(2, 0) = 2;
  EXPECT_NEAR(vonMises(tension), 7, 1e-12);
  EXPECT_NEAR(vonMises(shear), 2 * std::sqrt(3), 1e-12);
  EXPECT_NEAR(vonMises(tension - 5 * Matrix3d::Identity()), 7, 1e-12);
  EXPECT_NEAR(pressure(tension), 7. / 3, 1e-12);
}

TEST(DiscField, StressTurnsWithTheDisc) {
  const DiscMesh mesh = makeDiscMesh(kShape);
  auto x = shaken(mesh, 2e-4, 1);
  const auto before = discStress(mesh, kMaterial, x);
  const Matrix3d R = Eigen::AngleAxisd(2, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  for (Vector3d& p : x) p = R * p + Vector3d(3, -1, 2);
  const auto after = discStress(mesh, kMaterial, x);
  for (size_t e = 0; e < before.size(); ++e) {
    const double scale = before[e].cauchy.norm();
    EXPECT_LT((after[e].cauchy - R * before[e].cauchy * R.transpose()).norm(), 1e-8 * scale);
    EXPECT_NEAR(vonMises(after[e].cauchy), vonMises(before[e].cauchy), 1e-8 * scale);
    EXPECT_LT((after[e].fibre_stretch - before[e].fibre_stretch).norm(), 1e-10);
  }
}

// Fibres at +-a to the hoop, disc stretched along its axis: both families by
// sqrt(cos^2 a + s^2 sin^2 a), and in the plane of hoop and axis their hoop tensions add up while
// their shears cancel.
TEST(DiscField, FibresOfAStretchedDisc) {
  const DiscMesh mesh = makeDiscMesh(kShape);
  const double s = 1.2, a = kMaterial.fibre_angle, J = s;
  const Matrix3d F = Vector3d(1, 1, s).asDiagonal();
  const double stretch = std::hypot(std::cos(a), s * std::sin(a)), e = stretch - 1;
  const double tension =
      kMaterial.fibre_modulus * (e + kMaterial.fibre_stiffening * e * e) / stretch;
  DiscMaterial without = kMaterial;
  without.fibre_modulus = 0;
  const auto all = discStress(mesh, kMaterial, deformed(mesh, F));
  const auto ground = discStress(mesh, without, deformed(mesh, F));
  int annulus = 0;
  for (size_t t = 0; t < all.size(); ++t) {
    const Matrix3d fibres = all[t].cauchy - ground[t].cauchy;
    if (mesh.cells[t] == DiscMesh::kNucleus) {
      EXPECT_EQ(fibres.norm(), 0);
      EXPECT_EQ(all[t].fibre_stretch, Eigen::Vector2d(1, 1));
      continue;
    }
    ++annulus;
    EXPECT_NEAR(all[t].fibre_stretch[0], stretch, 1e-12);
    EXPECT_NEAR(all[t].fibre_stretch[1], stretch, 1e-12);
    const auto& hoop = mesh.hoops[mesh.cells[t]];
    Vector3d h = mesh.rest_positions[hoop[1]] - mesh.rest_positions[hoop[0]];
    h.z() = 0;
    h.normalize();
    const double unit = 2 * tension / J;
    EXPECT_NEAR(h.dot(fibres * h), unit * std::pow(std::cos(a), 2), 1e-9 * unit);
    EXPECT_NEAR(fibres(2, 2), unit * std::pow(s * std::sin(a), 2), 1e-9 * unit);
    EXPECT_NEAR(h.dot(fibres.col(2)), 0, 1e-9 * unit);
  }
  EXPECT_GT(annulus, 300);
}

TEST(DiscField, SlackFibresBearNothing) {
  const DiscMesh mesh = makeDiscMesh(kShape);
  DiscMaterial without = kMaterial;
  without.fibre_modulus = 0;
  const auto x = deformed(mesh, 0.9 * Matrix3d::Identity());
  const auto all = discStress(mesh, kMaterial, x), ground = discStress(mesh, without, x);
  for (size_t t = 0; t < all.size(); ++t) EXPECT_EQ(all[t].cauchy, ground[t].cauchy);
}

// Against the solver's own energy: nodal forces of the stress in a shape without any symmetry.
TEST(DiscField, NodalForcesOfTheStressAreThoseOfTheEnergy) {
  const DiscMesh mesh = makeDiscMesh(kShape);
  const DiscElasticity elasticity(mesh, kMaterial);
  for (double amplitude : {1e-6, 3e-4}) {
    const auto x = shaken(mesh, amplitude, 2);
    VectorXd u(3 * x.size()), expected;
    for (size_t i = 0; i < x.size(); ++i) u.segment<3>(3 * i) = x[i] - mesh.rest_positions[i];
    elasticity.energy(u, &expected);

    const auto stress = discStress(mesh, kMaterial, x);
    VectorXd forces = VectorXd::Zero(u.size());
    for (size_t e = 0; e < stress.size(); ++e) {
      const auto& t = mesh.tets[e];
      Eigen::Matrix4d corners;  // their inverse holds the shape functions' coefficients
      for (int a = 0; a < 4; ++a) corners.col(a) << 1, mesh.rest_positions[t[a]];
      const Eigen::Matrix4d shape = corners.inverse();
      const double volume = volumeOf(mesh, mesh.rest_positions, e);
      for (int a = 0; a < 4; ++a) {
        const Vector3d gradient = shape.row(a).tail<3>();
        forces.segment<3>(3 * t[a]) -= volume * stress[e].piola * gradient;
      }
    }
    EXPECT_LT((forces - expected).norm(), 1e-7 * expected.norm()) << amplitude;
    EXPECT_GT(expected.norm(), 0);
  }
}

// Mean stress theorem: the integral of the Cauchy stress over a body in equilibrium is the sum of
// position x force over the places where forces act on it, here the nodes of the two endplates.
TEST(DiscField, IntegralOfTheCauchyStressIsThatOfTheEndplatesForces) {
  const DiscMesh mesh = makeDiscMesh(kShape);
  ReferenceDisc disc(mesh, kMaterial);
  DiscPose pose;
  pose.rotation = Eigen::AngleAxisd(0.06, Vector3d(0.3, 1, 0.2).normalized());
  pose.position = {0.0008, 0.0003, -0.0010};
  disc.solve(pose, 200, 1e-9);
  const auto& u = disc.displacements();
  VectorXd force;
  disc.elasticity().energy(u, &force);
  std::vector<Vector3d> x = mesh.rest_positions;
  Matrix3d expected = Matrix3d::Zero();
  for (size_t i = 0; i < x.size(); ++i) {
    x[i] += u.segment<3>(3 * i);
    // The bone holds the node against the disc's own force.
    expected -= x[i] * force.segment<3>(3 * i).transpose();
  }
  const auto stress = discStress(mesh, kMaterial, x);
  // Each tet takes the share of its cell's volume that it has at rest.
  std::vector<double> now(mesh.hoops.size() + 1, 0), at_rest = now;
  const auto cell = [&](size_t e) {
    return mesh.cells[e] == DiscMesh::kNucleus ? mesh.hoops.size() : mesh.cells[e];
  };
  for (size_t e = 0; e < stress.size(); ++e) {
    now[cell(e)] += volumeOf(mesh, x, e);
    at_rest[cell(e)] += volumeOf(mesh, mesh.rest_positions, e);
  }
  Matrix3d integral = Matrix3d::Zero();
  for (size_t e = 0; e < stress.size(); ++e) {
    EXPECT_LT((stress[e].cauchy - stress[e].cauchy.transpose()).norm(),
              1e-12 * stress[e].cauchy.norm());
    integral +=
        volumeOf(mesh, mesh.rest_positions, e) * now[cell(e)] / at_rest[cell(e)] * stress[e].cauchy;
  }
  EXPECT_GT(expected.norm(), 0.1);
  EXPECT_LT((integral - expected).norm(), 1e-7 * expected.norm()) << integral << "\n" << expected;
}

// In the nucleus the pressure is that of the fluid but for its faint shear stiffness.
TEST(DiscField, PressureInTheNucleusIsTheSolvers) {
  const DiscMesh mesh = makeDiscMesh(kShape);
  DiscMaterial material = kMaterial;
  material.nucleus_modulus = 1e3;
  ReferenceDisc disc(mesh, material);
  DiscPose pose;
  pose.position.z() = -0.0008;
  disc.solve(pose, 200, 1e-8);
  const double expected = disc.wrench().nucleus_pressure;
  const auto stress = discStress(mesh, material, disc.positions());
  EXPECT_GT(expected, 1e5);
  for (size_t e = 0; e < stress.size(); ++e) {
    if (mesh.cells[e] != DiscMesh::kNucleus) continue;
    EXPECT_NEAR(pressure(stress[e].cauchy), expected, 1e3);
  }
}

// A tet pushed inside out keeps a finite stress.
TEST(DiscField, InvertedTetsHaveAFiniteStress) {
  const DiscMesh mesh = makeDiscMesh(kShape);
  for (const TetStress& s :
       discStress(mesh, kMaterial, deformed(mesh, Vector3d(1, 1, -0.5).asDiagonal()))) {
    EXPECT_TRUE(s.cauchy.allFinite());
    EXPECT_TRUE(s.piola.allFinite());
  }
}

}  // namespace
}  // namespace torso
