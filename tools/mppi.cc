// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/mppi.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "model/median.h"
#include "tools/random.h"

namespace torso::tools {
namespace {

using Vector = std::vector<double>;

std::uint64_t hashOf(const Vector& values) {
  std::uint64_t h = 0;
  for (const double value : values) {
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    h = mixBits(h ^ bits);
  }
  return h;
}

}  // namespace

MppiReport mppiIterate(const MppiOptions& options, const Vector& sigma, double limit,
                       const MppiCosts& costs, MppiState* state) {
  const std::size_t n = sigma.size();
  const double scale = options.noise * std::pow(options.noise_decay, state->iteration);

  std::vector<Vector> samples = {state->nominal};
  for (int k = 1; k < options.samples; k++) {
    Vector sample = state->nominal;
    for (std::size_t i = 0; i < n; i++) {
      const double e =
          scale * sigma[i] *
          normal(options.seed, state->iteration, static_cast<std::uint64_t>(k) * n + i);
      sample[i] = std::clamp(sample[i] + e, -limit, limit);
    }
    samples.push_back(std::move(sample));
  }
  Vector cost = costs(samples);

  MppiReport report = {};
  report.iteration = state->iteration;
  report.nominal_cost = std::isfinite(cost[0]) ? cost[0] : INFINITY;
  Vector finite;
  std::copy_if(cost.begin(), cost.end(), std::back_inserter(finite),
               [](double c) { return std::isfinite(c); });
  report.failed = static_cast<int>(cost.size() - finite.size());

  // The best so far, found now or before.
  if (!state->best.empty()) {
    samples.push_back(state->best);
    cost.push_back(state->best_cost);
  }
  std::size_t best = samples.size();
  for (std::size_t k = 0; k < samples.size(); k++) {
    if (std::isfinite(cost[k]) && (best == samples.size() || cost[k] < cost[best])) best = k;
  }
  if (best == samples.size()) {
    report.best_cost = report.mean = INFINITY;
  } else {
    const double smallest = cost[best];
    if (!finite.empty()) {
      for (const double c : finite) report.mean += c / static_cast<double>(finite.size());
      report.spread = median(finite) - *std::min_element(finite.begin(), finite.end());
    }
    const double lambda =
        options.absolute_temperature ? options.temperature : options.temperature * report.spread;
    Vector mean(n, 0);
    double sum = 0, squares = 0;
    for (std::size_t k = 0; k < samples.size(); k++) {
      if (!std::isfinite(cost[k])) continue;
      const double w = cost[k] == smallest ? 1 : std::exp(-(cost[k] - smallest) / lambda);
      sum += w;
      squares += w * w;
      for (std::size_t i = 0; i < n; i++) mean[i] += w * samples[k][i];
    }
    for (double& x : mean) x /= sum;
    report.effective = sum * sum / squares;
    report.best_cost = smallest;
    state->best_cost = smallest;
    state->best = samples[best];
    state->nominal = std::move(mean);
  }
  state->iteration++;
  report.digest = hashOf(state->nominal);
  return report;
}

}  // namespace torso::tools
