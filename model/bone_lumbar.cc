// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "model/bone_vertebra.h"
#include "model/sheet.h"

namespace torso {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kClearance = 1.4_mm;  // of neighbours behind the canal, at least

// Where the laminae meet, in the middle of their thickness. They hang lower than the pedicles.
Vector3d laminaMiddle(const VertebraPlan& plan) {
  return {plan.canal_end - 3.6_mm, 0, -0.5 * plan.half_height};
}

// The top of the sacrum's crest on the mid-line, as sacrumMesh makes it, in the frame of L5.
std::array<Vector3d, 2> sacralCrest(const VertebraPlan& l5) {
  const Isometry3d X = l5.v.frame().inverse() * l5.anatomy.boneFrame("S1");
  return {X * pointMm(-27, 0, -5), X * pointMm(-38, 0, -7.5)};
}

void addLaminae(Blend& bone, const VertebraPlan& plan) {
  const Vector3d end = plan.pedicle_end;
  Vector3d middle = laminaMiddle(plan);
  double tall = 9.6_mm;
  if (plan.levelBelow() == "S1") {  // clear of the sacrum, which a strong lordosis brings near
    const double room = middle.z() + tall - sacralCrest(plan)[0].z() - kClearance;
    if (room < 2 * tall) {
      middle.z() += tall - room / 2;
      tall = room / 2;
    }
  }
  const double y = plan.canal_half;
  TubeStyle style;
  style.squareness = 2.8;
  style.up = Vector3d(0.22, 0, 1);  // the upper edge leans forward, before the arch above
  // From the pars interarticularis, the narrow bridge below the pedicle.
  const Vector3d pars(end.x() - 2.5_mm, y + 2.5_mm, end.z() - 5.0_mm);
  const Vector3d half(0.45 * middle.x() + 0.55 * pars.x(), 0.62 * y + 1.0_mm,
                      0.6 * middle.z() + 0.4 * pars.z());
  bone.unitePair(rod({{end + pointMm(-0.5, 0.5, -1), 5.2_mm, 7.0_mm},
                      {pars, 4.4_mm, 7.5_mm},
                      {half, 3.7_mm, 9.2_mm},
                      {middle, 4.0_mm, tall}},
                     style),
                 3.5_mm);
}

// Keeps the outline of a spinous process on its side of the neighbours': a strong lordosis brings
// them together, where they are flattened, as kissing spines are. In the process' plane.
void keepApart(const VertebraPlan& plan, const Isometry3d& plane, std::vector<Vector2d>& outline) {
  constexpr double kUp = 9.3, kDown = 12.0;  // how far processes reach from their axes
  const Isometry3d into_plane = plane.inverse(), into = plan.v.frame().inverse();
  const auto inPlane = [&](const Vector3d& p) {  // from the frame of the vertebra
    const Vector3d q = into_plane * p;
    return Vector2d(q.x(), q.z());
  };
  struct Line {  // axis of a process
    Vector2d root, tip;
    double at(double x) const {
      return root.y() + (x - root.x()) / (tip.x() - root.x()) * (tip.y() - root.y());
    }
  };
  const auto axis = [&](const VertebraPlan& of) {
    const Isometry3d X = into * of.v.frame();
    return Line{inPlane(X * laminaMiddle(of)), inPlane(X * of.spinous_tip)};
  };
  const Line mine = axis(plan);
  for (const Vertebra& v : plan.anatomy.vertebrae) {
    if (v.region != Region::kLumbar) continue;
    const VertebraPlan other(plan.anatomy, v);
    const bool is_below = plan.levelBelow() == v.name, is_above = other.levelBelow() == plan.v.name;
    if (!is_below && !is_above) continue;
    const double share = (is_below ? kDown : kUp) / (kUp + kDown);
    const Line its = axis(other);
    for (Vector2d& p : outline) {
      const double middle = (1 - share) * mine.at(p.x()) + share * its.at(p.x());
      p.y() = is_below ? std::max(p.y(), middle + kClearance / 2)
                       : std::min(p.y(), middle - kClearance / 2);
    }
  }
  if (plan.levelBelow() == "S1") {
    const auto [front, back] = sacralCrest(plan);
    const Line crest = {inPlane(front), inPlane(back)};
    for (Vector2d& p : outline) p.y() = std::max(p.y(), crest.at(p.x()) + kClearance);
  }
}

// A hatchet: a thin tall plate, narrower where it leaves the laminae; its end is a thick border
// that droops below, with a knob at the lower corner.
void addSpinousProcess(Blend& bone, const VertebraPlan& plan) {
  const Vector3d tip = plan.spinous_tip, root = laminaMiddle(plan);
  const bool l5 = plan.number() == 5;
  const double tall = l5 ? 0.72 : 1;
  // Plane with x forward along the line from the body's centre to the tip.
  Isometry3d X = Isometry3d::Identity();
  Matrix3d R;
  const Vector3d forward = -tip.normalized();
  R << forward, Vector3d::UnitY(), forward.cross(Vector3d::UnitY());
  X.linear() = R;
  const double end = -tip.norm();
  const Vector2d start((R.transpose() * root).x(), (R.transpose() * root).z());
  const auto at = [&](double back_share, double z) {
    return Vector2d(start.x() + back_share * (end - start.x()), z * 1e-3);
  };
  const double z0 = start.y() * 1e3;
  std::vector<Vector2d> outline = smoothOutline({{start.x() + 1.0_mm, start.y() - 7.5_mm},
                                                 {start.x() + 1.0_mm, start.y() + 8.0_mm},
                                                 at(0.18, z0 + 6.2),
                                                 at(0.40, 0.5 * z0 + tall * 6.6),
                                                 at(0.70, tall * 8.0),
                                                 at(0.87, tall * 9.3),
                                                 at(0.95, tall * 9.0),
                                                 at(0.99, tall * 5.5),
                                                 at(1.0, tall * 1.0),
                                                 at(1.0, tall * -5.0),
                                                 at(0.985, tall * -9.5),
                                                 at(0.93, tall * -12.0),
                                                 at(0.84, tall * -11.8),
                                                 at(0.70, tall * -10.0),
                                                 at(0.48, 0.4 * z0 - tall * 8.2),
                                                 at(0.22, z0 - 7.6)},
                                                3);
  keepApart(plan, X, outline);
  const double length = start.x() - end;
  const auto thickness = [=](const Vector2d& p) {
    const double s = std::clamp((start.x() - p.x()) / length, 0.0, 1.1);
    const double low = std::clamp(-p.y() / 11.0_mm, 0.0, 1.0);
    const double border = std::pow(std::clamp((s - 0.6) / 0.4, 0.0, 1.1), 2);
    return 8.0_mm + 4.0_mm * std::pow(1 - std::min(s, 1.0), 2) + (3.4_mm + 2.8_mm * low) * border;
  };
  bone.unite(outlinePlate(X, outline, thickness, 3.5_mm), 5.0_mm);
}

void addArticularProcesses(Blend& bone, const VertebraPlan& plan) {
  const Vector3d end = plan.pedicle_end;
  const VertebraPlan::Face &s = plan.superior, &i = plan.inferior;
  TubeStyle style;
  style.cap = 0.8;
  // Superior: a column from the pedicle's end, whose back carries the mammillary process.
  const Vector3d root(0.5 * (end.x() + s.behind(5.0_mm).x()),
                      std::max(0.5 * (end.y() + s.behind(5.0_mm).y()), plan.canal_half + 4.0_mm),
                      end.z() - 4.0_mm);
  style.up = s.frame.linear().col(2);
  bone.unitePair(rod({{root, 6.0_mm, 5.2_mm},
                      {0.5 * (root + s.at(0, 0, -4.2_mm)), 0.52 * s.width, 4.6_mm},
                      {s.at(-0.5_mm, 0.26 * s.height, -4.2_mm), 0.42 * s.width, 3.6_mm}},
                     style),
                 4.0_mm);
  // Inferior: a tongue that hangs from the lamina.
  const Vector3d middle = laminaMiddle(plan);
  const Vector3d from(middle.x() + 1.5_mm,
                      std::max(0.55 * i.behind(4.0_mm).y(), 0.7 * plan.canal_half),
                      middle.z() + 4.0_mm);
  style.up = i.frame.linear().col(2);
  bone.unitePair(rod({{from, 5.5_mm, 3.6_mm},
                      {0.45 * from + 0.55 * i.at(0, 0, -3.5_mm), 0.46 * i.width, 3.6_mm},
                      {i.at(0, -0.30 * i.height, -2.9_mm), 0.36 * i.width, 2.6_mm}},
                     style),
                 3.5_mm);
  addFace(bone, s, 5.5_mm, 2.5_mm);
  addFace(bone, i, 5.0_mm, 2.5_mm);
  // Mammillary process: on the rear outer edge of the superior one.
  const Vector3d knob = s.at(-0.46 * s.width, 0.02 * s.height, -4.2_mm);
  bone.unitePair(ellipsoidSolid(knob, pointMm(3.9, 3.7, 5.8)), 2.5_mm);
}

// Costal process: a long slender blade; on L5 a short massive cone from the whole pedicle.
void addTransverseProcess(Blend& bone, const VertebraPlan& plan) {
  const Vector3d end = plan.pedicle_end;
  const double span = plan.v.transverse_process_span / 2;
  const bool l5 = plan.number() == 5;
  TubeStyle style;
  style.squareness = 2.2;
  style.cap = 1;
  const double tip_up = l5 ? 5.0_mm : 3.4_mm, tip_side = l5 ? 3.6_mm : 1.9_mm;
  const double rise = plan.number() >= 4 ? 4.5_mm : plan.number() == 1 ? -1.0_mm : 1.0_mm;
  const Vector3d root(end.x() + (l5 ? 4.0_mm : 1.5_mm), end.y() - 1.0_mm, end.z() - 2.0_mm);
  const Vector3d tip(end.x() - (l5 ? 4.5_mm : 5.5_mm), span - tip_side, root.z() + rise);
  const auto between = [&](double t, double x, double z) -> Vector3d {
    return root + t * (tip - root) + pointMm(x, 0, z);
  };
  if (l5) {
    bone.unitePair(rod({{root, 7.5_mm, 7.8_mm},
                        {between(0.3, 0, -1), 6.2_mm, 7.2_mm},
                        {between(0.65, 0, -0.5), 4.6_mm, 6.4_mm},
                        {tip, tip_side, tip_up}},
                       style),
                   5.0_mm);
  } else {
    bone.unitePair(rod({{root, 4.6_mm, 6.5_mm},
                        {between(0.25, -1.6, -0.5), 3.8_mm, 5.2_mm},
                        {between(0.55, -1.6, -0.4), 3.3_mm, 5.3_mm},
                        {between(0.85, -0.6, 0), 2.9_mm, 5.2_mm},
                        {tip, tip_side, tip_up}},
                       style),
                   4.0_mm);
  }
  // Accessory process, behind the root.
  bone.unitePair(ellipsoidSolid(root + pointMm(-6, 3, -2.5), pointMm(2.4, 2.0, 3.0)), 2.5_mm);
}

}  // namespace

void addLumbarArch(Blend& bone, const VertebraPlan& plan) {
  addLaminae(bone, plan);
  addSpinousProcess(bone, plan);
  carveCanal(bone, plan);
  addTransverseProcess(bone, plan);
  addArticularProcesses(bone, plan);
  clearFace(bone, plan.superior);
  outlineFace(bone, plan.superior);
  clearFace(bone, plan.inferior);
}

}  // namespace torso
