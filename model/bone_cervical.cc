// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "model/bone_vertebra.h"

namespace torso {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

Vector3d laminaMiddle(const VertebraPlan& plan) { return {plan.canal_end - 2.0_mm, 0, -1.5_mm}; }

// The articular pillar between the two faces.
Vector3d pillar(const VertebraPlan& plan) {
  const Vector3d low = plan.inferior.behind(3.0_mm);
  if (!plan.has_superior) return {low.x() + 3.0_mm, low.y(), 0};
  return 0.5 * (low + plan.superior.behind(3.0_mm));
}

void addLaminae(Blend& bone, const VertebraPlan& plan) {
  const Vector3d middle = laminaMiddle(plan), side = pillar(plan);
  const double tall = plan.number() == 2 ? 5.8_mm : 0.8 * plan.half_height;
  TubeStyle style;
  style.squareness = 2.8;
  style.up = Vector3d(0.35, 0, 1);
  // Flat roofs over a three-sided canal, of which the cord needs the ellipse.
  const double thick = plan.number() == 2 ? 2.6_mm : 2.2_mm;
  const Vector3d half(plan.canal_end + 0.10 * plan.v.canal_depth - thick, 0.52 * plan.canal_half,
                      0.5 * (middle.z() + side.z()));
  bone.unitePair(
      rod({{side, 3.0_mm, tall}, {half, thick, tall}, {middle, 1.15 * thick, tall}}, style),
      2.5_mm);
}

void addSpinousProcess(Blend& bone, const VertebraPlan& plan) {
  const Vector3d tip = plan.spinous_tip, root = laminaMiddle(plan);
  const Vector3d along = (tip - root).normalized();
  const double length = (tip - root).norm();
  TubeStyle style;
  style.up = Vector3d(along.z(), 0, -along.x());
  style.cap = 0.9;
  if (plan.number() == 7) {  // vertebra prominens
    bone.unite(rod({{root, 3.6_mm, 5.0_mm},
                    {root + 0.35 * length * along, 2.6_mm, 3.8_mm},
                    {root + 0.75 * length * along, 2.6_mm, 3.4_mm},
                    {tip - 2.9_mm * along, 3.6_mm, 3.3_mm}},
                   style),
               4.0_mm);
    return;
  }
  // Two horns, unequal in life; each ends beside the table's tip.
  const bool axis = plan.number() == 2;
  const double spread = axis ? 5.5_mm : plan.number() == 6 ? 2.8_mm : 4.0_mm;
  const double r = axis ? 2.8_mm : 2.1_mm;
  const Vector3d fork = tip - std::min(axis ? 9.0_mm : 5.5_mm, 0.5 * length) * along;
  bone.unite(rod({{root, axis ? 4.5_mm : 3.4_mm, axis ? 6.5_mm : 5.0_mm},
                  {0.5 * (root + fork), axis ? 3.6_mm : 2.8_mm, axis ? 5.0_mm : 4.0_mm},
                  {fork, axis ? 4.2_mm : 3.4_mm, axis ? 4.0_mm : 3.2_mm}},
                 style),
             3.0_mm);
  const Vector3d horn = tip - 0.9 * r * along + Vector3d(0, spread, 0);
  const Vector3d bend = 0.5 * (fork + horn) + Vector3d(0, 0.5_mm, 0) + pointMm(0, 0, 0.4);
  bone.unitePair(rod({{fork + Vector3d(0, 0.8_mm, 0), 2.2_mm, 2.4_mm},
                      {bend, 0.95 * r, 1.05 * r},
                      {horn, r, 1.15 * r}},
                     style),
                 1.5_mm);
}

void addPillars(Blend& bone, const VertebraPlan& plan) {
  const VertebraPlan::Face &s = plan.superior, &i = plan.inferior;
  TubeStyle style;
  style.up = Vector3d::UnitX();
  style.squareness = 3;
  style.cap = 0.3;
  if (plan.has_superior) {
    bone.unitePair(rod({{i.behind(2.5_mm), 0.44 * i.width, 0.40 * i.height},
                        {pillar(plan), 0.46 * i.width, 5.6_mm},
                        {s.behind(2.5_mm), 0.44 * s.width, 0.40 * s.height}},
                       style),
                   2.5_mm);
    addFace(bone, s, 3.5_mm, 1.5_mm);
  } else {  // C2: from the lateral mass below C1
    bone.unitePair(rod({{pointMm(0, 14, 4), 5.5_mm, 6.0_mm},
                        {pillar(plan) + pointMm(3, -1, -3), 4.6_mm, 5.0_mm},
                        {i.behind(2.5_mm), 0.44 * i.width, 0.40 * i.height}},
                       style),
                   3.0_mm);
  }
  addFace(bone, i, 3.5_mm, 1.5_mm);
}

// Hooks on the sides of the upper endplate, beside the disc above: from the rim upwards and out, so
// that between them the endplate keeps its width.
void addUncinateProcesses(Blend& bone, const VertebraPlan& plan) {
  const double y = plan.v.upper_endplate_width / 2, z = plan.half_height;
  const double depth = plan.v.upper_endplate_depth, lean = 0.7;
  TubeStyle style;
  style.squareness = 2.3;
  style.up = Vector3d(0, lean, 1);
  const auto hook = [&](double x, double out, double foot, double top) {
    const double middle = (foot + top) / 2, half = (top - foot) / 2;
    return Section{pointMm(0, out + lean * middle, middle) + Vector3d(x * depth, y, z), 1.2_mm,
                   std::hypot(1, lean) * half * 1e-3};
  };
  const double high = plan.number() == 7 ? 2.2 : 2.9;
  bone.unitePair(rod({hook(0.16, -0.6, -1.8, -0.3), hook(0.02, 0.2, -0.5, 0.6 * high),
                      hook(-0.16, 0.4, -0.2, high), hook(-0.34, 0.5, -0.2, 0.75 * high)},
                     style),
                 1.3_mm);
}

// Two bars around the foramen of the vertebral artery, with a tubercle each; the groove between
// these lets the nerve out.
void addTransverseProcess(Blend& bone, const VertebraPlan& plan) {
  const Vector3d side = pillar(plan);
  const double span = plan.v.transverse_process_span / 2;
  const double width = (plan.v.upper_endplate_width + plan.v.lower_endplate_width) / 2;
  const int n = plan.number();
  const bool c7 = n == 7;
  TubeStyle style;
  style.cap = 0.9;
  const double r = 1.9_mm, foramen = c7 ? 2.4_mm : 2.9_mm;
  const double hole_y = 0.5 * (width / 2 + side.y()) + 1.8_mm;
  const Vector3d hole(-0.22 * plan.v.upper_endplate_depth + 1.0_mm, hole_y, 0);
  // Tips: the rear tubercle is the table's, the front one lies nearer.
  const Vector3d rear(hole.x() - (c7 ? 7.0_mm : 5.0_mm), span - 0.95 * 1.3 * r,
                      c7 ? -2.0_mm : -3.4_mm);
  const double carotid = n == 6 ? 0.9_mm : 0;  // C6: the carotid tubercle
  const Vector3d front(hole.x() + (c7 ? 3.2_mm : 4.2_mm),
                       std::max(hole.y() + 0.9 * foramen, c7 ? 0 : span - 7.5_mm), -2.0_mm);
  // A gutter's floor, through which the artery passes, and its two banks.
  const double out = hole.y() + foramen + 1.4_mm;
  style.squareness = 2.4;
  bone.unitePair(
      rod({{{hole.x() + 0.5_mm, width / 2 - 2.0_mm, -0.8_mm}, 4.2_mm, 2.0_mm},
           {{hole.x() + 0.2_mm, hole.y(), -2.0_mm}, foramen + 2.0_mm, 2.1_mm},
           {{hole.x() - 1.6_mm, out, -3.2_mm}, foramen + 0.3_mm, 1.9_mm},
           {0.3 * Vector3d(hole.x() - 1.6_mm, out, -3.2_mm) + 0.7 * rear, 1.8_mm, 1.9_mm}},
          style),
      2.0_mm);
  style.squareness = 2;
  bone.unitePair(rod({{side + pointMm(3, 1, -2.6), 2.6_mm, 1.8_mm},
                      {hole + pointMm(-4.0, 3.0, -2.4), 2.6_mm, 1.8_mm},
                      {0.4 * hole + 0.6 * rear, 2.6_mm, 1.8_mm}},
                     style),
                 2.0_mm);
  bone.unitePair(rod({{{hole.x() + 3.4_mm, width / 2 - 1.0_mm, 0.2_mm}, 1.9_mm, 2.5_mm},
                      {{hole.x() + 4.0_mm, hole.y(), -1.4_mm}, 1.7_mm, 2.3_mm},
                      {front, r + carotid, 1.3 * r + carotid}},
                     style),
                 2.0_mm);
  bone.unitePair(rod({{side + pointMm(2, 1, -2.5), 2.8_mm, 2.8_mm},
                      {0.5 * (side + rear) + pointMm(1.0, 0, -1.5), 2.2_mm, 2.4_mm},
                      {rear, 1.3 * r, 1.4 * r}},
                     style),
                 2.5_mm);
  if (c7) {  // its long process is one plate behind the foramen
    bone.unitePair(ellipsoidSolid(0.35 * (side + rear) + 0.3 * hole, pointMm(3.4, 3.4, 2)), 2.0_mm);
  }
  // Groove of the spinal nerve.
  bone.carvePair(capsule({hole.x() - 3.0_mm, hole.y() + 1.0_mm, 2.8_mm},
                         {hole.x() - 0.5_mm, span + 2.0_mm, 0.6_mm}, 2.0_mm),
                 1.0_mm);
  bone.carvePair(capsule(hole + pointMm(-1.5, 0, 30), hole + pointMm(1.5, 0, -30), foramen),
                 0.8_mm);
}

}  // namespace

void addCervicalArch(Blend& bone, const VertebraPlan& plan) {
  addLaminae(bone, plan);
  addSpinousProcess(bone, plan);
  addPillars(bone, plan);
  carveCanal(bone, plan);
  if (plan.has_superior) {
    addUncinateProcesses(bone, plan);
    addTransverseProcess(bone, plan);
    addFace(bone, plan.superior, 3.0_mm, 0.5_mm);
    clearFace(bone, plan.superior);
    outlineFace(bone, plan.superior);
  }
  addFace(bone, plan.inferior, 3.0_mm, 0.5_mm);
  clearFace(bone, plan.inferior);
}

}  // namespace torso
