// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/muscle_stress.h"

#include <Eigen/Cholesky>

namespace torso {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd leastStressForces(const MatrixXd& A, const VectorXd& b, const VectorXd& s,
                           double stress_max) {
  // In units of the largest forces, 0 <= x <= 1: minimise |x|^2 / 2 + |M x - b|^2 / (2 slack), to
  // which f / s = stress_max x. Stationary: x = clamp(M' y) with M x + slack y = b.
  constexpr double kSlack = 1e-6;  // [Nm^2]: a moment that costs all of a muscle is off by 1e-3 Nm
  constexpr int kMaxIterations = 200;
  const VectorXd strength = s * stress_max;
  const MatrixXd M = A * strength.asDiagonal();
  const auto primal = [&](const VectorXd& y) -> VectorXd {
    return (M.transpose() * y).cwiseMax(0).cwiseMin(1);
  };
  // The dual, to be minimised; its gradient is M x(y) + slack y - b.
  const auto dual = [&](const VectorXd& y) {
    const VectorXd t = M.transpose() * y, x = t.cwiseMax(0).cwiseMin(1);
    return x.dot(t) - x.squaredNorm() / 2 + kSlack / 2 * y.squaredNorm() - b.dot(y);
  };
  VectorXd y = VectorXd::Zero(b.size());
  for (int i = 0; i < kMaxIterations; i++) {
    const VectorXd t = M.transpose() * y;
    const VectorXd gradient = M * primal(y) + kSlack * y - b;
    if (gradient.norm() <= 1e-9 * (1 + b.norm())) break;
    MatrixXd H = kSlack * MatrixXd::Identity(b.size(), b.size());
    for (Eigen::Index k = 0; k < t.size(); k++) {
      // At 0 a muscle counts as free: at the start all are.
      if (t[k] >= 0 && t[k] < 1) H += M.col(k) * M.col(k).transpose();
    }
    const VectorXd step = -H.ldlt().solve(gradient);
    double length = 1;
    const double start = dual(y), slope = gradient.dot(step);
    while (length > 1e-12 && dual(y + length * step) > start + 1e-4 * length * slope) length /= 2;
    y += length * step;
  }
  return strength.cwiseProduct(primal(y));
}

}  // namespace torso
