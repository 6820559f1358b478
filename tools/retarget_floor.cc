// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/retarget_floor.h"

#include <algorithm>
#include <cmath>

namespace torso::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// A foot stands while its ankle is not higher than in most standing frames by more than this, and
// slower; both a few times the noise of optical motion capture.
constexpr double kStandingHeight = 0.04;  // [m]
constexpr double kStandingSpeed = 0.2;    // [m/s]
constexpr double kShortestStance = 0.1;   // [s]
constexpr double kBlend = 0.15;           // from free to standing [s]

double percentile(std::vector<double> values, double share) {
  const auto at =
      values.begin() + static_cast<long>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

Vector3d at(const Clip& clip, size_t frame, int joint) {
  return clip.pose(frame, joint).translation();
}

// [m/s], over about a thirtieth of a second.
double speed(const Clip& clip, size_t frame, int joint) {
  if (clip.frames() < 2) return 0;
  const size_t half = std::max<size_t>(1, static_cast<size_t>(std::lround(clip.rate / 60)));
  const size_t from = frame < half ? 0 : frame - half;
  const size_t to = std::min(frame + half, clip.frames() - 1);
  return (at(clip, to, joint) - at(clip, from, joint)).norm() * clip.rate /
         static_cast<double>(to - from);
}

// Frames in which a foot stands, those of too short a stance left out.
std::vector<bool> standing(const Clip& clip, int foot, int toe) {
  std::vector<double> slow;
  std::vector<bool> stands(clip.frames());
  for (size_t f = 0; f < clip.frames(); f++) {
    stands[f] =
        speed(clip, f, foot) < kStandingSpeed && (toe < 0 || speed(clip, f, toe) < kStandingSpeed);
    if (stands[f]) slow.push_back(at(clip, f, foot).z());
  }
  if (slow.empty()) return stands;
  const double height = percentile(slow, 0.1);
  for (size_t f = 0; f < clip.frames(); f++) {
    stands[f] = stands[f] && at(clip, f, foot).z() < height + kStandingHeight;
  }
  const double least = std::min(kShortestStance * clip.rate, static_cast<double>(clip.frames()));
  for (size_t f = 0; f < clip.frames();) {
    size_t end = f;
    while (end < clip.frames() && stands[end] == stands[f]) end++;
    if (stands[f] && static_cast<double>(end - f) < least) {
      std::fill(stands.begin() + static_cast<long>(f), stands.begin() + static_cast<long>(end),
                false);
    }
    f = end;
  }
  return stands;
}

Matrix3d levelAxes(const Vector3d& forward, const Vector3d& up) {
  Matrix3d R;
  R.col(2) = up.normalized();
  R.col(0) = (forward - forward.dot(R.col(2)) * R.col(2)).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return R;
}

}  // namespace

Matrix3d footTurn(const Clip& world, int foot, int toe, const Matrix3d& standing_turn,
                  const Vector3d& our_toe) {
  const std::vector<bool> stands = standing(world, foot, toe);
  Vector3d up = Vector3d::Zero(), forward = Vector3d::Zero();
  size_t count = 0;
  for (size_t f = 0; f < world.frames(); f++) {
    const Matrix3d inverse = world.pose(f, foot).linear().transpose();
    if (toe >= 0) forward += inverse * (at(world, f, toe) - at(world, f, foot));
    if (!stands[f]) continue;
    up += inverse.col(2);
    count++;
  }
  // Feet that stand on their toes, or lie, or turn while they stand, do not agree.
  const bool level = count >= 5 && up.norm() > 0.97 * static_cast<double>(count) &&
                     up.normalized().dot(standing_turn.col(2)) > 0.8;
  if (!level) up = standing_turn.col(2);
  if (forward.cross(up).norm() < 0.2 * forward.norm() || forward.norm() == 0) {
    return levelAxes(standing_turn.col(0), up);
  }
  return levelAxes(forward, up) * levelAxes(our_toe, Vector3d::UnitZ()).transpose();
}

void standOnFloor(const Clip& world, const Roles& r, const Anatomy& a, Targets& t) {
  const size_t bodies = heldBodies().size();
  const auto pose = [&](size_t f, int body) -> Isometry3d& { return t.poses[f * bodies + body]; };
  std::array<std::vector<bool>, 2> stands;
  std::vector<double> soles;  // heights of standing soles
  for (int k = 0; k < 2; k++) {
    stands[k].assign(t.frames, false);
    if (r.foot[k] < 0) continue;
    stands[k] = standing(world, r.foot[k], r.toe[k]);
    const Vector3d ankle = k ? mirror(a.landmark("ankle")) : a.landmark("ankle");
    for (size_t f = 0; f < t.frames; f++) {
      if (!stands[k][f]) continue;
      double lowest = INFINITY;
      for (const char* name : {"heel", "sole", "toe_tip"}) {
        const Vector3d p = k ? mirror(a.landmark(name)) : a.landmark(name);
        lowest = std::min(lowest, (pose(f, heldBody(k, kFoot)) * (p - ankle)).z());
      }
      soles.push_back(lowest);
    }
  }
  double floor;
  if (!soles.empty()) {
    floor = percentile(soles, 0.5);
  } else {
    // Nobody stands: the lowest body is as high as a foot's joint is above its sole.
    std::vector<double> heights;
    for (size_t f = 0; f < t.frames; f++) {
      double lowest = INFINITY;
      for (size_t b = 0; b < bodies; b++) {
        lowest = std::min(lowest, t.poses[f * bodies + b].translation().z());
      }
      heights.push_back(lowest);
    }
    floor = percentile(heights, 0.02) - (a.landmark("ankle").z() - a.landmark("sole").z());
    t.notes.push_back("no foot stands; the floor is put below the lowest bone");
  }
  for (Isometry3d& X : t.poses) X.translation().z() -= floor;

  // While a foot stands our ankle moves as the clip's does, at the mean distance between them.
  for (int k = 0; k < 2; k++) {
    if (r.foot[k] < 0) continue;
    struct Stance {
      size_t from, to;
      Vector3d offset;
    };
    std::vector<Stance> stances;
    for (size_t f = 0; f < t.frames; f++) {
      if (!stands[k][f]) continue;
      const Vector3d apart = pose(f, heldBody(k, kFoot)).translation() - at(world, f, r.foot[k]);
      if (f == 0 || !stands[k][f - 1]) stances.push_back({f, f, Vector3d::Zero()});
      stances.back().to = f;
      stances.back().offset += apart;
    }
    for (Stance& s : stances) s.offset /= static_cast<double>(s.to - s.from + 1);
    const double blend = std::max(1.0, kBlend * world.rate);
    for (size_t f = 0; f < t.frames; f++) {
      Vector3d move = Vector3d::Zero();
      double sum = 0;
      const Vector3d free = pose(f, heldBody(k, kFoot)).translation();
      for (const Stance& s : stances) {
        const double away = f < s.from ? static_cast<double>(s.from - f)
                            : f > s.to ? static_cast<double>(f - s.to)
                                       : 0.0;
        if (away >= blend) continue;
        const double x = 1 - away / blend, share = x * x * (3 - 2 * x);
        move += share * (at(world, f, r.foot[k]) + s.offset - free);
        sum += share;
      }
      if (sum == 0) continue;
      t.contact[f][k] = std::min(1.0, sum);
      pose(f, heldBody(k, kFoot)).translation() = free + move / std::max(1.0, sum);
    }
  }
}

}  // namespace torso::tools
