// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/muscle_stress.h"

#include <Eigen/Cholesky>

namespace torso {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd leastStressForces(const MatrixXd& A, const VectorXd& b, const VectorXd& s,
                           double stress_max) {
  // In units of the largest forces, 0 <= x <= 1: minimise |x|^2 / 2 + |M x - b|^2 / (2 slack), to
  // which f / s = stress_max x. Stationary: x = clamp(M' y) with M x + slack y = b, the gradient of
  // a convex function of y.
  constexpr double kSlack = 1;  // [Nm^2]
  constexpr int kMaxIterations = 500;
  const VectorXd strength = s * stress_max;
  const MatrixXd M = A * strength.asDiagonal();
  const auto primal = [&](const VectorXd& y) -> VectorXd {
    return (M.transpose() * y).cwiseMax(0).cwiseMin(1);
  };
  const auto gradient = [&](const VectorXd& y) -> VectorXd {
    return M * primal(y) + kSlack * y - b;
  };
  VectorXd y = VectorXd::Zero(b.size());
  for (int i = 0; i < kMaxIterations; i++) {
    const VectorXd t = M.transpose() * y, g = gradient(y);
    if (g.norm() <= 1e-9 * (1 + b.norm())) break;
    MatrixXd H = kSlack * MatrixXd::Identity(b.size(), b.size());
    for (Eigen::Index k = 0; k < t.size(); k++) {
      // At 0 a muscle counts as free: at the start all are.
      if (t[k] >= 0 && t[k] < 1) H += M.col(k) * M.col(k).transpose();
    }
    const VectorXd step = -H.ldlt().solve(g);
    // The least along the step, where the slope, which only rises, is zero.
    double low = 0, high = 1;
    if (step.dot(gradient(y + step)) > 0) {
      for (int k = 0; k < 60; k++) {
        const double middle = (low + high) / 2;
        (step.dot(gradient(y + middle * step)) > 0 ? high : low) = middle;
      }
    }
    y += high * step;
  }
  return strength.cwiseProduct(primal(y));
}

}  // namespace torso
