// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/truth_motions.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <random>

#include "tools/error.h"
#include "tools/retrofit_truth.h"

namespace torso::tools {
namespace {

// Shares of the ranges of servos.csv, which are those of living people, level by level. The
// shoulder girdle's take it through what Ludewig et al. 2009, J Bone Joint Surg Am 91:378-389, saw
// in raising an arm: clavicle retracts, rises and rolls back, scapula turns up and tilts back.
const std::vector<TruthMotion>& motions() {
  static const std::vector<TruthMotion> all = {
      {"flexion",
       {{"L", "_flexion", 0.8},
        {"T", "_flexion", 0.5},
        {"C", "_flexion", 0.4},
        {"head", "_flexion", 0.3}}},
      {"extension",
       {{"L", "_flexion", -0.8},
        {"T", "_flexion", -0.4},
        {"C", "_flexion", -0.5},
        {"head", "_flexion", -0.3}}},
      {"side bend",
       {{"L", "_lateral_bending", 0.8},
        {"T", "_lateral_bending", 0.5},
        {"C", "_lateral_bending", 0.4}}},
      {"twist",
       {{"L", "_axial_rotation", 0.8},
        {"T", "_axial_rotation", 0.6},
        {"C", "_axial_rotation", 0.6},
        {"head", "_axial_rotation", 0.6}}},
      {"bend and twist",
       {{"L", "_flexion", 0.6},
        {"T", "_flexion", 0.3},
        {"L", "_axial_rotation", -0.6},
        {"T", "_axial_rotation", -0.6},
        {"L", "_lateral_bending", -0.4},
        {"T", "_lateral_bending", -0.4, 0.5, 1.5},
        {"C", "_axial_rotation", 0.5, 0.5, 1.5},
        {"head", "_axial_rotation", 0.5, 0.5, 1.5}}},
      {"reach up",
       {{"left_glenohumeral", "_flexion", 0.85},
        {"left_elbow", "_flexion", 0.1},
        {"left_sternoclavicular", "_elevation", 0.2},
        {"left_sternoclavicular", "_protraction", -0.4},
        {"left_sternoclavicular", "_posterior_rotation", 0.9},
        {"left_acromioclavicular", "_upward_rotation", 0.5},
        {"left_acromioclavicular", "_posterior_tilt", 0.6},
        {"L", "_lateral_bending", -0.3},
        {"T", "_lateral_bending", -0.3},
        {"C", "_flexion", -0.3},
        {"head", "_flexion", -0.4}}},
      {"reach forward",
       {{"left_glenohumeral", "_flexion", 0.7},
        {"right_glenohumeral", "_flexion", 0.7},
        {"left_sternoclavicular", "_protraction", 0.5},
        {"right_sternoclavicular", "_protraction", 0.5},
        {"left_acromioclavicular", "_internal_rotation", 0.4},
        {"right_acromioclavicular", "_internal_rotation", 0.4},
        {"left_sternoclavicular", "_posterior_rotation", 0.5},
        {"right_sternoclavicular", "_posterior_rotation", 0.5},
        {"left_acromioclavicular", "_upward_rotation", 0.3},
        {"right_acromioclavicular", "_upward_rotation", 0.3},
        {"left_acromioclavicular", "_posterior_tilt", 0.25},
        {"right_acromioclavicular", "_posterior_tilt", 0.25},
        {"L", "_flexion", 0.5},
        {"T", "_flexion", 0.4},
        {"L", "_axial_rotation", 0.3}}},
      {"sit-up",
       {{"L", "_flexion", 0.8, 0.3, 1.4},
        {"T", "_flexion", 0.6, 0.3, 1.2},
        {"C", "_flexion", 0.7, 0.2, 0.8},
        {"head", "_flexion", 0.4, 0.2, 0.8},
        {"left_hip", "_flexion", 0.4},
        {"right_hip", "_flexion", 0.4},
        {"left_knee", "_flexion", 0.5},
        {"right_knee", "_flexion", 0.5},
        {"left_glenohumeral", "_flexion", 0.5},
        {"right_glenohumeral", "_flexion", 0.5},
        {"left_sternoclavicular", "_posterior_rotation", 0.35},
        {"right_sternoclavicular", "_posterior_rotation", 0.35},
        {"left_acromioclavicular", "_upward_rotation", 0.2},
        {"right_acromioclavicular", "_upward_rotation", 0.2},
        {"left_acromioclavicular", "_posterior_tilt", 0.2},
        {"right_acromioclavicular", "_posterior_tilt", 0.2}},
       {-90, -60}},
      {"wave",
       {{"L", "_flexion", 0.6, 0.2, 1.0},
        {"T", "_flexion", -0.4, 0.5, 1.3},
        {"C", "_flexion", 0.5, 0.8, 1.6},
        {"head", "_flexion", 0.4, 0.8, 1.6},
        {"L", "_lateral_bending", 0.4, 0.6, 1.4},
        {"T", "_lateral_bending", -0.4, 0.4, 1.2}}},
  };
  return all;
}

// Between two numbers, the same on every machine.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double operator()(double low, double high) {
    return low + (high - low) * engine_() / std::mt19937::max();
  }

