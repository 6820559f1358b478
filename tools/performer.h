// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The person whose motion a clip holds: where up is, how large the person is, and our body in that
// size.

#include <Eigen/Core>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "model/anatomy.h"
#include "tools/clip.h"
#include "tools/role.h"

namespace torso::tools {

struct Performer {
  double unit;           // of the file [m]
  Eigen::Matrix3d axes;  // from the file's axes to ours, z up
  // A pose in which the person stands about upright: the rest pose, or a frame of the clip.
  bool stands = false;       // false: none was found, and the rest pose is taken for one
  int standing_frame = -1;   // -1: the rest pose
  double standing_size = 1;  // lengths in the frames to those in that pose
  // Of that pose, in the file's axes and unit: upper arms' joints left and right, where they would
  // be if the arms hung. Rigs raise the shoulders with the arms, and many stand with raised arms.
  std::array<Eigen::Vector3d, 2> hanging_shoulders{};
  double torso_scale;                        // of trunk, head and shoulders to the tables'
  std::map<std::string, double> limb_scale;  // on top of it, by segment, as withLimbs takes them
  Anatomy anatomy;                           // our body of that size
  std::vector<std::string> notes;            // what was assumed, for the user
};

// The clip in metres and our axes, z up: x, y, z of a file with y up become y, z, x of ours.
Clip inWorld(const Clip& clip, const Performer& performer);

// Our body in the size of the person: limbs by the length of each segment (mean of both sides and
// of the clip), trunk and head by the distance from the middle of the hips to the middle of the
// shoulders in standing. Lengths that the clip does not have go with the others. The file's unit is
// what it declares or else a usual one, if that gives a stature between 1.3 and 2.2 m; otherwise
// the stature is taken to be the tables'. Throws Error "<path>: ..." for bones without length.
Performer measurePerformer(const Anatomy& tables, const Clip& clip, const Roles& roles);

// The clip's pose in which the person stands, after inWorld.
const Eigen::Isometry3d& standingPose(const Clip& world, const Performer& performer, int joint);

// MJCF of the detailed body in that size, as human.xml but without a scene. Fits ligaments and
// facets to the bones of `meshes`, a folder of `torso build` at the tables' size, which the MJCF
// refers to as `mesh_dir`; feet stand at height 0. Throws Error.
std::string performerMjcf(const Anatomy& tables, const Performer& performer,
                          const std::string& meshes, const std::string& mesh_dir);

}  // namespace torso::tools
