// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Motions of our own body of which every bone is known, to see how much of them retrofit finds
// again from pelvis, limbs and head.

#include <mujoco/mujoco.h>

#include <array>
#include <string>
#include <vector>

#include "tools/held_motion.h"
#include "tools/retrofit.h"
#include "tools/retrofit_model.h"
#include "tools/smoothness.h"

namespace torso::tools {

// Names of the motions; there are more, see truthMotion.
std::vector<std::string> truthMotions();

struct Truth {
  HeldMotion held;  // pelvis, head and the limbs
  int nq = 0;
  std::vector<double> qpos;  // (frames x nq) of BodyMjcf::pelvisOnHold
};

// Forward dynamics of the whole body under gravity at the model's time step: servos of levels and
// joints drive it, each along its own course (truth_motions.h). What retrofit does not know of it:
// the servos' moments, the body's weight and its inertia. Throws Error for an unknown motion, or if
// MuJoCo warns.
Truth makeTruth(const BodyMjcf& body, const std::string& motion, double rate);

// How far a retrofitted motion is from the truth: root mean squares over all frames of the angle of
// the rotation between the two.
struct TruthErrors {
  std::string motion;
  std::vector<double> levels;     // in the order of Posture::names, scapulae too [rad]
  std::array<double, 3> regions;  // lumbar (T12 on pelvis), thoracic (T1 on T12), head on T1 [rad]
  double worst_level = 0, worst_scapula = 0;  // [rad]
  std::string worst_level_name;
  double position_error = 0, rotation_error = 0;  // largest of a held bone [m], [rad]
  int frames = 0, flagged = 0;
  Smoothness smoothness, truth_smoothness;  // of our turns, and of the true ones
  double seconds = 0, core_seconds = 0;     // of motion, of work
};

TruthErrors compareWithTruth(const RetrofitModels& models, const Truth& truth,
                             const RetrofitResult& result);

}  // namespace torso::tools
