// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Lines of action of the trunk's muscles on the bones.

#include <string>
#include <vector>

#include "model/anatomy.h"
#include "model/skeleton.h"

namespace torso {

// Largest tension over section [Pa]: Bruno et al. 2015, J Biomech Eng 137:081003. Others take 0.46
// MPa (Bogduk et al. 1992, Spine 17:897-913), with which strong men cannot lift what they do.
constexpr double kLargestMuscleStress = 1e6;

struct MusclePoint {
  std::string body;          // that it is fixed to, see model/body.h
  Eigen::Vector3d position;  // at rest in the standing body [m]
  bool on_bone;              // an attachment, on the bone's surface; else the line is held there
};

// A fascicle: the same tension along straight lines from point to point, at least two.
struct MuscleLine {
  std::string name;   // of the fascicle and its side: "MF_m1s_left"
  std::string group;  // "multifidus"
  double section;     // physiological cross-section [m^2]
  std::vector<MusclePoint> points;
};

// Both sides of all rows of muscles.csv. Their sites are landmarks, or places on vertebrae that
// follow from vertebrae.csv and facets.csv, "site:level", levels S1, L5 .. C3:
//   spinous_tip, lamina          in the mid-plane (3 mm aside), at its tip and at its root
//   transverse_tip, accessory, transverse_front    tip, root behind and middle of the front of the
//                                transverse process
//   mamillary                    behind the superior articular process
//   body_side, disc_side         side of the body, at its middle and at its lower rim
//   longissimus, iliocostalis    where the thoracic fascicles pass under the aponeurosis of the
//                                erector spinae, which spans the tips of the spinous processes
// Throws std::runtime_error that names the fascicle and the site if there is none of its name.
std::vector<MuscleLine> makeMuscles(const Anatomy& anatomy);

// The same, attachments on the surfaces of the bones, where the skeleton has them.
std::vector<MuscleLine> makeMuscles(const Anatomy& anatomy, const Skeleton& skeleton);

}  // namespace torso
