// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdlib>
#include <memory>
#include <vector>

#include "model/disc_batch.h"

namespace torso {

constexpr double kDegree = M_PI / 180;
constexpr DiscShape kLumbarShape = {0.050, 0.035, 0.011, 0.011};  // L4/5-like
constexpr DiscMaterial kDiscMaterial = {2.5e6, 0.40, 10e6, 10, M_PI / 6, 0.3e6, 100e6};

// Smallest to largest disc of a spine, with and without wedge.
inline std::vector<DiscShape> discShapes() {
  return {{0.016, 0.015, 0.004, 0.004},
          {0.018, 0.016, 0.006, 0.0045},
          {0.028, 0.024, 0.005, 0.0055},
          {0.036, 0.028, 0.008, 0.006},
          {0.050, 0.035, 0.014, 0.0055},  // 14 degrees
          kLumbarShape};
}

// Pose of rotation vector [degree] and position [mm].
inline DiscPose discPose(const Eigen::Vector3d& degrees, const Eigen::Vector3d& mm) {
  DiscPose pose;
  if (degrees.norm() > 0) {
    pose.rotation = Eigen::AngleAxisd(degrees.norm() * kDegree, degrees.normalized());
  }
  pose.position = mm * 1e-3;
  return pose;
}

// Force times a length of the disc, and moment: comparable numbers.
inline Eigen::Matrix<double, 6, 1> asVector(const DiscWrench& w, double length) {
  Eigen::Matrix<double, 6, 1> v;
  v << w.force * length, w.moment;
  return v;
}

// A DiscBatch with its state and scratch.
struct BatchRun {
  explicit BatchRun(const std::vector<DiscBatch::Disc>& discs)
      : batch(discs),
        state(batch.stateSize(), 0.0),
        scratch(std::aligned_alloc(64, (batch.scratchSize() + 63) / 64 * 64), std::free),
        poses(discs.size()),
        wrenches(discs.size()) {}

  int evaluate(const DiscBatch::Options& options = {}) {
    return batch.evaluate(poses.data(), state.data(), state.data(), wrenches.data(), scratch.get(),
                          options);
  }

  DiscBatch batch;
  std::vector<double> state;
  std::unique_ptr<void, void (*)(void*)> scratch;
  std::vector<DiscPose> poses;
  std::vector<DiscWrench> wrenches;
};

}  // namespace torso
