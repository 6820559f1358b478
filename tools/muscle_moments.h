// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// What muscles and servos do about the discs of a posed model.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <string>
#include <vector>

namespace torso::tools {

// A plane through a disc that parts the body in two: what is above hangs on this disc, its
// ligaments, facets and muscles only. From L5/S1 to T12/L1; above, the muscles of muscles.csv are
// not all there are, and above T10 ribs bridge the discs: servos keep those levels.
struct Cut {
  std::string disc;         // "L4/L5"
  int site;                 // the disc's frame, on its lower bone
  std::vector<int> servos;  // actuators between its two bones
};

class MuscleMoments {
 public:
  // m: a whole body with muscles (MjcfOptions::muscles) without a prefix. Outlives this. Throws
  // Error if a disc or the muscles are missing.
  explicit MuscleMoments(const mjModel* m);

  const std::vector<Cut>& cuts() const { return cuts_; }        // from below
  const std::vector<int>& muscles() const { return muscles_; }  // actuators
  Eigen::VectorXd sections() const;                             // of muscles() [m^2]

  // Moments about the discs' centres on what is above, in the world frame, of a unit of tension in
  // each muscle (3 cuts x muscles) [m]; need mj_kinematics.
  Eigen::MatrixXd arms(const mjData* d) const;
  // What a unit of tension in each muscle presses each disc with, along the disc's axis (cuts x
  // muscles); needs mj_kinematics.
  Eigen::MatrixXd pulls(const mjData* d) const;
  // Moments about the discs' centres of the weight of what is above and of the forces applied to it
  // (xfrc_applied), in the world frame (3 cuts) [Nm]; needs mj_kinematics. For a body that is held
  // below the cuts only.
  Eigen::VectorXd externalMoments(const mjData* d) const;
  // The same of the servos between the bones at each cut [Nm] (3 cuts); needs mj_forward.
  Eigen::VectorXd servoMoments(const mjData* d) const;
  // Tensions (muscles) [N], and the controls that give them.
  Eigen::VectorXd tensions(const mjData* d) const;
  void setTensions(mjData* d, const Eigen::VectorXd& tensions) const;

 private:
  // Calls at(cut, muscle, point, direction) for each stretch of a muscle that passes a cut: its end
  // above and where it pulls that to.
  template <class At>
  void forCrossings(const mjData* d, const At& at) const;

  const mjModel* m_;
  std::vector<Cut> cuts_;
  std::vector<int> muscles_;
  std::vector<int> rank_;  // by body: how many cuts it is above
};

}  // namespace torso::tools
