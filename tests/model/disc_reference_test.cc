// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/disc_reference.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "model/disc_elasticity.h"
#include "tests/model/disc_test_util.h"

namespace torso {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Metric = ReferenceDisc::Metric;

Matrix3d randomMatrix(std::mt19937& rng, double scale) {
  std::normal_distribution<double> normal;
  Matrix3d m;
  for (int i = 0; i < 9; ++i) m(i) = scale * normal(rng);
  return m;
}

Matrix3d randomRotation(std::mt19937& rng) {
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(rng), normal(rng), normal(rng), normal(rng))
      .normalized()
      .toRotationMatrix();
}

// ---- local projections ----

TEST(DiscProjection, NoRotationIsNearer) {
  std::mt19937 rng(1);
  int inverted = 0;
  for (int i = 0; i < 100; ++i) {
    const Matrix3d F = Matrix3d::Identity() + randomMatrix(rng, i % 2 ? 0.3 : 2);
    inverted += F.determinant() < 0;
    const Matrix3d R = project(F).rotation;
    EXPECT_NEAR(R.determinant(), 1, 1e-12);
    EXPECT_LT((R.transpose() * R - Matrix3d::Identity()).norm(), 1e-12);
    for (int k = 0; k < 300; ++k) {
      Matrix3d Q = randomRotation(rng);
      if (k % 2) {  // near R
        Q = R * Eigen::AngleAxisd(0.05, Q.col(0)).toRotationMatrix();
      }
      EXPECT_GE((F - Q).norm(), (F - R).norm());
    }
  }
  EXPECT_GT(inverted, 10);
}

// Least squared distance from s to p1 p2 p3 = 1 over a fine grid of p1, p2 of either sign.
double gridDistance(const Vector3d& s) {
  double best = 1e9;
  const auto distance = [&](double p, double q) {
    return (Vector3d(p, q, 1 / (p * q)) - s).squaredNorm();
  };
  double p0 = 1, q0 = 1;
  for (int i = -400; i <= 400; ++i) {
    for (int j = -400; j <= 400; ++j) {
      if (i == 0 || j == 0) continue;
      const double d = distance(0.01 * i, 0.01 * j);
      if (d < best) {
        best = d;
        p0 = 0.01 * i;
        q0 = 0.01 * j;
      }
    }
  }
  for (double h = 0.01; h > 1e-7; h /= 2) {
    for (bool moved = true; moved;) {
      moved = false;
      for (int a = -1; a <= 1; ++a) {
        for (int b = -1; b <= 1; ++b) {
          const double d = distance(p0 + a * h, q0 + b * h);
          if (d < best - 1e-15) {
            best = d;
            p0 += a * h;
            q0 += b * h;
            moved = true;
          }
        }
      }
    }
  }
  return best;
}

TEST(DiscProjection, NoMatrixOfUnitDeterminantIsNearer) {
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < 60; ++i) {
    // Singular values from crushed and inverted to blown up.
    Vector3d s(uniform(rng), uniform(rng), uniform(rng));
    s *= i % 3 == 0 ? 3.3 : 1.6;
    std::sort(s.data(), s.data() + 3, std::greater<double>());
    if (i % 2) s[2] = -s[2];
    const Vector3d p = nearestUnitProduct(s);
    EXPECT_NEAR(p.prod(), 1, 1e-9);
    EXPECT_LE((p - s).squaredNorm(), gridDistance(s) + 1e-6) << s.transpose();
  }
  for (int i = 0; i < 100; ++i) {
    const Matrix3d F = Matrix3d::Identity() + randomMatrix(rng, i % 2 ? 0.2 : 1);
    const Matrix3d P = project(F).isochoric;
    EXPECT_NEAR(P.determinant(), 1, 1e-9);
    for (int k = 0; k < 200; ++k) {
      Matrix3d Q = P * (Matrix3d::Identity() + randomMatrix(rng, k % 2 ? 0.02 : 0.3));
      const double det = Q.determinant();
      if (det < 1e-3) continue;
      Q /= std::cbrt(det);
      EXPECT_GE((F - Q).norm(), (F - P).norm() - 1e-9);
    }
  }
}

TEST(DiscProjection, MatricesOnTheSetsStay) {
  std::mt19937 rng(3);
  const Matrix3d R = randomRotation(rng);
  EXPECT_LT((project(R).rotation - R).norm(), 1e-14);
  EXPECT_LT((project(R).isochoric - R).norm(), 1e-9);
  const Matrix3d P = R * Vector3d(1.3, 0.8, 1 / 1.04).asDiagonal();
  EXPECT_LT((project(P).isochoric - P).norm(), 1e-9);
}

// ---- material law ----

