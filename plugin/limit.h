// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The law of ligaments and facets: a gap x >= 0 that must hold at the end of the step. With x^ the
// gap that the present velocities would lead to, the row's acceleration a must satisfy
//   x^ + h^2 a >= min(x, 0) (1 - kRecovery),
// so that an open gap just closes and a violated one loses the share kRecovery of its depth each
// step. That is the velocity-level complementarity problem of Anitescu and Potra 1997, which the
// paper solves, with the curvature of the path over the step taken in.

#include <algorithm>

namespace torso::plugin {

inline constexpr double kRecovery = 0.4;

// The row's effective gap: a >= -limitGap / h^2. now: x [m], then: x^ [m].
inline double limitGap(double now, double then) {
  return then - (1 - kRecovery) * std::min(now, 0.0);
}

}  // namespace torso::plugin
