// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/bone_limb.h"
#include "model/bone_parts.h"

namespace torso {
namespace {

using Eigen::Affine3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Here: x forward from the heel, y to the side of the little toe, z up from the sole [mm], for a
// foot of kFootLength: kLeft is to that side. The ankle is at (58, -4, 73).
constexpr double kFootLength = 248.6;

Solid calcaneus() {
  Blend bone;
  bone.unite(stoutRod(
      {section(11, 1, 23, 12, 19), section(22, 0.5, 26, 12, 19), section(38, 1, 31.5, 12, 17),
       section(54, 4, 33, 13, 15.5), section(68, 8, 31, 13, 13.5), section(79, 11, 29.5, 12.5, 13)},
      kUp, 2.4, 0.35));
  bone.unite(ellipsoidSolid({8, 1, 24}, {8, 12.5, 19}, turned(-8, kLeft), 2.2), 6);  // tuber
  bone.unite(ellipsoidSolid({14, -5.5, 6.5}, {11, 7.5, 6.5}), 6);  // its medial process
  bone.unite(ellipsoidSolid({14, 9, 7.5}, {7, 5, 6}), 5);          // and its lateral process
  bone.unite(ellipsoidSolid({47, 2, 46}, {16, 13, 11}, turned(35, kLeft)), 6);  // posterior facet
  bone.unite(stoutRod({section(54, -5, 42, 10, 6), section(56, -17, 45.5, 9, 4)}, kUp, 2.3), 6);
  bone.unite(ellipsoidSolid({52, 15, 24}, {6, 3, 3}, turned(-25, kLeft)), 4);  // peroneal trochlea
  bone.carve(
      stoutRod({section(30, -17, 20, 8, 6), section(50, -16, 27, 9, 8), section(72, -9, 24, 8, 8)},
               kUp),
      6);                                                    // hollow under the sustentaculum
  bone.carve(ellipsoidSolid({66, 12, 46}, {10, 10, 5}), 5);  // sinus tarsi
  return bone.solid();
}

Solid talus() {
  Blend bone;
  // Body: a pulley about the axis of the ankle, broader in front.
  bone.unite(cylinder({57, -4, 62}, kLeft, 20, 15, 2.5));
  bone.carve(halfSpace({57, -4, 47}, Vector3d(0.25, 0, 1).normalized()), 5);
  bone.carve(stoutRod({section(33, -4, 72, 7, 3.5), section(44, -4, 82, 7, 3.5),
                       section(57, -4, 86, 7, 3.5), section(70, -4, 82, 7, 3.5),
                       section(81, -4, 72, 7, 3.5)},
                      kUp),
             4);  // groove of the pulley
  bone.unite(ellipsoidSolid({55, 9, 55}, {10, 6.5, 7}, turned(20, kLeft)), 5);  // lateral process
  bone.unite(stoutRod({section(44, -4, 56, 10, 7), section(36, -5, 53, 7, 5),
                       section(32, -4, 51.5, 4, 3.5)},
                      kUp),
             5);  // posterior process
  // Neck and head, to the medial side.
  bone.unite(stoutRod({section(64, -5, 60, 13, 11), section(75, -7.5, 57, 10.5, 9.5),
                       section(84, -10, 54, 11.5, 10)},
                      kUp),
             5);
  bone.unite(ellipsoidSolid({85, -10.5, 52.5}, {11, 14.5, 12}, turned(-12, kUp)), 4);
  return bone.solid();
}

std::vector<Solid> tarsals() {
  std::vector<Solid> bones = {calcaneus(), talus()};
  // Navicular: a boat about the head of the talus, its tuberosity on the medial side.
  bones.push_back(Blend()
                      .unite(ellipsoidSolid({97, -10, 49.5}, {9.5, 18.5, 13.5},
                                            turned(-10, kUp) * turned(8, kForward), 2.6))
                      .unite(ellipsoidSolid({94, -28, 42}, {7, 6, 7.5}), 6)
                      .solid());
  // Cuboid: longer on the medial side, a groove for the tendon of peroneus longus below.
  bones.push_back(
      Blend()
          .unite(ellipsoidSolid({98, 15.5, 31}, {19, 13, 12.5}, turned(8, kUp), 3.2))
          .unite(ellipsoidSolid({96, 16, 20}, {7, 11, 4.5}, turned(-25, kUp)), 5)
          .carve(stoutRod({section(109, 4, 16, 3.5, 3.5), section(105, 18, 17, 3.5, 3.5),
                           section(101, 30, 24, 3.5, 3.5)},
                          kUp),
                 3)
          .solid());
  // Cuneiforms: wedges; the medial one's edge points up, the others' down.
  bones.push_back(
      Blend()
          .unite(ellipsoidSolid({114, -23, 37}, {13.5, 9, 9}, turned(4, kUp), 2.8))
          .unite(ellipsoidSolid({113.5, -19.5, 45}, {12.8, 7, 10}, turned(4, kUp), 2.5), 9)
          .solid());
  bones.push_back(Blend()
                      .unite(ellipsoidSolid({111, -9, 50}, {10, 8.5, 7}, turned(4, kUp), 2.8))
                      .unite(ellipsoidSolid({111, -8, 42}, {9, 5.5, 10}, turned(4, kUp), 2.4), 4)
                      .solid());
  bones.push_back(Blend()
                      .unite(ellipsoidSolid({112, 4.5, 46}, {13, 8.5, 7}, turned(4, kUp), 2.8))
                      .unite(ellipsoidSolid({112, 3, 38}, {11, 6, 10}, turned(4, kUp), 2.4), 4)
                      .solid());
  return bones;
}

// Great toe to little toe.
const std::vector<Ray>& rays() {
  static const std::vector<Ray> kRays = {
      {{9.5, 14},
       {6.4, 7},
       {10.5, 10.5},
       {{125.5, -22.5, 37}, {187, -29, 15}, {219, -24.5, 12}, {244, -20, 9}},
       kUp},
      {{7, 10},
       {3.9, 4.2},
       {5.8, 7.8},
       {{119, -8.5, 46.5}, {197, -9, 15}, {224, -6.5, 17}, {236.5, -5.5, 11}, {247, -4.5, 6}},
       kUp},
      {{6.8, 9.5},
       {3.7, 4.1},
       {5.5, 7.4},
       {{122.5, 4.5, 42}, {193.5, 6, 14}, {217.5, 8.5, 16}, {228, 9.5, 10.5}, {238, 10, 5.5}},
       kUp},
      {{6.8, 9},
       {3.7, 4.1},
       {5.4, 7.2},
       {{117, 16, 35.5}, {185, 20, 13}, {207, 22.5, 14.5}, {216, 23.5, 9.5}, {225, 24, 5}},
       kUp},
      {{8.5, 7.5},
       {4.2, 4},
       {5.6, 6.6},
       {{110, 26, 27}, {172.5, 34, 11.5}, {192.5, 36.5, 12.5}, {200, 37.5, 8.5}, {208, 38, 4.8}},
       kUp}};
  return kRays;
}

}  // namespace

TriMesh footMesh(const Anatomy& anatomy) {
  const Vector3d heel = anatomy.landmark("heel"), toe = anatomy.landmark("toe_tip");
  Vector3d forward = toe - heel;
  forward.z() = 0;
  const double scale = forward.norm() / kFootLength;
  forward.normalize();
  Affine3d X;
  X.linear() << forward, Vector3d::UnitZ().cross(forward), Vector3d::UnitZ();
  X.linear() *= scale;
  X.translation() = Vector3d(heel.x(), heel.y(), anatomy.landmark("sole").z());

  std::vector<Solid> bones = tarsals();
  std::vector<int> faces = {600, 540, 230, 270, 180, 150, 170};
  const RayStyle style = {{1, 0.85}, {0.6, 0.55}, {0.82, 0.74}, {1, 1}, {0.62, 0.6}, {0.8, 0.5}};
  for (const Ray& ray : rays()) {
    const bool great = &ray == &rays().front(), little = &ray == &rays().back();
    std::vector<Solid> toe = rayBones(ray, style);
    if (little) {  // tuberosity of the fifth metatarsal
      toe[0] = Blend(toe[0])
                   .unite(ellipsoidSolid({107, 33, 23}, {9, 4.5, 5}, turned(8, kUp)), 5)
                   .solid();
    }
    for (std::size_t k = 0; k < toe.size(); k++) {
      bones.push_back(toe[k]);
      const bool terminal = k + 1 == toe.size();
      faces.push_back(k == 0     ? (great ? 290 : 230)
                      : terminal ? (great ? 140 : 76)
                      : great    ? 170
                                 : 104);
    }
  }
  // Sesamoid bones under the head of the first metatarsal.
  for (double y : {-35.0, -23.0}) {
    bones.push_back(ellipsoidSolid({176, y, 5}, {6, 4.2, 4}));
    faces.push_back(60);
  }
  bones = keptApart(bones, 1.2);
  TriMesh mesh;
  for (std::size_t i = 0; i < bones.size(); i++) {
    append(mesh, boneSurface(bones[i], 1.15, faces[i], X));
  }
  return mesh;
}

}  // namespace torso
