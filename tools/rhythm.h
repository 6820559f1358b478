// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Geometry>
#include <array>
#include <vector>

namespace torso::tools {

// Turns of the joints of a shoulder girdle from rest, in the standing axes of the parent bone.
struct GirdleTurns {
  Eigen::Quaterniond sternoclavicular, acromioclavicular;
};
// Of clavicle and scapula while the upper arm is raised against the rib cage by an angle [rad], as
// published (see rhythm.cc). side: 1 left, -1 right.
GirdleTurns girdleRhythm(double raised, double side);

// What muscles do in every person alike and discs, ligaments and facets do not: the shoulder girdle
// goes along when an arm is raised, and the joints between skull and axis take their share of the
// neck's turns. Springs of these ball joints about a pose that follows the held bones.
class Rhythm {
 public:
  // torso: of BodyMjcf::torsoOnHolds; human: the whole body, whose servos' ranges tell the shares.
  Rhythm(const mjModel* torso, const mjModel* human);

  // Sets qfrc_applied of the joints for the pose in d, for which mj_kinematics was called.
  void apply(const mjModel* torso, mjData* d) const;

 private:
  struct Shoulder {
    double side;                                       // 1 left, -1 right
    int humerus, sternoclavicular, acromioclavicular;  // body, joints
    Eigen::Vector3d shaft;  // of the humerus, its frame, towards the elbow
  };
  int ribcage_, head_, t1_;  // bodies
  int head_joint_;
  Eigen::Quaterniond head_rest_, t1_rest_;  // standing axes in the bodies' frames
  Eigen::Array3d head_share_;               // of the neck's lateral bending, flexion, rotation
  std::array<Shoulder, 2> shoulders_;
};

}  // namespace torso::tools
