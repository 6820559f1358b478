// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/disc_field.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace torso {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kLeastJ = 0.1;  // ratio of volumes that a stress is divided by

Matrix3d edges(const std::vector<Vector3d>& x, const std::array<int, 4>& t) {
  Matrix3d m;
  for (int a = 0; a < 3; ++a) m.col(a) = x[t[a + 1]] - x[t[0]];
  return m;
}

// det(F) F^-T, defined for every F.
Matrix3d cofactor(const Matrix3d& F) {
  Matrix3d m;
  m << F.col(1).cross(F.col(2)), F.col(2).cross(F.col(0)), F.col(0).cross(F.col(1));
  return m;
}

// Patch of tets of one dilatation and one set of fibres: volumes, mean deformation gradient, and
// what follows from them.
struct Cell {
  double volume = 0, volume_now = 0;   // [m^3]
  Matrix3d mean = Matrix3d::Zero();    // integral of F, then F's mean
  double J;                            // volume_now / volume, but for disasters
  double mu, slope;                    // shear modulus, derivative of the volume energy [Pa]
  Matrix3d piola = Matrix3d::Zero();   // of the fibres [Pa]
  Matrix3d cauchy = Matrix3d::Zero();  // of the fibres [Pa]
  Vector2d stretch = Vector2d::Ones();
};

void addFibres(const DiscMaterial& m, const Vector3d& hoop, Cell* cell) {
  const Vector3d along = Vector3d(hoop.x(), hoop.y(), 0).normalized();
  for (int k = 0; k < 2; ++k) {
    const Vector3d at_rest = std::cos(m.fibre_angle) * along +
                             (k == 0 ? 1 : -1) * std::sin(m.fibre_angle) * Vector3d::UnitZ();
    const Vector3d now = cell->mean * at_rest;
    const double stretch = now.norm(), e = std::max(stretch - 1, 0.0);
    cell->stretch[k] = stretch;
    if (e == 0) continue;
    const double tension = m.fibre_modulus * (e + m.fibre_stiffening * e * e) / stretch;
    cell->piola += tension * now * at_rest.transpose();
    cell->cauchy += tension / cell->J * now * now.transpose();
  }
}

}  // namespace

std::vector<TetStress> discStress(const DiscMesh& mesh, const DiscMaterial& m,
                                  const std::vector<Vector3d>& positions) {
  const size_t nucleus = mesh.hoops.size();
  const auto cellOf = [&](size_t e) {
    return mesh.cells[e] == DiscMesh::kNucleus ? nucleus : static_cast<size_t>(mesh.cells[e]);
  };
  std::vector<Matrix3d> F(mesh.tets.size());
  std::vector<Cell> cells(nucleus + 1);
  for (size_t e = 0; e < mesh.tets.size(); ++e) {
    const Matrix3d rest = edges(mesh.rest_positions, mesh.tets[e]);
    F[e] = edges(positions, mesh.tets[e]) * rest.inverse();
    const double volume = rest.determinant() / 6;
    Cell& cell = cells[cellOf(e)];
    cell.volume += volume;
    cell.volume_now += volume * F[e].determinant();
    cell.mean += volume * F[e];
  }
  for (size_t c = 0; c <= nucleus; ++c) {
    Cell& cell = cells[c];
    if (cell.volume == 0) continue;  // a disc without nucleus
    const double E = m.annulus_modulus, nu = m.annulus_poisson;
    cell.mean /= cell.volume;
    cell.J = std::max(cell.volume_now / cell.volume, kLeastJ);
    cell.mu = c == nucleus ? m.nucleus_modulus / 3 : E / (2 * (1 + nu));
    const double lambda = c == nucleus ? m.nucleus_bulk_modulus - 2 * cell.mu / 3
                                       : E * nu / ((1 + nu) * (1 - 2 * nu));
    cell.slope = (lambda + cell.mu) * (cell.volume_now / cell.volume - 1) - cell.mu;
    if (c == nucleus) continue;
    const auto& [from, to] = mesh.hoops[c];
    addFibres(m, mesh.rest_positions[to] - mesh.rest_positions[from], &cell);
  }
  std::vector<TetStress> stress(mesh.tets.size());
  for (size_t e = 0; e < mesh.tets.size(); ++e) {
    const Cell& cell = cells[cellOf(e)];
    stress[e].piola = cell.mu * F[e] + cell.slope * cofactor(F[e]) + cell.piola;
    stress[e].cauchy = cell.mu / cell.J * F[e] * F[e].transpose() +
                       cell.slope * Matrix3d::Identity() + cell.cauchy;
    stress[e].fibre_stretch = cell.stretch;
  }
  return stress;
}

double pressure(const Matrix3d& cauchy) { return -cauchy.trace() / 3; }

double vonMises(const Matrix3d& cauchy) {
  const Matrix3d deviator = cauchy + pressure(cauchy) * Matrix3d::Identity();
  return std::sqrt(1.5) * deviator.norm();
}

}  // namespace torso
