// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/smoothness.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unsupported/Eigen/FFT>

#include "model/body.h"
#include "tools/graft_xml.h"
#include "tools/posture.h"
#include "tools/retrofit_model.h"

namespace torso::tools {
namespace {

using Eigen::Isometry3d;
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

// Poses of kHeldBones on the pelvis, frame by frame; of a bone that is not in the motion always the
// same.
std::vector<std::vector<Isometry3d>> onPelvis(const HeldMotion& held) {
  const std::size_t n = held.bodies.size();
  const auto at = [&](std::size_t frame, std::size_t body) {
    const auto& p = held.positions[frame * n + body];
    const auto& q = held.quaternions[frame * n + body];
    return isometry(Quaterniond(q[0], q[1], q[2], q[3]), Vector3d(p.data()));
  };
  const auto column = [&](const std::string& body) {
    return std::find(held.bodies.begin(), held.bodies.end(), body) - held.bodies.begin();
  };
  const std::size_t pelvis = column("pelvis");
  std::vector<std::vector<Isometry3d>> poses(held.frames());
  for (const char* bone : kHeldBones) {
    const std::size_t i = column(bone);
    for (std::size_t frame = 0; frame < poses.size(); frame++) {
      poses[frame].push_back(i < n ? at(frame, pelvis).inverse() * at(frame, i)
                                   : Isometry3d::Identity());
    }
  }
  return poses;
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
  const std::vector<std::vector<Isometry3d>> poses = onPelvis(held);
  Turns turns(poses.size());
  for (std::size_t frame = 0; frame < poses.size(); frame++) {
    for (std::size_t i = 0; i < poses[frame].size(); i++) {
      const Quaterniond now(poses[frame][i].linear());
      if (frame == 0) {
        turns[0].push_back(rotationVector(now));
        continue;
      }
      const Quaterniond before(poses[frame - 1][i].linear());
      turns[frame].push_back(turns[frame - 1][i] + rotationVector(now * before.conjugate()));
    }
  }
  return turns;
}

ExplainedJumps::ExplainedJumps(const HeldMotion& held) {
  constexpr double kTrunk = 0.12, kNeck = 0.36, kGirdle = 0.24;
  constexpr double kLever = 0.15;  // [m]
  const std::vector<std::vector<Isometry3d>> poses = onPelvis(held);
  const Turns turns = heldTurns(held);
  const auto second = [](const auto& at, std::size_t t) {
    return (at(t + 1) - 2 * at(t) + at(t - 1)).norm();
  };
  const std::size_t frames = poses.size();
  const auto zero = std::vector<double>(frames, 0);
  trunk_ = neck_ = girdle_[0] = girdle_[1] = zero;
  for (std::size_t t = 1; t + 1 < frames; t++) {
    double farthest = 0, turned = 0;
    for (std::size_t i = 0; i < poses[t].size(); i++) {
      const double moved =
          second([&](std::size_t f) { return Vector3d(poses[f][i].translation()); }, t) / kLever;
      farthest = std::max(farthest, moved);
      if (i == 0) {
        turned = second([&](std::size_t f) { return turns[f][0]; }, t);
        neck_[t] = kNeck * (turned + moved);
      } else {  // an arm's turn about its own length moves no scapula
        const double swung =
            second([&](std::size_t f) { return Vector3d(poses[f][i].linear().col(2)); }, t);
        girdle_[i - 1][t] = kGirdle * (swung + moved);
      }
    }
    trunk_[t] = kTrunk * (turned + farthest);
  }
  for (std::vector<double>* jumps : {&trunk_, &neck_, &girdle_[0], &girdle_[1]}) {
    const std::vector<double> own = *jumps;
    for (std::size_t t = 0; t + 1 < frames; t++) {
      (*jumps)[t] = std::max((*jumps)[t], own[t + 1]);
      (*jumps)[t + 1] = std::max((*jumps)[t + 1], own[t]);
    }
  }
}

const std::vector<double>& ExplainedJumps::of(const std::string& joint) const {
  const Side side = splitSide(joint).first;
  if (side != Side::kMiddle) return girdle_[side == Side::kLeft ? 0 : 1];
  return joint == "head" || joint[0] == 'C' ? neck_ : trunk_;
}

double ExplainedJumps::largestBeyond(const std::vector<std::string>& names,
                                     const Turns& turns) const {
  double largest = 0;
  for (std::size_t t = 1; t + 1 < turns.size(); t++) {
    for (std::size_t k = 0; k < names.size(); k++) {
      const double jump = (turns[t + 1][k] - 2 * turns[t][k] + turns[t - 1][k]).norm();
      largest = std::max(largest, jump - of(names[k])[t]);
    }
  }
  return largest;
}

}  // namespace torso::tools
