// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// What the bones of the limbs have in common. They are modelled in millimetres in the frame of
// their segment at a reference length, and scaled to the landmarks.

#include <Eigen/Geometry>
#include <vector>

#include "model/anatomy.h"
#include "model/blend.h"

namespace torso {

// Lengths between joint centres that the numbers of the bones are for [mm].
constexpr double kThighLength = 412, kShankLength = 373, kUpperArmLength = 275,
                 kForearmLength = 263;

// From millimetres in the frame of a limb segment (origin at the proximal joint, z from the distal
// joint to it, x forward, y left) to the standing body [m].
Eigen::Affine3d limbPlace(const Eigen::Vector3d& proximal, const Eigen::Vector3d& distal,
                          double reference_length);

// Surface of a bone, placed by x -> X x.
TriMesh boneSurface(const Blend& bone, double voxel, int max_faces, const Eigen::Affine3d& X);

inline const Eigen::Vector3d kForward = Eigen::Vector3d::UnitX(), kLeft = Eigen::Vector3d::UnitY(),
                             kUp = Eigen::Vector3d::UnitZ();

inline Eigen::Matrix3d turned(double degrees, const Eigen::Vector3d& axis) {
  return Eigen::AngleAxisd(degrees * EIGEN_PI / 180, axis.normalized()).toRotationMatrix();
}

inline Section section(double x, double y, double z, double side, double up) {
  return {Eigen::Vector3d(x, y, z), side, up, Eigen::Vector3d::Zero()};
}

// Left bones that others are fitted to, in the frame of their segment [mm].
Solid humerusSolid();
Solid femurSolid();

// A finger or a toe with its metapodial (metacarpal or metatarsal) bone.
struct Ray {
  Eigen::Vector2d base, waist, head;  // of the metapodial: half width (across) and half depth
  std::vector<Eigen::Vector3d> ends;  // its base, its head, then the ends of the phalanges
  Eigen::Vector3d dorsal;             // need not be normal to the bones
};

// Proportions of phalanges, in width and depth.
struct RayStyle {
  Eigen::Vector2d first_base;             // of the first one, over the metapodial's head
  Eigen::Vector2d waist, head;            // over the base
  Eigen::Vector2d joint;                  // over the head: what the next base is made to fit
  Eigen::Vector2d last_waist, last_head;  // over the base, at the end of the ray
};

// The bones from the metapodial to the last phalanx, each with room for cartilage at its joints.
std::vector<Solid> rayBones(const Ray& ray, const RayStyle& style);

}  // namespace torso
