// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Which muscles pull how much, where many could do it.

#include <Eigen/Core>

namespace torso {

// Forces f (n) [N] of muscles with cross-sections s (n) [m^2] that realise given moments b (k)
// [Nm], A (k x n) [m] being their moment arms, with the least sum of squared stresses:
//
//   minimise  sum (f_i / (s_i stress_max))^2 + |A f - b|^2 / (1 Nm)^2  with  0 <= f_i <= s_i
//   stress_max
//
// so that a moment is missed by 1 Nm at most where the last of it would cost a muscle all it has,
// and by more only where muscles cannot give it. Sum of squares after Pedotti et al. 1978, Math
// Biosci 38:57-76. The one minimum, whatever the start: by Newton's method on the dual. s > 0.
Eigen::VectorXd leastStressForces(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                                  const Eigen::VectorXd& s, double stress_max);

}  // namespace torso
