// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/impact.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

namespace torso::tools {

HeadInjury headInjuryCriterion(const std::vector<double>& acceleration, double interval,
                               double window) {
  const std::size_t n = acceleration.size();
  std::vector<double> sum(n + 1, 0);
  std::partial_sum(acceleration.begin(), acceleration.end(), sum.begin() + 1);
  const auto longest = static_cast<std::size_t>(window / interval + 1e-6);
  HeadInjury worst;
  for (std::size_t begin = 0; begin < n; begin++) {
    for (std::size_t count = 1; count <= longest && begin + count <= n; count++) {
      const auto samples = static_cast<double>(count);
      const double mean = (sum[begin + count] - sum[begin]) / samples;
      const double hic = samples * interval * std::pow(std::max(mean, 0.0), 2.5);
      if (hic > worst.hic) worst = {hic, begin, count};
    }
  }
  return worst;
}

double exceededFor(const std::vector<double>& acceleration, double interval, double duration) {
  std::vector<double> sorted = acceleration;
  std::sort(sorted.begin(), sorted.end(), std::greater<>());
  // The samples above the level, the last of them in part.
  const auto above = static_cast<std::size_t>(std::ceil(duration / interval - 1e-6));
  return above == 0 || above > sorted.size() ? 0 : sorted[above - 1];
}

}  // namespace torso::tools
