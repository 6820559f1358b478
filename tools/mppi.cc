// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/mppi.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <utility>

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

double finiteOr(double cost) { return std::isfinite(cost) ? cost : INFINITY; }

// The weighted mean of samples, at least one of which has a finite cost, and the effective number.
std::pair<Vector, double> softMean(const std::vector<Vector>& samples, const Vector& costs,
                                   double lambda) {
  const double smallest = *std::min_element(costs.begin(), costs.end());
  Vector mean(samples[0].size(), 0);
  double sum = 0, squares = 0;
  for (std::size_t k = 0; k < samples.size(); k++) {
    if (std::isinf(costs[k])) continue;
    const double w = costs[k] == smallest ? 1 : std::exp(-(costs[k] - smallest) / lambda);
    sum += w;
    squares += w * w;
    for (std::size_t i = 0; i < mean.size(); i++) mean[i] += w * samples[k][i];
  }
  for (double& x : mean) x /= sum;
  return {mean, sum * sum / squares};
}

}  // namespace

MppiReport mppiIterate(const MppiOptions& options, const Vector& sigma, double limit,
                       const MppiCosts& costs, MppiState* state) {
  const std::size_t n = sigma.size();
  const double scale = options.noise * std::pow(options.noise_decay, state->iteration);
  MppiState next = *state;
  next.iteration++;

  std::vector<Vector> samples;
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
  if (state->iteration == 0) samples.push_back(state->nominal);
  Vector cost = costs(samples);
  std::transform(cost.begin(), cost.end(), cost.begin(), finiteOr);
  if (state->iteration == 0) {
    next.nominal_cost = cost.back();
  } else {
    samples.push_back(state->nominal);
    cost.push_back(state->nominal_cost);
  }

  MppiReport report = {};
  report.iteration = state->iteration;
  report.nominal_cost = next.nominal_cost;
  Vector finite;
  std::copy_if(cost.begin(), cost.end(), std::back_inserter(finite),
               [](double c) { return std::isfinite(c); });
  report.failed = static_cast<int>(cost.size() - finite.size());
  report.mean = INFINITY;
  if (!finite.empty()) {
    report.mean = std::accumulate(finite.begin(), finite.end(), 0.) / finite.size();
    report.spread = median(finite) - *std::min_element(finite.begin(), finite.end());
  }

  const auto keepBest = [&next](const Vector& sample, double c) {
    if (std::isinf(c) || (!next.best.empty() && c >= next.best_cost)) return;
    next.best = sample;
    next.best_cost = c;
  };
  if (!next.best.empty() && next.best != state->nominal) {
    samples.push_back(next.best);
    cost.push_back(next.best_cost);
  }
  for (std::size_t k = 0; k < samples.size(); k++) keepBest(samples[k], cost[k]);
  if (!next.best.empty()) {
    const double lambda =
        options.absolute_temperature ? options.temperature : options.temperature * report.spread;
    const auto [mean, effective] = softMean(samples, cost, lambda);
    const double mean_cost = finiteOr(costs({mean})[0]);
    keepBest(mean, mean_cost);
    const bool better = mean_cost <= next.nominal_cost;
    next.nominal = better ? mean : next.best;
    next.nominal_cost = better ? mean_cost : next.best_cost;
    report.effective = effective;
  }
  report.best_cost = next.best.empty() ? INFINITY : next.best_cost;
  report.digest = hashOf(next.nominal);
  *state = std::move(next);
  return report;
}

}  // namespace torso::tools
