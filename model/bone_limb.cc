// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/bone_limb.h"

#include "model/surface.h"

namespace torso {

using Eigen::Affine3d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

Affine3d limbPlace(const Vector3d& proximal, const Vector3d& distal, double reference_length) {
  const double length = (distal - proximal).norm();
  const Vector3d z = (proximal - distal) / length;
  const Vector3d y = (Vector3d::UnitY() - z.y() * z).normalized();
  Affine3d X;
  X.linear() << y.cross(z), y, z;
  X.linear() *= length / reference_length;
  X.translation() = proximal;
  return X;
}

TriMesh boneSurface(const Blend& bone, double voxel, int max_faces, const Affine3d& X) {
  return transformed(surface(bone, voxel, max_faces, false, Finish::kRounded), X);
}

namespace {

// Metapodial bone, phalanx, and phalanx at the end of its ray.
enum class RayBone { kMetapodial, kPhalanx, kTerminal };

// From the middle of its base to the tip of its head.
Solid rayBone(RayBone kind, const Vector3d& base, const Vector3d& head, const Vector3d& dorsal,
              const Vector2d& base_half, const Vector2d& waist_half, const Vector2d& head_half) {
  // Modelled along z, dorsal towards x.
  const double length = (head - base).norm();
  Affine3d X = Affine3d::Identity();
  const Vector3d z = (head - base) / length, y = z.cross(dorsal).normalized();
  X.linear() << y.cross(z), y, z;
  X.translation() = base;

  const double bw = base_half.x(), bd = base_half.y(), ww = waist_half.x(), wd = waist_half.y(),
               hw = head_half.x(), hd = head_half.y(), fillet = 0.7 * wd;
  Blend bone;
  // Shaft: bowed to the back of the hand, its back flatter than its belly.
  bone.unite(stoutRod({section(0, 0, 0.35 * bd, 0.94 * bw, 0.94 * bd),
                       section(0.02 * length, 0, 0.16 * length, 0.5 * (bw + ww), 0.5 * (bd + wd)),
                       section(0.05 * length, 0, 0.38 * length, ww, wd),
                       section(0.05 * length, 0, 0.6 * length, 1.02 * ww, 0.95 * wd),
                       section(0.02 * length, 0, 0.8 * length, 0.45 * (hw + ww), 0.5 * (hd + wd)),
                       section(0, 0, length - hd, 0.85 * hw, 0.8 * hd)},
                      Vector3d::UnitX(), 2.3, 0.3));
  bone.unite(ellipsoidSolid(Vector3d(-0.05 * bd, 0, 0.55 * bd), Vector3d(bd, bw, 0.6 * bd),
                            Matrix3d::Identity(), 2.8),
             fillet);
  switch (kind) {
    case RayBone::kMetapodial:
      bone.unite(ellipsoidSolid(Vector3d(-0.08 * hd, 0, length - hd), Vector3d(1.08 * hd, hw, hd),
                                Matrix3d::Identity(), 2.2),
                 fillet);
      break;
    case RayBone::kPhalanx:  // two condyles with a groove between
      for (double side : {-1.0, 1.0}) {
        bone.unite(cylinder(Vector3d(-0.12 * hd, 0.52 * side * hw, length - hd), Vector3d::UnitY(),
                            hd, 0.48 * hw, 0.4 * hw),
                   0.5 * fillet);
      }
      break;
    case RayBone::kTerminal:  // a flat tuft
      bone.unite(ellipsoidSolid(Vector3d(0, 0, length - 0.8 * hw), Vector3d(hd, hw, 0.8 * hw),
                                Matrix3d::Identity(), 2.4),
                 fillet);
      break;
  }
  return moved(bone.solid(), X);
}

}  // namespace

std::vector<Solid> rayBones(const Ray& ray, const RayStyle& style) {
  std::vector<Solid> bones;
  Vector2d half = ray.head;
  const int last = static_cast<int>(ray.ends.size()) - 2;
  for (int k = 0; k <= last; k++) {
    const Vector3d &a = ray.ends[k], &b = ray.ends[k + 1];
    const Vector3d joint = (b - a).normalized() * 0.6;  // cartilage
    if (k == 0) {
      bones.push_back(
          rayBone(RayBone::kMetapodial, a, b - joint, ray.dorsal, ray.base, ray.waist, ray.head));
      continue;
    }
    const Vector2d base = half.cwiseProduct(k == 1 ? style.first_base : Vector2d(1, 0.95));
    if (k == last) {
      bones.push_back(rayBone(RayBone::kTerminal, a + joint, b, ray.dorsal, base,
                              base.cwiseProduct(style.last_waist),
                              base.cwiseProduct(style.last_head)));
      continue;
    }
    const Vector2d head = base.cwiseProduct(style.head);
    bones.push_back(rayBone(RayBone::kPhalanx, a + joint, b - joint, ray.dorsal, base,
                            base.cwiseProduct(style.waist), head));
    half = head.cwiseProduct(style.joint);
  }
  return bones;
}

}  // namespace torso
