// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "model/bone_vertebra.h"
#include "model/rotation.h"

namespace torso {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

Vector3d laminaMiddle(const VertebraPlan& plan) {
  return {plan.canal_end - 3.1_mm, 0, -0.42 * plan.half_height};
}

// Broad plates that cover each other from level to level like tiles.
void addLaminae(Blend& bone, const VertebraPlan& plan) {
  const Vector3d end = plan.pedicle_end, middle = laminaMiddle(plan);
  const double y = plan.canal_half, tall = 1.02 * plan.half_height;
  TubeStyle style;
  style.squareness = 2.8;
  style.up = Vector3d(0.20, 0, 1);
  const Vector3d side(end.x() - 2.2_mm, y + 2.2_mm, end.z() - 3.0_mm);
  const Vector3d half(0.5 * middle.x() + 0.5 * side.x() - 0.8_mm, 0.66 * y + 1.0_mm,
                      0.6 * middle.z() + 0.4 * side.z());
  bone.unitePair(rod({{end + pointMm(0, 0.5, -0.5), 3.6_mm, 0.55 * plan.v.pedicle_height},
                      {side, 3.4_mm, 0.78 * tall},
                      {half, 3.0_mm, tall},
                      {middle, 3.3_mm, tall}},
                     style),
                 3.0_mm);
}

// Long and three-sided, steep in the middle of the thorax; T11 and T12 have the loins' plate.
void addSpinousProcess(Blend& bone, const VertebraPlan& plan) {
  const Vector3d tip = plan.spinous_tip, root = laminaMiddle(plan) + pointMm(0.5, 0, 0);
  const Vector3d along = (tip - root).normalized();
  const double length = (tip - root).norm();
  TubeStyle style;
  style.up = Vector3d(along.z(), 0, -along.x());  // across it, in the mid-plane
  style.cap = 0.8;
  const int n = plan.number();
  if (n >= 11) {
    style.squareness = 2.8;
    const double tall = n == 12 ? 8.0_mm : 6.5_mm;
    bone.unite(rod({{root, 4.2_mm, 8.0_mm},
                    {root + 0.4 * length * along, 2.6_mm, tall - 0.8_mm},
                    {root + 0.75 * length * along, 2.6_mm, tall},
                    {tip - 2.6_mm * along, 3.2_mm, tall - 1.5_mm}},
                   style),
               4.5_mm);
    return;
  }
  style.squareness = 2.2;
  const double steep = std::clamp((std::atan2(-along.z(), -along.x()) - 0.7) / 0.5, 0.0, 1.0);
  const double cap = 0.8 * 2.6_mm;
  bone.unite(rod({{root, 4.6_mm, 7.5_mm - 2.0_mm * steep},
                  {root + 0.3 * length * along, 3.3_mm, 5.2_mm - 1.2_mm * steep},
                  {root + 0.7 * length * along, 2.3_mm, 3.8_mm - 1.0_mm * steep},
                  {tip - cap * along, 2.9_mm, 3.2_mm - 0.6_mm * steep}},
                 style),
             4.0_mm);
}

void addArticularProcesses(Blend& bone, const VertebraPlan& plan) {
  const Vector3d end = plan.pedicle_end;
  const VertebraPlan::Face &s = plan.superior, &i = plan.inferior;
  TubeStyle style;
  style.cap = 0.8;
  style.up = s.frame.linear().col(2);
  const Vector3d root(s.behind(2.5_mm).x() + 0.5_mm, 0.5 * (end.y() + s.behind(2.5_mm).y()),
                      end.z() - 1.0_mm);
  bone.unitePair(rod({{root, 5.0_mm, 3.0_mm},
                      {s.at(0, -0.1 * s.height, -2.4_mm), 0.46 * s.width, 2.2_mm},
                      {s.at(0, 0.28 * s.height, -1.9_mm), 0.36 * s.width, 1.7_mm}},
                     style),
                 3.0_mm);
  // The inferior ones are the lower corners of the laminae.
  const Vector3d middle = laminaMiddle(plan);
  const Vector3d from(middle.x() + 1.0_mm, 0.9 * i.frame.translation().y(), middle.z() + 1.0_mm);
  style.up = i.frame.linear().col(2);
  bone.unitePair(rod({{from, 5.0_mm, 2.6_mm},
                      {i.at(0, 0.1 * i.height, -2.6_mm), 0.46 * i.width, 2.4_mm},
                      {i.at(0, -0.28 * i.height, -2.0_mm), 0.38 * i.width, 1.9_mm}},
                     style),
                 3.0_mm);
  addFace(bone, s, 3.2_mm, 2.0_mm);
  addFace(bone, i, 3.2_mm, 2.0_mm);
  if (plan.number() == 12) {  // mammillary process
    bone.unitePair(ellipsoidSolid(s.at(-0.5 * s.width, 0, -3.5_mm), pointMm(3, 2.8, 4.2)), 2.5_mm);
  }
}

// A club, whose front carries the rib's tubercle.
void addTransverseProcess(Blend& bone, const VertebraPlan& plan) {
  const Vector3d end = plan.pedicle_end;
  const double span = plan.v.transverse_process_span / 2;
  const CostalJoint* joint = plan.costalJoint(plan.v.name, true);
  TubeStyle style;
  style.cap = 0.9;
  const Vector3d root(end.x() - 1.5_mm, end.y(), end.z() - 1.5_mm);
  if (joint == nullptr) {
    // T11, T12: short, with a tubercle each above, below and outside.
    const double r = 3.4_mm;
    const Vector3d tip(end.x() - 8.0_mm, span - 0.9 * r, end.z() - 3.0_mm);
    bone.unitePair(rod({{root, 4.5_mm, 5.5_mm}, {tip, r, 1.1 * r}}, style), 3.0_mm);
    bone.unitePair(ellipsoidSolid(tip + pointMm(-2.0, -2.0, -4.0), pointMm(2.4, 2.4, 3.2)), 2.0_mm);
    return;
  }
  const double r = 4.2_mm;
  const Vector3d p = joint->position, normal = Vector3d(1, 0.4, 0.1).normalized();
  const Vector3d tip(p.x() - 0.9 * r, span - 0.92 * r, p.z());
  const Vector3d along = (tip - root).normalized();
  bone.unitePair(rod({{root, 4.4_mm, 5.2_mm},
                      {0.5 * (root + tip), 3.7_mm, 4.7_mm},
                      {tip - 2.5_mm * along, 0.88 * r, 1.05 * r},
                      {tip, 0.9 * r, 1.1 * r}},
                     style),
                 3.0_mm);
  // Its face: a shallow dish.
  Isometry3d X = Isometry3d::Identity();
  X.translate(p);
  X.linear() = leastRotation(Vector3d::UnitZ(), normal).toRotationMatrix();
  bone.unitePair(facePlate(X, 9.5_mm, 9.5_mm, 4.0_mm, 1.0_mm), 2.5_mm);
  bone.carvePair(ellipsoidSolid(p + 11.2_mm * normal, Vector3d::Constant(12.0_mm)), 0.5_mm);
}

// Half a socket at the body's upper edge for the rib of its own level, and half a one below for
// the next rib.
void carveCostalFacets(Blend& bone, const VertebraPlan& plan) {
  constexpr double kRibHead = 5.0_mm;
  const auto socket = [&](const Vector3d& joint) {
    // The table's joint of T1 lies in the pedicle; the socket, on it.
    const double pedicle = plan.canal_half + plan.v.pedicle_width;
    const bool on_pedicle = joint.y() < pedicle - 4.0_mm;
    const Vector3d centre(joint.x(), on_pedicle ? pedicle - 1.5_mm : joint.y(), joint.z());
    // A low mound between the body's corner and the pedicle carries it.
    const double z = std::clamp(joint.z(), 4.2_mm - plan.half_height, plan.half_height - 4.2_mm);
    const Vector3d corner(0.5 * (joint.x() + plan.back) + 2.0_mm, 0.62 * joint.y(), z);
    if (!on_pedicle) bone.unitePair(ellipsoidSolid(corner, pointMm(4.5, 4.0, 3.4)), 2.2_mm);
    const Vector3d out = Vector3d(0.35, 0.94, 0).normalized();
    bone.carvePair(ellipsoidSolid(centre + 4.2_mm * out, Vector3d::Constant(kRibHead)), 0.8_mm);
  };
  if (const CostalJoint* own = plan.costalJoint(plan.v.name, false)) socket(own->position);
  const std::string below = plan.levelBelow();
  if (const CostalJoint* next = plan.costalJoint(below, false)) {
    const Vector3d p = plan.v.frame().inverse() * (plan.anatomy.boneFrame(below) * next->position);
    if (p.z() > -1.6 * plan.half_height) socket(p);
  }
}

}  // namespace

void addThoracicArch(Blend& bone, const VertebraPlan& plan) {
  addLaminae(bone, plan);
  addSpinousProcess(bone, plan);
  carveCanal(bone, plan);
  addTransverseProcess(bone, plan);
  addArticularProcesses(bone, plan);
  clearFace(bone, plan.superior);
  outlineFace(bone, plan.superior);
  clearFace(bone, plan.inferior);
  carveCostalFacets(bone, plan);
}

}  // namespace torso
