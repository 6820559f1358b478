// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/disc_elasticity.h"

#include <Eigen/SVD>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace torso {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

// Critical points of |p - s|^2 on p1 p2 p3 = 1: with a Lagrange multiplier l, p_i^2 - s_i p_i = l.
// p_i is the larger root, or the smaller one for at most one i (`flip`, else -1).
Vector3d roots(const Vector3d& s, double l, int flip, Vector3d* slope) {
  Vector3d p;
  for (int i = 0; i < 3; ++i) {
    const double d = std::sqrt(std::max(1e-300, s[i] * s[i] + 4 * l));
    const bool larger = i != flip;
    // Of the two forms of a root, the one without cancellation.
    p[i] = larger == (s[i] >= 0) ? (s[i] + (larger ? d : -d)) / 2
                                 : -2 * l / (s[i] + (larger ? -d : d));
    (*slope)[i] = larger ? 1 / d : -1 / d;
  }
  return p;
}

double product(const Vector3d& s, double l, int flip) {
  Vector3d slope;
  return roots(s, l, flip, &slope).prod();
}

// The l in [low, high] where the product of the roots is 1; `rising` with l. Newton's method on the
// product's logarithm, bisection where it leaves the bracket.
Vector3d solve(const Vector3d& s, double low, double high, int flip, bool rising) {
  Vector3d p, slope;
  double l = (low + high) / 2;
  for (int i = 0; i < 100; ++i) {
    p = roots(s, l, flip, &slope);
    const double error = std::log(std::max(p.prod(), 1e-300));
    if (std::abs(error) < 1e-14) break;
    ((error < 0) == rising ? low : high) = l;
    const double next = l - error / slope.cwiseQuotient(p).sum();
    const double last = l;
    l = next > low && next < high ? next : (low + high) / 2;
    if (l == last) break;
  }
  return p;
}

}  // namespace

Vector3d nearestUnitProduct(const Vector3d& s) {
  const double J = s.prod();
  if (J == 1) return s;
  // The product of the larger roots rises with l from at most J; at the upper end each exceeds 1.
  if (J < 1) return solve(s, 0, 2 + 2 * s.squaredNorm(), -1, true);
  // J > 1 has all s_i > 0. Either all roots are the larger ones, or that of the smallest s is not.
  int least;
  s.minCoeff(&least);
  const double low = -s[least] * s[least] / 4;
  const Vector3d folded = solve(s, low, 0, least, false);
  if (product(s, low, -1) > 1) return folded;
  const Vector3d plain = solve(s, low, 0, -1, true);
  const bool nearer =
      std::abs(folded.prod() - 1) < 1e-6 && (folded - s).squaredNorm() < (plain - s).squaredNorm();
  return nearer ? folded : plain;
}

Projections project(const Matrix3d& F) {
  const Eigen::JacobiSVD<Matrix3d> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3d U = svd.matrixU();
  const Matrix3d& V = svd.matrixV();
  Vector3d s = svd.singularValues();
  if (U.determinant() * V.determinant() < 0) {
    U.col(2) *= -1;
    s[2] *= -1;
  }
  return {U * V.transpose(), U * nearestUnitProduct(s).asDiagonal() * V.transpose()};
}

