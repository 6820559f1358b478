// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "tools/posture.h"
#include "tools/retrofit_truth.h"

namespace torso::tools {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Turns = std::vector<std::vector<Vector3d>>;

// Products of the turns of a region's levels: of its uppermost bone on its lowest.
std::array<Quaterniond, 3> regionTurns(const Posture& posture,
                                       const std::vector<Quaterniond>& turns) {
  std::array<Quaterniond, 3> regions;
  regions.fill(Quaterniond::Identity());
  int region = 0;
  for (int i = 0; i < posture.levels(); i++) {
    const std::string& name = posture.names()[i];
    if (name == "T11/T12") region = 1;
    if (name == "C7/T1") region = 2;
    regions[region] = regions[region] * turns[i];
  }
  return regions;
}

}  // namespace

TruthErrors compareWithTruth(const RetrofitModels& models, const Truth& truth,
                             const RetrofitResult& result) {
  const mjModel* m = models.human.get();
  const Posture posture(m);
  const DataPtr d = makeData(m);
  const std::size_t frames = truth.held.frames(), n = posture.names().size();
  const auto turnsAt = [&](const std::vector<double>& qpos, std::size_t frame) {
    mju_copy(d->qpos, qpos.data() + frame * m->nq, m->nq);
    mj_kinematics(m, d.get());
    return posture.turns(d.get());
  };
  const auto vectors = [](const std::vector<Quaterniond>& turns) {
    std::vector<Vector3d> result;
    for (const Quaterniond& turn : turns) result.push_back(rotationVector(turn));
    return result;
  };
  TruthErrors errors;
  errors.motion = truth.held.name;
  errors.levels.assign(n, 0);
  errors.regions.fill(0);
  Turns ours, theirs;
  for (std::size_t frame = 0; frame < frames; frame++) {
    const auto found = turnsAt(result.qpos, frame), real = turnsAt(truth.qpos, frame);
    ours.push_back(vectors(found));
    theirs.push_back(vectors(real));
    for (std::size_t i = 0; i < n; i++) {
      errors.levels[i] += std::pow(found[i].angularDistance(real[i]), 2) / frames;
    }
    const auto a = regionTurns(posture, found), b = regionTurns(posture, real);
    for (int i = 0; i < 3; i++) {
      errors.regions[i] += std::pow(a[i].angularDistance(b[i]), 2) / frames;
    }
    const RetrofitFrame& read = result.frames[frame];
    errors.position_error = std::max(errors.position_error, read.position_error);
    errors.rotation_error = std::max(errors.rotation_error, read.rotation_error);
    errors.flagged += !read.flags.empty();
  }
  for (double& x : errors.levels) x = std::sqrt(x);
  for (double& x : errors.regions) x = std::sqrt(x);
  for (std::size_t i = 0; i < n; i++) {
    const bool level = static_cast<int>(i) < posture.levels();
    double& worst = level ? errors.worst_level : errors.worst_scapula;
    if (errors.levels[i] <= worst) continue;
    worst = errors.levels[i];
    if (level) errors.worst_level_name = posture.names()[i];
  }
  const Turns input = heldTurns(truth.held);
  errors.smoothness = smoothness(input, ours, truth.held.rate);
  errors.truth_smoothness = smoothness(input, theirs, truth.held.rate);
  errors.frames = static_cast<int>(frames);
  errors.seconds = frames / result.rate;
  errors.core_seconds = result.core_seconds;
  return errors;
}

}  // namespace torso::tools
