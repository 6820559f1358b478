// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// From a clip to the poses at which the limbs, the head and the pelvis of the detailed body are
// held: the person is measured and our body made of that size (performer.h); each bone of the clip
// gives the pose of ours (makeTargets); inverse kinematics puts all of them onto the temporary
// skeleton (temporary_skeleton.h), which says what a body can do.

#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include "tools/clip.h"
#include "tools/held_motion.h"
#include "tools/performer.h"
#include "tools/role.h"

namespace torso::tools {

// HeldMotion::bodies.
const std::vector<std::string>& heldBodies();
constexpr int kPelvis = 0, kHead = 1;
enum LimbBody { kUpperArm, kLowerArm, kHand, kThigh, kShin, kFoot };
constexpr int heldBody(int side, LimbBody limb) { return 2 + 6 * side + limb; }  // side 0: left

// The clip's own bones, rescaled to our body.
struct Targets {
  size_t frames = 0;
  // By heldBodies(): the clip says how this body is turned. A body that it does not turn keeps its
  // rest pose to its parent.
  std::array<bool, 14> has{};
  std::vector<Eigen::Isometry3d> poses;   // frames x heldBodies(), row-major, world [m]
  std::vector<Eigen::Quaterniond> chest;  // frames: of the rib cage, as far as the clip's is one
  std::vector<std::array<double, 2>> contact;  // frames x 2: 1 while that foot stands, 0 while not
  bool has_chest = false;
  std::vector<std::string> notes;  // what was assumed, for the user
};

// Bones keep the clip's directions at every instant; how they turn about their own length follows
// the clip's joints, with elbow and knee axes found from how the limb bends. Pelvis, chest and head
// turn with the clip's joints from the pose in which the person stands, which is our body's rest
// pose. Shoulders and head keep the clip's motion against the trunk. Feet that stand in the clip
// stand still, flat on the floor at height 0. `world` is as inWorld returns it.
Targets makeTargets(const Clip& world, const Roles& roles, const Performer& performer);

struct Retargeted {
  HeldMotion motion;
  std::vector<std::vector<double>> qpos;  // frames: of temporarySkeletonMjcf(performer.anatomy)
};

// Damped least squares over the temporary skeleton, frame by frame from the last one, until steps
// are below 1e-5 rad. Errors and flags of the motion are against the targets.
Retargeted solveMotion(const Targets& targets, const Performer& performer, const std::string& name,
                       double rate);

}  // namespace torso::tools