// A column whose sides bulge freely has F = diag(1, 1, 1 + e) for nu = 0.
TEST(ReferenceDisc, ColumnWithoutPoissonEffectHasClosedForm) {
  const double E = 3e6, h = 0.011;
  const DiscMesh mesh = makeDiscMesh({0.05, 0.035, h, h});
  const double A = upperEndplateArea(mesh);
  for (Metric metric : {Metric::kProjective, Metric::kRestHessian}) {
    ReferenceDisc disc(mesh, {E, 0}, metric);
    EXPECT_NEAR(disc.restStiffness()(2, 2), E * A / h, 1e-9 * E * A / h);
    for (double strain : {-0.3, -0.01, 0.2}) {
      disc.solve(discPose(Vector3d::Zero(), {0, 0, strain * h * 1e3}), 5000, 1e-9);
      const DiscWrench w = disc.wrench();
      EXPECT_NEAR(w.force.z(), -E * A * strain, 1e-6 * E * A);
      EXPECT_NEAR(w.force.head<2>().norm(), 0, 1e-6 * E * A);
      EXPECT_NEAR(w.pressure, -E * strain, 1e-6 * E);
      EXPECT_NEAR(disc.energy(), E * A * h * strain * strain / 2, 1e-9 * E * A * h);
    }
  }
}

// Under the small strain (-nu, -nu, 1) e, Hooke's law has only the axial stress E e: the forces on
// the endplates are E e A and the free surface and the interior carry none.
TEST(ReferenceDisc, UniaxialStressRecoversModulusAndPoissonsRatio) {
  const DiscMesh mesh = makeDiscMesh(kLumbarShape);
  const double A = upperEndplateArea(mesh), E = 4e6, e = 1e-6;
  for (double nu : {0.0, 0.2, 0.3, 0.45, 0.49}) {
    const DiscElasticity elasticity(mesh, {E, nu});
    VectorXd u(3 * mesh.rest_positions.size()), f;
    for (size_t i = 0; i < mesh.rest_positions.size(); ++i) {
      u.segment<3>(3 * i) = e * Vector3d(-nu, -nu, 1).cwiseProduct(mesh.rest_positions[i]);
    }
    elasticity.forces(mesh, u, &f);
    double force = 0;
    for (int i : mesh.upper_nodes) force += f[3 * i + 2];
    EXPECT_NEAR(-force / (A * e), E, 1e-4 * E) << nu;
    double stray = 0;
    for (int i : elasticity.free_nodes) stray = std::max(stray, f.segment<3>(3 * i).norm());
    EXPECT_LT(stray, 1e-4 * E * A * e) << nu;
  }
}

TEST(ReferenceDisc, StretchedTetHasTheEnergyOfTheFormula) {
  // F = diag(1.1, 1, 1): R = I; the nearest unit-determinant P by Newton's method on l.
  DiscMesh mesh = makeDiscMesh(kLumbarShape);
  const DiscElasticity elasticity(mesh, kDiscMaterial);
  double l = 0;
  const auto root = [&](double s) { return (s + std::sqrt(s * s + 4 * l)) / 2; };
  for (int i = 0; i < 50; ++i) {
    const double product = root(1.1) * root(1) * root(1);
    const double slope = product * (1 / (root(1.1) * std::sqrt(1.21 + 4 * l)) +
                                    2 / (root(1) * std::sqrt(1 + 4 * l)));
    l -= (product - 1) / slope;
  }
  const double distance = std::pow(root(1.1) - 1.1, 2) + 2 * std::pow(root(1) - 1, 2);
  VectorXd u = VectorXd::Zero(3 * mesh.rest_positions.size()), f;
  double volume = 0;
  for (size_t i = 0; i < mesh.rest_positions.size(); ++i) {
    u[3 * i] = 0.1 * mesh.rest_positions[i].x();
  }
  for (double v : elasticity.volume) volume += v;
  const double expected = volume * (elasticity.mu * 0.01 + elasticity.kappa / 2 * distance);
  EXPECT_NEAR(elasticity.forces(mesh, u, &f), expected, 1e-9 * expected);
}

// ---- solver ----

TEST(ReferenceDisc, RestHasNoForce) {
  for (const DiscShape& shape : discShapes()) {
    ReferenceDisc disc(makeDiscMesh(shape), kDiscMaterial);
    EXPECT_EQ(disc.solve(DiscPose(), 10, 1e-9), 0);
    EXPECT_LT(disc.wrench().force.norm(), 1e-7);
    EXPECT_LT(disc.wrench().moment.norm(), 1e-9);
  }
}

const DiscPose kPose = discPose({3, 5, -4}, {0.6, -0.4, -0.7});

