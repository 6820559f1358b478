// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// What impact biomechanics says of a head's acceleration: its magnitude in g, sampled at a fixed
// interval, each sample the mean over its interval.

#include <cstddef>
#include <vector>

namespace torso::tools {

constexpr double kStandardGravity = 9.80665;  // [m/s^2]

struct HeadInjury {
  double hic = 0;                    // [s]
  std::size_t begin = 0, count = 0;  // samples that it is taken over
};

// Head injury criterion (Versace 1971, SAE 710881; FMVSS 208): the largest (t2 - t1) times the mean
// acceleration between t1 and t2 to the power 2.5, over all t2 - t1 <= window [s]. 0 for no
// samples.
HeadInjury headInjuryCriterion(const std::vector<double>& acceleration, double interval,
                               double window = 0.015);

// The level that acceleration exceeds for `duration` [s] in sum (UN Regulation 94 of the head, for
// 3 ms). 0 if the samples are shorter than that.
double exceededFor(const std::vector<double>& acceleration, double interval,
                   double duration = 0.003);

}  // namespace torso::tools
