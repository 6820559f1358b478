// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "model/anatomy.h"
#include "model/skeleton.h"
#include "tools/activity.h"
#include "tools/mujoco_support.h"

namespace torso::tools {

// A whole body with muscles that can be put into postures: pelvis, and feet or thorax and head, are
// held where they are put (on a bed thorax and head may slide along the body), which spares the
// legs to balance and changes nothing for the spine. Arms and legs are forty times as stiff as
// their servos, for they only have to carry; like those of thorax and neck their servos correct
// their targets until the posture is the one asked for. Servos of the lumbar spine are as ever.
// None have limits.
class PosedBody {
 public:
  // skeleton: of all bones. bones: folder of the bones' meshes, to be seen in
  // pictures; empty: none. Throws Error.
  PosedBody(const Anatomy& anatomy, const Skeleton& skeleton, const std::string& bones = "");

  mjModel* model() { return m_.get(); }
  mjData* data() { return d_.get(); }
  const mjData* data() const { return d_.get(); }
  double discArea(int disc) const;  // [m^2]
  // Into the posture, at rest, muscles off; servos aim at it. Throws Error if no lean
  // balances it, the hands do not reach the load or the lumbar spine is bent beyond published
  // ranges.
  void take(const Activity& activity);
  // Pressure in the abdomen [Pa] from now on, until the next take(): pushes rib cage and pelvis
  // apart between the centres of diaphragm and pelvic floor.
  void pressurise(double pressure) { abdominal_pressure_ = pressure; }
  // Its force on the rib cage [N], and where it acts, in the world.
  Eigen::Vector3d abdominalForce() const;
  Eigen::Vector3d diaphragm() const;
  double lean() const { return lean_; }  // forwards, about the ankles, that balances the body [rad]
  // Step until pressures and moments stand still. Throws Error if MuJoCo warns or they do not.
  void settle();

 private:
  struct Posture {
    double shin, thigh, pelvis, thorax, lumbar, upper_arm, forearm;  // pitches in the room, lumbar:
                                                                     // flexion [rad]
  };
  Posture leaning(const Activity& activity, double lean) const;
  void checkSpine(const Activity& activity) const;  // throws Error if it is bent too far
  void pose(const Posture& posture);
  Eigen::Vector3d grip() const;  // middle of the hands
  Eigen::Vector3d loadPoint(const Activity& activity) const;
  double balance(const Activity& activity);
  void applyForces();
  void showLoad();

  const Anatomy& anatomy_;
  ModelPtr m_;
  DataPtr d_;
  Activity activity_;
  std::vector<int> posture_servos_;    // all but those of the lumbar spine
  std::vector<double> aims_;           // lengths of all actuators in the posture
  std::vector<double> lumbar_shares_;  // of T12/L1 .. L5/S1, from below
  double abdominal_pressure_ = 0, lean_ = 0;
  double relaxed_balance_ = 0;  // centre of mass before the feet, standing relaxed [m]
};

}  // namespace torso::tools
