// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Geometry>
#include <vector>

#include "tools/follower_load.h"
#include "tools/joint_lead.h"
#include "tools/mujoco_support.h"
#include "tools/retrofit_model.h"
#include "tools/rhythm.h"
#include "tools/spine_rhythm.h"

namespace torso::tools {

// The torso of BodyMjcf::torsoOnHolds on its way to static equilibrium while its holds move. Its
// weight is the follower load on the discs; Rhythm leads the shoulder girdle and the upper neck.
//
// A step starts at rest, so that what mj_step integrates is a step of descent: the change of
// pose that the plugin's implicit rows (discs, ligaments, facets, holds) give to the forces at
// hand, with the discs' bound of stiffness in the place of their stiffness. Between two steps the
// pose runs on by a share of its last change (Nesterov's momentum), which makes up for that bound
// and for the motion of the holds. Steps that turn back on the one before are shortened: discs
// that are pulled out of shape are stiffer than their bound.
class Equilibrium {
 public:
  // torso: of torsoOnHolds; human: the whole body. They outlive the object and may serve several.
  Equilibrium(const mjModel* torso, const mjModel* human, double momentum);

  // Rest pose, all stresses gone.
  void reset();
  // The pose and the shapes of the discs, for another object of the same torso.
  std::vector<mjtNum> state() const;
  void setState(const std::vector<mjtNum>& state);
  // Where the held bones are to be, in the order of kHeldBones, in the frame of the pelvis. A hold
  // stays within its reach of the bone as this is now.
  // up: where up is in that frame, unit; zero where there is no weight.
  void hold(const std::vector<Eigen::Isometry3d>& poses, const Eigen::Vector3d& up);
  // Leads the joints to these turns (JointLead) from now on; only if the torso is of ledModel.
  void lead(const Eigen::Matrix3Xd& turns) { lead_goal_ = turns; }
  // One step; returns the largest turn of a joint or free body by descent, momentum apart [rad]: 0
  // in equilibrium.
  double step();
  // Brings all that d holds up to the pose, the forces of ligaments and facets too.
  void forward();

  const mjModel* model() const { return m_; }
  mjData* data() { return d_.get(); }
  // Turns of the joints that can be led.
  Eigen::Matrix3Xd turns() { return lead_.turns(m_, d_.get()); }
  // Pose of a body in the frame of the pelvis.
  Eigen::Isometry3d pose(int body) const;
  // Poses of the held bones at rest.
  const std::vector<Eigen::Isometry3d>& restPoses() const { return rest_poses_; }
  // Body ids of the held bones.
  const std::vector<int>& heldBodies() const { return held_; }

 private:
  const mjModel* m_;
  DataPtr d_;
  Rhythm rhythm_;
  SpineRhythm spine_;
  FollowerLoad load_;
  JointLead lead_;
  Eigen::Matrix3Xd lead_goal_;                    // none: not led
  Eigen::Vector3d up_ = Eigen::Vector3d::Zero();  // in the world
  double momentum_;
  int pelvis_;
  std::vector<int> held_, mocap_;
  std::vector<Eigen::Isometry3d> rest_poses_;
  std::vector<mjtNum> change_;   // (nv) over the last step, over its time
  std::vector<mjtNum> descent_;  // (nv) of the last step, without momentum
  std::vector<mjtNum> start_;    // (nq) of a step
  double share_ = 1;             // of a step that is taken
};

}  // namespace torso::tools