 private:
  std::mt19937 engine_;
};

// Each region bends to a side of its own, at a time of its own, its levels by their ranges of
// motion give or take three tenths; each arm rises somewhere, the girdle more or less with it.
TruthMotion randomMotion(unsigned seed) {
  Random random(seed);
  TruthMotion motion;
  motion.name = fmt::format("random {}", seed);
  motion.pelvis_pitch[1] = random(-20, 50);
  const std::vector<std::vector<std::string>> regions = {
      {"L5/S1", "L4/L5", "L3/L4", "L2/L3", "L1/L2"},
      {"T12/L1", "T11/T12", "T10/T11", "T9/T10", "T8/T9", "T7/T8", "T6/T7", "T5/T6", "T4/T5",
       "T3/T4", "T2/T3", "T1/T2"},
      {"C7/T1", "C6/C7", "C5/C6", "C4/C5", "C3/C4", "head"}};
  for (const std::vector<std::string>& levels : regions) {
    Eigen::Vector3d shares{random(-1, 1), random(-1, 1), random(-1, 1)};  // in this order
    shares *= random(0.2, 0.8) / shares.norm();
    const double from = random(0.2, 0.6), to = from + random(0.7, 1.1);
    const char* ends[] = {"_flexion", "_lateral_bending", "_axial_rotation"};
    for (const std::string& level : levels) {
      for (int k = 0; k < 3; k++) {
        motion.leads.push_back({level, ends[k], shares[k] * random(0.7, 1.3), from, to});
      }
    }
  }
  for (const std::string side : {"left_", "right_"}) {
    const double flexion = random(-0.2, 0.8), abduction = random(0, 0.6);
    const double raised = std::min(1.0, std::hypot(flexion, abduction));
    const double from = random(0.2, 0.6), to = from + random(0.7, 1.1);
    const auto lead = [&](const char* joint, const char* end, double share) {
      motion.leads.push_back({side + joint, end, share, from, to});
    };
    lead("glenohumeral", "_flexion", flexion);
    lead("glenohumeral", "_abduction", abduction);
    lead("sternoclavicular", "_elevation", raised * random(0, 0.4));
    lead("sternoclavicular", "_protraction", raised * random(-0.5, 0.5));
    lead("sternoclavicular", "_posterior_rotation", raised * random(0.6, 1));
    lead("acromioclavicular", "_upward_rotation", raised * random(0.2, 0.8));
    lead("acromioclavicular", "_posterior_tilt", raised * random(0.2, 0.8));
    lead("acromioclavicular", "_internal_rotation", raised * random(-0.4, 0.4));
  }
  return motion;
}

}  // namespace

std::vector<std::string> truthMotions() {
  std::vector<std::string> names;
  for (const TruthMotion& motion : motions()) names.push_back(motion.name);
  return names;
}

TruthMotion truthMotion(const std::string& name) {
  for (const TruthMotion& motion : motions()) {
    if (motion.name == name) return motion;
  }
  unsigned seed = 0;
  if (std::sscanf(name.c_str(), "random %u", &seed) == 1) return randomMotion(seed);
  throw Error(fmt::format("no motion is called '{}'; there are: {}, random N", name,
                          fmt::join(truthMotions(), ", ")));
}

}  // namespace torso::tools
