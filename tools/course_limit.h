// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace torso::tools {

// The course that is nearest to another one, by least squares over all frames at once and so
// without lag, among those whose second differences are within a limit (by 2 % or so).
// course: (frames x axes). limit: (frames) for the length of the second difference about each
// frame, first and last one unused; positive.
Eigen::MatrixXd limitSecondDifferences(const Eigen::MatrixXd& course, const Eigen::VectorXd& limit);

}  // namespace torso::tools
