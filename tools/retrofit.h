// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// From the poses at which a clip holds pelvis, head and limbs to the motion of every vertebra, rib
// cage, clavicle and scapula.

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "tools/held_motion.h"
#include "tools/mujoco_support.h"
#include "tools/retrofit_model.h"

namespace torso::tools {

struct RetrofitOptions {
  double steps = 200;  // of descent per second, at least two per frame; the holds move on a little
                       // before each, and more of them are taken where the holds move fast
  double led_steps = 120;  // the same of the second pass
  bool over_time = true;   // false: no lead in the second pass, frame by frame as the first
  double momentum = 0.7;   // see Equilibrium
  double weight = 1;       // share of the body's weight that its discs bear, see FollowerLoad

  // A frame is flagged beyond these. A human spine cannot reach what would take more.
  double position_error = 0.010;               // of a held bone [m]
  double rotation_error = 3 * EIGEN_PI / 180;  // [rad]
  // Ligaments of the lumbar spine tear at 130 (interspinous) to 450 N (anterior longitudinal):
  // Pintar et al. 1992, J Biomech 25:1351-1356.
  double ligament_tension = 300;         // [N]
  double unrest = 0.5 * EIGEN_PI / 180;  // RetrofitFrame::unrest [rad]
};

// The models that clips of one body are worked on with: made once, read by many threads.
struct RetrofitModels {
  explicit RetrofitModels(const BodyMjcf& body, const SpineParts& parts = {});
  ModelPtr human;      // the whole body: results are in its qpos, as of the MJCF file
  ModelPtr torso;      // BodyMjcf::torsoOnHolds
  ModelPtr led_torso;  // JointLead::ledModel
};

// What a frame's equilibrium tells. Per level: in the order of Posture, L5/S1 first.
struct RetrofitFrame {
  double position_error = 0, rotation_error = 0;  // of the held bone furthest off [m], [rad]
  double unrest = 0;  // how far from equilibrium: largest turn by the last step of descent [rad]
  std::vector<Eigen::Vector3d> turns;  // of levels and scapulae, rotationVector [rad]
  std::vector<double> pressures;       // of discs [Pa]
  std::vector<double> ligaments;       // per level the largest tension [N]
  std::vector<double> facets;          // per facet the force [N]
  std::vector<std::string> flags;      // why this frame is not to be trusted; none: it is
};

struct RetrofitResult {
  std::string name;  // of the clip
  double rate = 0;   // [Hz]
  int nq = 0;
  std::vector<double> qpos;  // (frames x nq) of the whole body
  std::vector<RetrofitFrame> frames;
  double core_seconds = 0;  // processor time of this thread
};

// Two passes over the frames. The first one brings the torso to static equilibrium at every frame,
// each from the last one; where a neck pressed together has two equilibria, or a shoulder blade
// comes to the end of its reach, it snaps from one to the next within a frame. The turns of levels
// and girdle are then made as smooth as the motion of the held bones (limitSecondDifferences,
// ExplainedJumps), and the second pass leads the joints along these courses (JointLead) by springs,
// as muscles would, with discs, ligaments and facets in equilibrium with them and the bones held.
// Where the first pass is smooth the springs give no moment. The weight of the body presses the
// discs together and does not bend the spine: a passive torso would buckle where muscles let a
// person stand. Thread-safe, one mjData per pass. progress, if any, gets the share done and may
// throw to cancel. Throws Error "<clip>: ..." if the motion has no
// pelvis, no frame, or a number that is not finite.
RetrofitResult retrofit(const RetrofitModels& models, const HeldMotion& motion,
                        const RetrofitOptions& options,
                        const std::function<void(double)>& progress = nullptr);

}  // namespace torso::tools
