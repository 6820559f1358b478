// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mujoco/mujoco.h>

#include <array>
#include <string>
#include <vector>

#include "tools/mujoco_support.h"
#include "tools/whole_spine.h"

namespace torso::tools {

// Bones of the torso that a motion holds beside the pelvis, which does not move here at all.
constexpr std::array<const char*, 3> kHeldBones = {"head", "left_upper_arm", "right_upper_arm"};

// Springs between these bones and where a motion wants them. Stiff enough that a posture within
// human reach moves them by a millimetre or so, soft enough that one out of reach shows as their
// error and not as a torn spine: 10 mm is 1 kN. Assumed.
constexpr double kHoldStiffness = 1e5;          // [N/m]
constexpr double kHoldRotationStiffness = 600;  // [Nm/rad]
// A hold pulls no more than it would at this distance from its bone: 1.2 kN and 63 Nm, which no
// neck and no shoulder bears.
constexpr double kHoldReach = 0.012, kHoldTurn = 0.105;  // [m], [rad]

// Springs of the joints that Rhythm leads, in place of the model's own about the rest pose, and
// what SpineRhythm leaves of the servos' gains. The girdle's are half the gains of its servos
// (servos.csv); the head's and the share are assumed. On "random 1" to "random 12" of torso truth
// mean errors are the same within 8 % from 20 to 100 Nm/rad for the clavicle, 30 to 100 for scapula
// and 40 to 100 for head, and for shares from 0.1 to 1, so that these do not tell which to take.
// Among the like, results on the nine named motions were seen before these were taken: with 50 and
// 30 for the girdle "wave" is at 5.0 deg in the thorax.
struct RhythmStiffness {
  double head, sternoclavicular, acromioclavicular;  // [Nm/rad]
};
constexpr RhythmStiffness kRhythmStiffness = {40, 100, 50};
constexpr double kLevelServoShare = 0.2;

// The MJCF of a whole body (mjcf/human.xml, or one that `torso build` wrote), read once, and the
// models made from it in which nothing is left to look at: no meshes, skins, sensors, servos and
// scene, and of the geoms only the facets'.
class BodyMjcf {
 public:
  // Throws Error "<path>: ..." if it is no MJCF or lacks the bones that a motion holds.
  explicit BodyMjcf(const std::string& path);
  // The same from its text; messages begin with `name`.
  BodyMjcf(const std::string& text, const std::string& name);

  // The whole body as in the file.
  ModelPtr human() const;

  // The torso to be put to equilibrium: the pelvis is fixed at its place in the file, legs and
  // lower arms are gone, head and upper arms hang on springs to the mocap bodies "hold:<bone>". The
  // springs of the joints that Rhythm leads are left to it, the servos of the levels to
  // SpineRhythm. Mass, inertia, damping and viscosity only slow a search for equilibrium down, so
  // there is next to none. parts: ligaments and discs may be left out.
  ModelPtr torsoOnHolds(const SpineParts& parts = {}) const;

  // The whole body with its servos, the pelvis led by the mocap body "hold:pelvis". There is no
  // floor.
  ModelPtr pelvisOnHold() const;

 private:
  // World poses of bodies at rest: 3 numbers of place [m] and a quaternion for each.
  std::vector<double> restPosesOf(const std::vector<std::string>& bodies) const;

  std::string name_, text_;
};

}  // namespace torso::tools
