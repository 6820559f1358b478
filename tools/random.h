// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Random numbers that are functions of their arguments alone, so that work spread over threads or
// processes draws the same ones.

#include <cmath>
#include <cstdint>

namespace torso::tools {

// Bijective mixing of 64 bits (the finaliser of SplitMix64).
inline std::uint64_t mixBits(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

// Uniform in [0, 1).
inline double uniform(std::uint64_t seed, std::uint64_t interval, std::uint64_t index) {
  return static_cast<double>(mixBits(mixBits(mixBits(seed) + interval) + index) >> 11) * 0x1p-53;
}

// Normal with mean 0 and standard deviation 1 (Box and Muller).
inline double normal(std::uint64_t seed, std::uint64_t interval, std::uint64_t index) {
  const double u = 1 - uniform(seed, interval, 2 * index);  // not 0
  const double v = uniform(seed, interval, 2 * index + 1);
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * M_PI * v);
}

}  // namespace torso::tools