TEST(ReferenceDisc, WrenchIsMinusTheGradientOfTheEnergy) {
  const DiscMesh mesh = makeDiscMesh({0.036, 0.028, 0.010, 0.007}, 2, 3);
  ReferenceDisc disc(mesh, kDiscMaterial);
  disc.solve(kPose, 2000, 1e-9);
  const DiscWrench w = disc.wrench();
  const double h = 1e-6;
  for (int k = 0; k < 6; ++k) {
    double energy[2];
    for (int side = 0; side < 2; ++side) {
      const Vector3d step = (side ? h : -h) * Vector3d::Unit(k % 3);
      DiscPose pose = kPose;
      if (k < 3) {
        pose.position += step;
      } else {  // about the origin of the lower disc frame
        const Eigen::AngleAxisd turn(step.norm(), step.normalized());
        pose.position = turn * pose.position;
        pose.rotation = turn * pose.rotation;
      }
      disc.solve(pose, 2000, 1e-9);
      energy[side] = disc.energy();
    }
    const double expected = -(energy[1] - energy[0]) / (2 * h);
    const double actual = k < 3 ? w.force[k] : w.moment[k - 3];
    EXPECT_NEAR(actual, expected, (k < 3 ? 1e-5 : 1e-7) * w.force.norm()) << k;
  }
}

TEST(ReferenceDisc, EnergyFallsInEachIteration) {
  const DiscMesh mesh = makeDiscMesh(kLumbarShape);
  for (Metric metric : {Metric::kProjective, Metric::kRestHessian}) {
    for (const DiscPose& pose :
         {kPose, discPose({0, 15, 0}, {0, 0, 0}), discPose({0, 0, 0}, {0, 0, -5})}) {
      ReferenceDisc disc(mesh, kDiscMaterial, metric);
      disc.solve(pose, 0, 0);
      double energy = disc.energy();
      const double first = energy;
      for (int i = 0; i < 12; ++i) {
        if (disc.solve(pose, 1, 1e-8) == 0) break;
        EXPECT_LT(disc.energy(), energy);
        energy = disc.energy();
      }
      EXPECT_LT(energy, 0.7 * first);
    }
  }
}

TEST(ReferenceDisc, BothMetricsHaveTheSameFixedPoint) {
  const DiscMesh mesh = makeDiscMesh({0.036, 0.028, 0.010, 0.007}, 2, 3);
  ReferenceDisc projective(mesh, kDiscMaterial, Metric::kProjective);
  ReferenceDisc hessian(mesh, kDiscMaterial, Metric::kRestHessian);
  const int slow = projective.solve(kPose, 5000, 1e-7);
  const int fast = hessian.solve(kPose, 5000, 1e-7);
  EXPECT_LT(5 * fast, slow);
  double difference = 0;
  for (size_t i = 0; i < mesh.rest_positions.size(); ++i) {
    difference = std::max(difference, (projective.positions()[i] - hessian.positions()[i]).norm());
  }
  EXPECT_LT(difference, 1e-9);
  EXPECT_LT((projective.wrench().force - hessian.wrench().force).norm(), 1e-4);
  EXPECT_LT((projective.wrench().moment - hessian.wrench().moment).norm(), 1e-6);
}

// The energy written down again, by eigenvalues of F^T F and a search for l.
double plainEnergy(const DiscMesh& mesh, const DiscMaterial& m, const std::vector<Vector3d>& x) {
  const double mu = m.youngs_modulus / (2 * (1 + m.poissons_ratio));
  const double kappa = 3 * m.youngs_modulus * m.poissons_ratio /
                       ((1 + m.poissons_ratio) * (1 - 2 * m.poissons_ratio));
  double energy = 0;
  for (const auto& t : mesh.tets) {
    Matrix3d X, Y;
    for (int a = 0; a < 3; ++a) {
      X.col(a) = mesh.rest_positions[t[a + 1]] - mesh.rest_positions[t[0]];
      Y.col(a) = x[t[a + 1]] - x[t[0]];
    }
    const Matrix3d F = Y * X.inverse();
    const Vector3d s =
        Eigen::SelfAdjointEigenSolver<Matrix3d>(F.transpose() * F).eigenvalues().cwiseSqrt();
    double low = -s[0] * s[0] / 4, high = 10;
    for (int i = 0; i < 80; ++i) {
      const double l = (low + high) / 2;
      const Eigen::Array3d p = (s.array() + (s.array().square() + 4 * l).sqrt()) / 2;
      (p.prod() < 1 ? low : high) = l;
    }
    const Eigen::Array3d p = (s.array() + (s.array().square() + 4 * low).sqrt()) / 2;
    energy += X.determinant() / 6 *
              (mu * (s.array() - 1).square().sum() + kappa / 2 * (s.array() - p).square().sum());
  }
  return energy;
}

