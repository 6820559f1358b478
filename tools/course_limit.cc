// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/course_limit.h"

#include <algorithm>

namespace torso::tools {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kExcess = 0.02;
constexpr int kRounds = 60;

// Minimum over x of |x - course|^2 + sum of weights_t |second difference about t|^2: I + D' W D has
// two diagonals beside its own, and is solved by its factors L D L'.
MatrixXd smooth(const MatrixXd& course, const VectorXd& weights) {
  const Eigen::Index n = course.rows();
  VectorXd pivot = VectorXd::Ones(n), next = VectorXd::Zero(n), after = VectorXd::Zero(n);
  for (Eigen::Index t = 1; t + 1 < n; t++) {
    const double w = weights[t];
    pivot[t - 1] += w, pivot[t] += 4 * w, pivot[t + 1] += w;
    next[t - 1] -= 2 * w, next[t] -= 2 * w;
    after[t - 1] += w;
  }
  MatrixXd x = course;
  for (Eigen::Index t = 0; t < n; t++) {
    const double one = next[t] / pivot[t], two = after[t] / pivot[t];
    if (t + 1 < n) {
      pivot[t + 1] -= one * next[t];
      next[t + 1] -= one * after[t];
      x.row(t + 1) -= one * x.row(t);
    }
    if (t + 2 < n) {
      pivot[t + 2] -= two * after[t];
      x.row(t + 2) -= two * x.row(t);
    }
    next[t] = one;
    after[t] = two;
  }
  for (Eigen::Index t = n - 1; t >= 0; t--) {
    x.row(t) /= pivot[t];
    if (t + 1 < n) x.row(t) -= next[t] * x.row(t + 1);
    if (t + 2 < n) x.row(t) -= after[t] * x.row(t + 2);
  }
  return x;
}

}  // namespace

MatrixXd limitSecondDifferences(const MatrixXd& course, const VectorXd& limit) {
  const Eigen::Index n = course.rows();
  constexpr double kLeast = 1e-3;  // a weight that changes nothing
  VectorXd weights = VectorXd::Constant(n, kLeast);
  MatrixXd x = course;
  for (int round = 0; round < kRounds; round++) {
    double excess = 0;
    for (Eigen::Index t = 1; t + 1 < n; t++) {
      const double over = (x.row(t + 1) - 2 * x.row(t) + x.row(t - 1)).norm() / limit[t];
      excess = std::max(excess, over - 1);
      // Where the limit is met the weight is the multiplier of its bound.
      weights[t] = std::clamp(weights[t] * over, kLeast, 1e6);
    }
    if (excess < kExcess) break;
    x = smooth(course, weights);
  }
  return x;
}

}  // namespace torso::tools
