// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/spine_load.h"

#include <cmath>
#include <random>

#include "model/body.h"

namespace torso::tools {
namespace {

using Eigen::Vector3d;

constexpr double kGravity = 9.81, kStanding = 500;  // [m/s^2], [N]

struct LumbarLoad {
  double moment, follower;  // [Nm], [N]
};
LumbarLoad lumbarLoad(Turn turn) {
  switch (turn) {
    case Turn::kFlexion:
      return {7.5, 1175};
    case Turn::kExtension:
      return {7.5, 500};
    case Turn::kLeftBending:
      return {7.8, 700};
    case Turn::kLeftRotation:
      return {5.5, 720};
  }
  return {0, 0};
}

}  // namespace

std::vector<WeightAbove> weightAbove(const Anatomy& anatomy) {
  struct Part {
    double mass, height;
  };
  std::vector<Part> parts;
  for (const Vertebra& v : anatomy.vertebrae) {
    parts.push_back({v.slice_mass, (v.frame() * v.slice_com).z()});
  }
  parts.push_back({bodyInertial(anatomy, "head").mass, bodyInertial(anatomy, "head").com.z()});
  const double shoulder = anatomy.landmark("glenohumeral_centre_GH").z();
  for (const char* name : {"clavicle", "scapula", "upper_arm", "lower_arm", "hand"}) {
    parts.push_back({2 * anatomy.segment(name).mass, shoulder});
  }
  std::vector<WeightAbove> above;
  for (const Disc& disc : anatomy.discs) {
    const double level = disc.frame.translation().z();
    WeightAbove weight = {0, 0};
    for (const Part& part : parts) {
      if (part.height <= level) continue;
      weight.force += kGravity * part.mass;
      weight.moment += kGravity * part.mass * (part.height - level);
    }
    above.push_back(weight);
  }
  return above;
}

SpineLoad laboratoryLoad(const Anatomy& anatomy, const Vector3d& axis) {
  SpineLoad load;
  for (const Disc& disc : anatomy.discs) load.push_back({laboratoryMoment(disc.region) * axis, 0});
  return load;
}

SpineLoad standingLoad(const Anatomy& anatomy) {
  const std::vector<WeightAbove> above = weightAbove(anatomy);
  SpineLoad load;
  for (std::size_t i = 0; i < above.size(); i++) {
    const bool lumbar = anatomy.discs[i].region == Region::kLumbar;
    load.push_back({Vector3d::Zero(), lumbar ? kStanding : above[i].force});
  }
  return load;
}

SpineLoad voluntaryLoad(const Anatomy& anatomy, Turn turn) {
  const std::vector<WeightAbove> above = weightAbove(anatomy);
  const LumbarLoad lumbar = lumbarLoad(turn);
  SpineLoad load = standingLoad(anatomy);
  for (std::size_t i = 0; i < load.size(); i++) {
    const Region region = anatomy.discs[i].region;
    const bool axial = turn == Turn::kLeftRotation;
    double moment = lumbar.moment;
    if (region == Region::kCervical) moment = laboratoryMoment(region);
    if (region == Region::kThoracic && !axial) moment *= above[i].moment / above[0].moment;
    if (region == Region::kLumbar) load[i].follower = lumbar.follower;
    load[i].moment = moment * turnAxis(turn);
  }
  return load;
}

SpineLoad mixedLoad(const Anatomy& anatomy, const Vector3d& weights) {
  const Vector3d w = weights.normalized();
  const Turn turns[] = {w.x() > 0 ? Turn::kFlexion : Turn::kExtension, Turn::kLeftBending,
                        Turn::kLeftRotation};
  SpineLoad sum(anatomy.discs.size());
  for (int k = 0; k < 3; k++) {
    const SpineLoad load = voluntaryLoad(anatomy, turns[k]);
    for (std::size_t i = 0; i < sum.size(); i++) {
      sum[i].moment += (k == 0 ? std::abs(w[k]) : w[k]) * load[i].moment;
      sum[i].follower += w[k] * w[k] * load[i].follower;
    }
  }
  return sum;
}

std::vector<Vector3d> randomWeights(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Vector3d> weights(count);
  for (Vector3d& w : weights) {
    for (int k = 0; k < 3; k++) w[k] = normal(random);
  }
  return weights;
}

}  // namespace torso::tools
