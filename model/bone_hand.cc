// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/bone_limb.h"
#include "model/bone_parts.h"

namespace torso {
namespace {

using Eigen::Affine3d;
using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Here: x from the wrist along the hand, y to the thumb's side, z to the palm [mm], for a hand of
// kHandLength.
constexpr double kHandLength = 185;

// Columns: along the bone (x and y given), across it, to the palm.
Matrix3d axesAlong(double x, double y) {
  Matrix3d axes;
  axes.col(0) = Vector3d(x, y, 0).normalized();
  axes.col(2) = Vector3d::UnitZ();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

// The eight carpal bones, overlapping; keptApart makes their joints.
std::vector<Solid> carpals() {
  const Matrix3d straight = Matrix3d::Identity();
  std::vector<Solid> bones;
  // Scaphoid: its pole reaches under the radius, its tubercle to the palm.
  bones.push_back(
      Blend()
          .unite(ellipsoidSolid({1.8, 12, -1.5}, {9, 10.5, 8.5}, axesAlong(1, 0.5), 2.3))
          .unite(ellipsoidSolid({9.5, 18.5, 4}, {7.5, 5.5, 6}, axesAlong(1, 0.5)), 5)
          .solid());
  // Lunate: a crescent, deeper than broad.
  bones.push_back(ellipsoidSolid({0.2, -1.5, 0}, {7.4, 9.5, 8.6}, straight, 2.5));
  // Triquetrum: a pyramid; pisiform: a pea on its palm.
  bones.push_back(
      Blend()
          .unite(ellipsoidSolid({4, -15.5, -0.5}, {9, 8.5, 7.5}, axesAlong(1, -0.5), 2.5))
          .solid());
  bones.push_back(ellipsoidSolid({4, -18.5, 9.5}, {6.5, 5.5, 5}));
  // Trapezium, with its ridge; its saddle looks to the thumb.
  bones.push_back(Blend()
                      .unite(ellipsoidSolid({16.5, 22, 3.5}, {8.5, 8.5, 7.5}, axesAlong(1, 0.6), 3))
                      .unite(ellipsoidSolid({15, 17, 10}, {5.5, 2.8, 3.8}, axesAlong(1, 0.4)), 3)
                      .solid());
  // Trapezoid: a wedge, broad at the back of the hand.
  bones.push_back(Blend()
                      .unite(ellipsoidSolid({18, 12, -3}, {8, 8, 6.5}, straight, 2.6))
                      .unite(ellipsoidSolid({18, 11.5, 2.5}, {6.5, 5.5, 5.5}, straight, 2.4), 4)
                      .solid());
  // Capitate: a head between scaphoid and lunate, a waist, a broad body.
  bones.push_back(Blend()
                      .unite(ellipsoidSolid({10, 2, -0.5}, {7.5, 7.5, 7.5}))
                      .unite(ellipsoidSolid({18.5, 2, -0.5}, {9, 9.5, 9}, straight, 2.8), 4)
                      .solid());
  // Hamate: a wedge with its hook to the palm.
  bones.push_back(Blend()
                      .unite(ellipsoidSolid({18, -13, -1}, {9, 10, 8}, axesAlong(1, -0.15), 2.6))
                      .unite(ellipsoidSolid({11, -7.5, -1}, {8, 6.5, 7.5}), 4)
                      .unite(stoutRod({section(18.5, -12, 5, 5, 3), section(19, -12.5, 11, 4, 2.4),
                                       section(19, -11, 14, 3.6, 2.2)},
                                      Vector3d::UnitY()),
                             3)
                      .solid());
  return bones;
}

// Thumb to little finger, slightly flexed. The thumb's nail looks forward, the others' to the back
// of the hand.
const std::vector<Ray>& rays() {
  const Vector3d thumb(-0.3, 0.55, -0.8), others(0, 0, -1);  // dorsal
  static const std::vector<Ray> kRays = {
      {{7.2, 6.8},
       {4.6, 4},
       {7.6, 6.2},
       {{21, 28.5, 6}, {61, 42, 14}, {91, 51, 16}, {115, 57, 16}},
       thumb},
      {{8, 7.4},
       {4.2, 4.2},
       {7.2, 7.4},
       {{21, 14.5, -1}, {91, 21, 0}, {132, 25, 5}, {155, 26, 9}, {172, 26, 12}},
       others},
      {{6.8, 8},
       {4.2, 4.3},
       {7.2, 7.6},
       {{23.5, 3, -1}, {92, 3.5, -1}, {137, 4, 4}, {164, 3, 4}, {kHandLength, 0, 0}},
       others},
      {{5.8, 6.6},
       {3.5, 3.7},
       {6.3, 6.8},
       {{23, -8.5, 0}, {86.5, -12, 0}, {128, -15, 6}, {153.5, -16, 10}, {172, -16, 13}},
       others},
      {{6, 5.8},
       {3.4, 3.4},
       {6, 6.2},
       {{22, -18, 1}, {77.5, -25.5, 2}, {110, -31, 8}, {128.5, -33, 12}, {145, -34, 15}},
       others}};
  return kRays;
}

}  // namespace

TriMesh handMesh(const Anatomy& anatomy) {
  const Vector3d wrist = anatomy.landmark("wrist"), tip = anatomy.landmark("hand_tip");
  const double scale = (tip - wrist).norm() / kHandLength;
  // The palm is medial, the thumb in front.
  Affine3d X;
  const Vector3d along = (tip - wrist).normalized();
  const Vector3d thumb = (Vector3d::UnitX() - along.x() * along).normalized();
  X.linear() << along, thumb, along.cross(thumb);
  X.linear() *= scale;
  X.translation() = wrist;

  std::vector<Solid> bones = carpals();
  std::vector<int> faces(bones.size(), 245);
  const RayStyle style = {{1.02, 0.88}, {0.6, 0.5},  {0.8, 0.72},
                          {1.08, 1.12}, {0.55, 0.5}, {0.74, 0.42}};
  for (const Ray& ray : rays()) {
    const std::vector<Solid> finger = rayBones(ray, style);
    for (std::size_t k = 0; k < finger.size(); k++) {
      bones.push_back(finger[k]);
      faces.push_back(k == 0 ? 230 : k + 1 == finger.size() ? 100 : 140);
    }
  }
  // Sesamoid bones under the head of the thumb's metacarpal.
  for (double y : {36.0, 44.0}) {
    bones.push_back(ellipsoidSolid({57, y, 21}, {2.6, 2.2, 2}));
    faces.push_back(40);
  }
  bones = keptApart(bones, 1.7);
  TriMesh mesh;
  for (std::size_t i = 0; i < bones.size(); i++) {
    append(mesh, boneSurface(bones[i], 0.95, faces[i], X));
  }
  return mesh;
}

}  // namespace torso
