// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Model predictive path integral control as an open-loop optimiser: a vector of parameters is
// improved by the weighted mean of random changes to it.
//
//   e_k ~ N(0, sigma^2),  S_k = cost(u + e_k),  w_k = exp(-(S_k - min S) / lambda) / sum,
//   u <- u + sum_k w_k e_k
//
// Information-theoretic MPPI of Williams, Wagener, Goldfain, Drews, Rehg, Boots and Theodorou,
// "Information theoretic MPC for model-based reinforcement learning", ICRA 2017, algorithm 2, with
// the nominal controls as the base distribution: its cost of control lambda u^T Sigma^-1 e is then
// zero. That is for a loop of control, where an update is driven whatever it costs. Here it is
// evaluated before it is taken: one that costs more than the nominal gives way to the best so far,
// so that the nominal's cost never rises. Knows nothing of MuJoCo.

#include <cstdint>
#include <functional>
#include <vector>

namespace torso::tools {

struct MppiOptions {
  std::uint64_t seed = 0;
  int samples = 64;  // cost evaluations in an iteration, at least 2: one of them of the update
  // lambda. As a share of the costs' spread, which is their median less their smallest: of the
  // samples of an iteration, half then weigh less than exp(-1 / temperature) of the best
  double temperature = 0.2;
  bool absolute_temperature = false;  // temperature is lambda itself, in units of the cost
  double noise = 1;                   // factor on sigma
  double noise_decay = 0.97;          // factor on it from one iteration to the next, at most 1
};

// Everything that the next iteration depends on, options apart.
struct MppiState {
  int iteration = 0;            // done so far
  std::vector<double> nominal;  // u
  double nominal_cost = 0;      // infinite if its rollout failed; of no account before the first
  std::vector<double> best;     // parameters of the smallest cost so far; empty: none was finite
  double best_cost = 0;
};

struct MppiReport {
  int iteration;         // updates that led to the nominal
  double nominal_cost;   // of u before this iteration's update
  double best_cost;      // smallest so far
  double mean, spread;   // of the costs of this iteration that are finite; spread: as above
  double effective;      // 1 / sum w^2, the samples that the update rests on
  int failed;            // samples of infinite cost
  std::uint64_t digest;  // hash of the bits of the updated nominal
};

// Costs of parameter vectors, in their order; infinite or not a number: failed, of no weight.
using MppiCosts =
    std::function<std::vector<double>(const std::vector<std::vector<double>>& parameters)>;

// One iteration; the first has one cost evaluation more, of the nominal. sigma: standard deviation
// of each parameter's noise (as many as parameters). The nominal and the best so far take part in
// the mean, so that nothing found is lost. Parameters stay within [-limit, limit]. If all samples
// fail the nominal stays as it is. What `costs` throws leaves *state as it was.
MppiReport mppiIterate(const MppiOptions& options, const std::vector<double>& sigma, double limit,
                       const MppiCosts& costs, MppiState* state);

}  // namespace torso::tools
