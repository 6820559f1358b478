// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/smoothness.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unsupported/Eigen/FFT>

#include "tools/posture.h"
#include "tools/retrofit_model.h"

namespace torso::tools {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Turns = std::vector<std::vector<Vector3d>>;

// Power of the velocity from frequency 0 to half the rate.
std::vector<double> velocityPower(const Turns& turns) {
  const std::size_t n = turns.size() - 1;
  std::vector<double> power(n / 2 + 1, 0);
  Eigen::FFT<double> fft;
  std::vector<double> velocity(n);
  std::vector<std::complex<double>> spectrum;
  for (std::size_t k = 0; k < turns[0].size(); k++) {
    for (int axis = 0; axis < 3; axis++) {
      for (std::size_t i = 0; i < n; i++) {
        const double window = 0.5 - 0.5 * std::cos(2 * EIGEN_PI * (i + 0.5) / n);
        velocity[i] = window * (turns[i + 1][k][axis] - turns[i][k][axis]);
      }
      fft.fwd(spectrum, velocity);
      for (std::size_t i = 0; i < power.size(); i++) power[i] += std::norm(spectrum[i]);
    }
  }
  return power;
}

double powerFrom(const std::vector<double>& power, std::size_t first) {
  return std::accumulate(power.begin() + std::min(first, power.size()), power.end(), 0.0);
}

double ratio(double a, double b) { return b > 0 ? a / b : 0; }

}  // namespace

Smoothness smoothness(const Turns& input, const Turns& output, double rate) {
  Smoothness result;
  const std::vector<double> in = velocityPower(input), out = velocityPower(output);
  std::size_t first = 0;
  while (first < in.size() && powerFrom(in, first) > 0.01 * powerFrom(in, 0)) first++;
  result.band = first * rate / (input.size() - 1);
  result.input_share = ratio(powerFrom(in, first), powerFrom(in, 0));
  result.output_share = ratio(powerFrom(out, first), powerFrom(out, 0));
  result.gain = ratio(powerFrom(out, first), powerFrom(in, first));
  for (std::size_t i = 2; i < output.size(); i++) {
    for (std::size_t k = 0; k < output[i].size(); k++) {
      const double jump = (output[i][k] - 2 * output[i - 1][k] + output[i - 2][k]).norm();
      result.largest_jump = std::max(result.largest_jump, jump);
    }
  }
  return result;
}

double powerShareAbove(const Turns& turns, double rate, double frequency) {
  const std::vector<double> power = velocityPower(turns);
  const double bins = frequency / rate * static_cast<double>(turns.size() - 1);
  return ratio(powerFrom(power, static_cast<std::size_t>(std::ceil(bins))), powerFrom(power, 0));
}

Turns heldTurns(const HeldMotion& held) {
  const std::size_t n = held.bodies.size();
  const auto at = [&](std::size_t frame, std::size_t body) {
    const auto& q = held.quaternions[frame * n + body];
    return Quaterniond(q[0], q[1], q[2], q[3]);
  };
  Turns turns(held.frames());
  for (std::size_t frame = 0; frame < held.frames(); frame++) {
    for (std::size_t i = 0; i < n; i++) {
      if (std::find(kHeldBones.begin(), kHeldBones.end(), held.bodies[i]) == kHeldBones.end())
        continue;
      turns[frame].push_back(rotationVector(at(frame, 0).conjugate() * at(frame, i)));
    }
  }
  return turns;
}

}  // namespace torso::tools
