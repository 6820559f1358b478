// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/bone_vertebra.h"
#include "model/surface.h"

namespace torso {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kFaces = 2400;

// Left superior face of C2, on which C1 turns; in C2's frame. Size and place assumed.
VertebraPlan::Face axisFace() {
  const Vector3d normal = Vector3d(-0.03, 0.40, 0.92).normalized();
  VertebraPlan::Face face{Isometry3d::Identity(), 15.0_mm, 16.5_mm};
  const Vector3d up = (Vector3d::UnitX() - normal.x() * normal).normalized();
  face.frame.translate(pointMm(0.5, 15.8, 9.2));
  face.frame.linear() << up.cross(normal), up, normal;
  return face;
}

// C1: a ring between the condyles of the skull and C2. From C2's body centre, in standing axes.
Blend atlas(const Anatomy& anatomy) {
  Blend bone;
  TubeStyle style;
  style.cap = 0.8;
  // Lateral masses, hollowed above by the skull's condyles, cut off flat below by C2.
  bone.unitePair(
      ellipsoidSolid(pointMm(1, 18, 17), pointMm(9.5, 7.8, 8.2), Matrix3d::Identity(), 3), 0);
  // Anterior arch with its tubercle.
  style.squareness = 2.4;
  bone.unitePair(rod({sectionMm(5, 17.5, 18, 3.6, 5.0), sectionMm(11.5, 10, 18.3, 2.6, 4.4),
                      sectionMm(14.3, 0, 18.6, 2.6, 5.0)},
                     style),
                 2.5_mm);
  bone.unite(ellipsoidSolid(pointMm(16.8, 0, 17.6), pointMm(2.2, 3.2, 3.4)), 2.5_mm);
  // Posterior arch: low behind the lateral mass, where the vertebral artery crosses it.
  bone.unitePair(rod({sectionMm(-4, 20, 17.5, 3.5, 3.6), sectionMm(-13, 20.5, 16.6, 2.6, 2.3),
                      sectionMm(-23, 16, 16.8, 2.6, 3.6), sectionMm(-29.5, 8, 17, 2.6, 4.2),
                      sectionMm(-32, 0, 17, 2.7, 4.4)},
                     style),
                 2.5_mm);
  bone.unite(ellipsoidSolid(pointMm(-34, 0, 17), pointMm(2.4, 3.0, 3.2)), 2.5_mm);
  // Transverse processes, the longest of the neck, around the foramen of the artery.
  style.squareness = 2.2;
  bone.unitePair(rod({sectionMm(1.5, 22, 17.5, 7.0, 4.6), sectionMm(-0.5, 28, 17, 5.6, 3.0),
                      sectionMm(-2.5, 33, 16.2, 3.8, 2.9), sectionMm(-3.5, 36.5, 15.6, 3.2, 3.4)},
                     style),
                 2.0_mm);
  bone.carvePair(capsule(pointMm(-0.6, 28.2, 40), pointMm(-1.0, 27.8, -5), 3.0_mm), 1.0_mm);

  const Matrix3d tilt = Eigen::AngleAxisd(-0.15, Vector3d::UnitX()).toRotationMatrix();
  bone.carvePair(ellipsoidSolid(pointMm(1, 17, 29), pointMm(12.2, 7.4, 7.0), tilt), 0.8_mm);
  constexpr double kGap = 2.0_mm, kReach = 12.0_mm;
  Isometry3d below = Isometry3d::Identity();
  below.linear() = anatomy.c2.frame().linear();
  below = below * axisFace().frame;
  below.translate(Vector3d(0, 0, kGap));
  bone.carvePair(facePlate(below, 30.0_mm, 30.0_mm, kReach, 0), 0.8_mm);
  // Room for the dens and the cord.
  bone.carve(capsule(pointMm(3, 0, -10), pointMm(4.5, 0, 60), 7.2_mm), 1.5_mm);
  return bone;
}

// The parts of C2 that no other vertebra has.
void addAxisParts(Blend& bone, const VertebraPlan& plan) {
  TubeStyle style;
  style.up = Vector3d::UnitX();
  style.squareness = 2.1;
  style.cap = 0.9;
  // Dens: a neck, where C1's ligament runs behind it, and a head with a blunt tip.
  bone.unite(rod({sectionMm(1, 0, 5, 6.4, 6.2), sectionMm(1.2, 0, 12, 4.8, 5.0),
                  sectionMm(1.6, 0, 19, 5.2, 5.4), sectionMm(0.8, 0, 25, 3.6, 3.8)},
                 style),
             3.5_mm);
  // Lateral masses below C1.
  const VertebraPlan::Face face = axisFace();
  style.squareness = 2.5;
  bone.unitePair(rod({sectionMm(0, 10, 1, 5.5, 6.5), {face.behind(4.0_mm), 5.8_mm, 6.8_mm}}, style),
                 3.0_mm);
  // Transverse process: one small tubercle, below the way of the artery, which turns outwards.
  style = TubeStyle();
  const double span = plan.v.transverse_process_span / 2;
  const Vector3d tip(-5.0_mm, span - 2.4_mm, -4.5_mm);
  bone.unitePair(rod({sectionMm(-10, 18, -3.5, 3.4, 4.2), {tip, 2.5_mm, 2.6_mm}}, style), 2.5_mm);
  bone.unitePair(rod({sectionMm(1.5, 9.5, -3.5, 2.5, 4.0),
                      sectionMm(1.5, 17, -4.2, 2.2, 3.0),
                      {tip, 2.5_mm, 2.5_mm}},
                     style),
                 2.0_mm);
  bone.carvePair(capsule(pointMm(-3.2, 16.5, -16), pointMm(-3.0, 18.5, -2.5), 2.6_mm), 1.0_mm);
  bone.carvePair(capsule(pointMm(-3.0, 18.5, -2.5), pointMm(-3.0, 34, 3), 2.6_mm), 1.0_mm);
  addFace(bone, face, 3.0_mm, 1.5_mm);
  clearFace(bone, face);
}

}  // namespace

TriMesh atlasMesh(const Anatomy& anatomy) {
  Isometry3d X = Isometry3d::Identity();
  X.translate(anatomy.c2.position);
  return transformed(surface(atlas(anatomy), 0.9_mm, kFaces, true), X);
}

TriMesh axisMesh(const Anatomy& anatomy) {
  const VertebraPlan plan(anatomy, anatomy.c2);
  Blend bone;
  bone.unite(vertebralBody(plan), 0);
  addPedicles(bone, plan);
  addCervicalArch(bone, plan);
  addAxisParts(bone, plan);
  return transformed(vertebraSurface(bone, plan, 0.8_mm), anatomy.c2.frame());
}

}  // namespace torso
