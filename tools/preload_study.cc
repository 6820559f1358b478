// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/preload_study.h"

#include "tools/spine_load.h"

namespace torso::tools {
namespace {

constexpr int kLevels = 6, kLumbar = 5;  // L5/S1 .. T12/L1, of which .. L1/L2 are counted

// Angles of L1 against the sacrum [rad]: flexion with extension, bending, rotation.
std::array<double, 3> angles(WholeSpine& spine, double follower, double moment) {
  const auto turned = [&](Turn turn) {
    const SpineLoad load(kLevels, {moment * turnAxis(turn), follower});
    const SpinePose pose = spine.load(load, 1).back();
    double sum = 0;
    for (int i = 0; i < kLumbar; i++) sum += pose.levels[i].dot(turnAxis(turn));
    return sum;
  };
  return {turned(Turn::kFlexion) + turned(Turn::kExtension), turned(Turn::kLeftBending),
          turned(Turn::kLeftRotation)};
}

}  // namespace

std::vector<PreloadEffect> measurePreload(const Anatomy& anatomy, const Skeleton& skeleton,
                                          const std::vector<double>& followers) {
  constexpr double kSmall = 1;  // [Nm]
  SpineParts parts;
  parts.levels = kLevels;
  WholeSpine spine(anatomy, skeleton, parts);
  const auto measure = [&](double follower) {
    spine.stand(SpineLoad(kLevels, {Eigen::Vector3d::Zero(), follower}));
    return std::pair(angles(spine, follower, kSmall),
                     angles(spine, follower, laboratoryMoment(Region::kLumbar)));
  };
  const auto [free_small, free_end] = measure(0);
  std::vector<PreloadEffect> effects;
  for (const double follower : followers) {
    const auto [small, end] = measure(follower);
    PreloadEffect effect = {follower, {}, {}};
    for (int k = 0; k < 3; k++) {
      effect.stiffness[k] = free_small[k] / small[k];
      effect.motion[k] = end[k] / free_end[k];
    }
    effects.push_back(effect);
  }
  return effects;
}

}  // namespace torso::tools