TEST(ReferenceDisc, LimitIsAStationaryPointOfTheEnergy) {
  const DiscMesh mesh = makeDiscMesh(kLumbarShape);
  ReferenceDisc disc(mesh, kDiscMaterial);
  disc.solve(kPose, 2000, 1e-8);
  EXPECT_NEAR(plainEnergy(mesh, kDiscMaterial, disc.positions()), disc.energy(),
              1e-6 * disc.energy());
  const double scale = disc.wrench().force.norm();
  std::vector<Vector3d> x = disc.positions();
  std::mt19937 rng(4);
  const double h = 1e-7;
  for (int i = 0; i < 60; ++i) {
    const int node = 37 + static_cast<int>(rng() % 111), k = static_cast<int>(rng() % 3);
    double energy[2];
    for (int side = 0; side < 2; ++side) {
      x[node][k] += side ? 2 * h : -h;
      energy[side] = plainEnergy(mesh, kDiscMaterial, x);
    }
    x[node][k] -= h;
    EXPECT_NEAR((energy[1] - energy[0]) / (2 * h), 0, 1e-5 * scale) << node;
  }
}

TEST(ReferenceDisc, RestStiffnessIsTheWrenchesDerivative) {
  const DiscMesh mesh = makeDiscMesh({0.036, 0.028, 0.010, 0.007}, 2, 3);
  ReferenceDisc disc(mesh, kDiscMaterial);
  const Matrix6d K = disc.restStiffness();
  EXPECT_GT(K.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0);
  const double h = 1e-6;
  for (int k = 0; k < 6; ++k) {
    Vector6d w[2];
    for (int side = 0; side < 2; ++side) {
      DiscPose pose;
      const Vector3d step = (side ? h : -h) * Vector3d::Unit(k % 3);
      if (k < 3) {
        pose.position = step;
      } else {
        pose.rotation = Eigen::AngleAxisd(step.norm(), step.normalized());
      }
      disc.reset();
      disc.solve(pose, 200, 1e-8);
      w[side] = asVector(disc.wrench(), 1);
    }
    const Vector6d column = -(w[1] - w[0]) / (2 * h);
    for (int i = 0; i < 6; ++i) {
      EXPECT_NEAR(K(i, k), column[i], 1e-4 * std::sqrt(K(i, i) * K(k, k))) << i << " " << k;
    }
  }
}

// Linear tets overestimate stiffness with an error of second order in their size, or less where the
// rim of the bonded endplates is singular.
TEST(ReferenceDisc, StiffnessConvergesAsTheMeshIsRefined) {
  const DiscShape cylinder = {0.020, 0.020, 0.020, 0.020};
  Matrix6d K[3];
  for (int i = 0; i < 3; ++i) {
    const int n = 2 << i;
    K[i] = DiscElasticity(makeDiscMesh(cylinder, n, n), {4e6, 0.3}).rest_stiffness;
  }
  for (int k = 0; k < 6; ++k) {
    const double coarse = K[0](k, k) - K[1](k, k), fine = K[1](k, k) - K[2](k, k);
    EXPECT_GT(fine, 0) << k;
    const double order = std::log2(coarse / fine);
    printf("stiffness of degree of freedom %d: %.4g, %.4g, %.4g; order %.2f\n", k, K[0](k, k),
           K[1](k, k), K[2](k, k), order);
    EXPECT_GT(order, 1) << k;
    EXPECT_LT(order, 2.5) << k;
  }
}

TEST(ReferenceDisc, DefaultMeshOfALumbarDiscIsNearAFineOne) {
  const Matrix6d K = DiscElasticity(makeDiscMesh(kLumbarShape), kDiscMaterial).rest_stiffness;
  const Matrix6d fine =
      DiscElasticity(makeDiscMesh(kLumbarShape, 8, 10), kDiscMaterial).rest_stiffness;
  const char* names[] = {"shear x [N/mm]",           "shear y [N/mm]",   "compression [N/mm]",
                         "lateral bending [Nm/deg]", "flexion [Nm/deg]", "torsion [Nm/deg]"};
  for (int k = 0; k < 6; ++k) {
    const double unit = k < 3 ? 1e-3 : kDegree;
    printf("%s: %.4g (fine mesh %.4g)\n", names[k], K(k, k) * unit, fine(k, k) * unit);
    EXPECT_GT(K(k, k), fine(k, k));
    EXPECT_LT(K(k, k), 1.3 * fine(k, k)) << names[k];
  }
}

TEST(ReferenceDisc, RefusesFaults) {
  DiscMesh mesh = makeDiscMesh(kLumbarShape);
  EXPECT_THROW(ReferenceDisc(mesh, {-1, 0.3}), std::invalid_argument);
  std::swap(mesh.tets[3][0], mesh.tets[3][1]);
  try {
    ReferenceDisc disc(mesh, kDiscMaterial);
    FAIL() << "no exception";
  } catch (const std::invalid_argument& e) {
    EXPECT_EQ(std::string(e.what()), checkDiscMesh(mesh));
  }
}

}  // namespace
}  // namespace torso