DiscElasticity::DiscElasticity(const DiscMesh& mesh, const DiscMaterial& material) {
  for (const std::string& error : {checkDiscMesh(mesh), checkDiscMaterial(material)}) {
    if (!error.empty()) throw std::invalid_argument(error);
  }
  const double E = material.youngs_modulus, nu = material.poissons_ratio;
  mu = E / (2 * (1 + nu));
  kappa = 3 * E * nu / ((1 + nu) * (1 - 2 * nu));

  const int n = static_cast<int>(mesh.rest_positions.size());
  free_index.assign(n, 0);
  Vector3d lower = Vector3d::Zero(), upper = Vector3d::Zero();
  for (int i : mesh.lower_nodes) lower += mesh.rest_positions[i] / mesh.lower_nodes.size();
  for (int i : mesh.upper_nodes) upper += mesh.rest_positions[i] / mesh.upper_nodes.size();
  height = (upper - lower).norm();
  for (int i : mesh.lower_nodes) free_index[i] = -1;
  for (int i : mesh.upper_nodes) free_index[i] = -1;
  size = 0;
  for (int i = 0; i < n; ++i) {
    size = std::max(size, mesh.rest_positions[i].norm());
    if (free_index[i] < 0) continue;
    free_index[i] = static_cast<int>(free_nodes.size());
    free_nodes.push_back(i);
  }

  // Half the rigid motions of the two bones.
  Eigen::Matrix<double, Eigen::Dynamic, 6> motion(3 * n, 6);
  motion.setZero();
  const auto move = [&](int i, double factor) {
    const Vector3d& x = mesh.rest_positions[i];
    for (int k = 0; k < 3; ++k) {
      motion(3 * i + k, k) = factor;
      motion.block<3, 1>(3 * i, 3 + k) = factor * Vector3d::Unit(k).cross(x);
    }
  };
  for (int i : mesh.lower_nodes) move(i, -0.5);
  for (int i : mesh.upper_nodes) move(i, 0.5);

  // Hooke's law with the Lame constants kappa / 3 and mu.
  const int nfree = static_cast<int>(free_nodes.size());
  std::vector<Eigen::Triplet<double>> full, interior;
  for (const auto& t : mesh.tets) {
    Matrix3d edges;
    for (int a = 0; a < 3; ++a) {
      edges.col(a) = mesh.rest_positions[t[a + 1]] - mesh.rest_positions[t[0]];
    }
    const Matrix3d inverse = edges.inverse();
    const double V = edges.determinant() / 6;
    inverse_edges.push_back(inverse);
    volume.push_back(V);
    Eigen::Matrix<double, 4, 3> g;  // gradients of the shape functions
    g.bottomRows<3>() = inverse;
    g.row(0) = -inverse.colwise().sum();
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        Matrix3d K =
            kappa / 3 * g.row(a).transpose() * g.row(b) + mu * g.row(b).transpose() * g.row(a);
        K.diagonal().array() += mu * g.row(a).dot(g.row(b));
        const int fa = free_index[t[a]], fb = free_index[t[b]];
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j) {
            full.emplace_back(3 * t[a] + i, 3 * t[b] + j, V * K(i, j));
            if (fa >= 0 && fb >= 0) interior.emplace_back(3 * fa + i, 3 * fb + j, V * K(i, j));
          }
        }
      }
    }
  }
  Eigen::SparseMatrix<double> hessian(3 * n, 3 * n);
  hessian.setFromTriplets(full.begin(), full.end());
  free_hessian.resize(3 * nfree, 3 * nfree);
  free_hessian.setFromTriplets(interior.begin(), interior.end());

  const Eigen::Matrix<double, Eigen::Dynamic, 6> load = hessian * motion;
  Eigen::Matrix<double, Eigen::Dynamic, 6> free_load(3 * nfree, 6);
  for (int i = 0; i < nfree; ++i) {
    free_load.middleRows<3>(3 * i) = load.middleRows<3>(3 * free_nodes[i]);
  }
  response.resize(3 * nfree, 6);
  if (nfree > 0) {
    const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor(free_hessian);
    if (factor.info() == Eigen::Success) response = -factor.solve(free_load);
    if (factor.info() != Eigen::Success || !response.allFinite()) {
      throw std::invalid_argument(
          "the stiffness at rest is singular: a part of the mesh can move freely (does it hang on "
          "one node or edge?)");
    }
  }
  rest_stiffness = motion.transpose() * load + free_load.transpose() * response;
  rest_stiffness = (rest_stiffness + rest_stiffness.transpose()).eval() / 2;
}

double DiscElasticity::forces(const DiscMesh& mesh, const VectorXd& u, VectorXd* f) const {
  double energy = 0;
  f->setZero(u.size());
  for (size_t e = 0; e < mesh.tets.size(); ++e) {
    const auto& t = mesh.tets[e];
    Matrix3d edges;
    for (int a = 0; a < 3; ++a) {
      edges.col(a) = u.segment<3>(3 * t[a + 1]) - u.segment<3>(3 * t[0]);
    }
    const Matrix3d F = Matrix3d::Identity() + edges * inverse_edges[e];
    const Projections p = project(F);
    energy += volume[e] *
              (mu * (F - p.rotation).squaredNorm() + kappa / 2 * (F - p.isochoric).squaredNorm());
    const Matrix3d stress = 2 * mu * (F - p.rotation) + kappa * (F - p.isochoric);
    const Matrix3d force = -volume[e] * stress * inverse_edges[e].transpose();
    for (int a = 0; a < 3; ++a) {
      f->segment<3>(3 * t[a + 1]) += force.col(a);
      f->segment<3>(3 * t[0]) -= force.col(a);
    }
  }
  return energy;
}

HalfwayFrame::HalfwayFrame(const DiscPose& pose) {
  // Of the two quaternions of a rotation, the one with the smaller angle.
  Eigen::Quaterniond q = pose.rotation;
  const double largest = q.coeffs().cwiseAbs().maxCoeff();
  if (!(largest > 0)) {
    q.setIdentity();
  } else {
    q.coeffs() /= q.w() < 0 ? -largest : largest;
    q.normalize();
  }
  Eigen::Quaterniond h = q;
  h.w() += 1;
  h.normalize();
  half = h.toRotationMatrix();
  full = q.toRotationMatrix();
  rotation = q.vec();
  origin = pose.position / 2;
  offset = half.transpose() * origin;
}

DiscWrench HalfwayFrame::wrench(const Vector6d& in_m, const Vector3d& normal) const {
  DiscWrench w;
  w.force = half * in_m.head<3>();
  w.moment = half * in_m.tail<3>() + origin.cross(w.force);
  const double area_squared = normal.squaredNorm();
  if (area_squared > 0) w.pressure = w.force.dot(full * normal) / area_squared;
  return w;
}

}  // namespace torso
