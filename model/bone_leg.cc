// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/bone_limb.h"
#include "model/bone_parts.h"

namespace torso {
namespace {

using Eigen::Affine3d;
using Eigen::Vector3d;

// Tibia: plateau, shaft with a sharp front edge, medial malleolus.
Solid tibia() {
  constexpr double A = -kShankLength;
  Blend bone;
  bone.unite(stoutRod(
      {section(-4, 0, -29, 37, 23.5), section(-5, 0, -36, 37, 23.5), section(-4, 1, -46, 33, 22),
       section(-2, 0, -64, 25.5, 19.5), section(-1, -2, -88, 18, 17), section(-2, -6, -130, 13, 14),
       section(-2, -8, -180, 11.5, 12.5), section(-2, -8, -230, 11, 11.5),
       section(-1, -6, -275, 11.5, 11.5), section(0, -5, -315, 14, 13.5),
       section(0, -4, -342, 19, 16.5), section(0, -3, A + 15, 22, 18),
       section(0, -3, A + 10, 22, 18)},
      kForward, 2.4, 0.12));
  // The two condyles of the plateau, the medial one longer.
  bone.unite(ellipsoidSolid({-6, -19, -33}, {25, 20, 8}, turned(6, kLeft), 2.8), 5);
  bone.unite(ellipsoidSolid({-4, 19, -33}, {22.5, 20, 8}, turned(6, kLeft), 2.8), 5);
  // Front edge, from the tuberosity down; it winds to the medial side.
  bone.unite(stoutRod({section(16, 2, -66, 5, 7), section(14, -2, -100, 3.2, 6),
                       section(12, -6, -150, 2.6, 6), section(10.5, -8, -200, 2.6, 5.5),
                       section(8, -9, -250, 3, 5), section(6, -9, -290, 4, 5)},
                      kForward),
             9);
  // Edge for the interosseous membrane.
  bone.unite(stoutRod({section(-2, 12, -95, 4, 3), section(-3, 5.5, -160, 3, 2.2),
                       section(-3, 3.5, -240, 3, 2.2), section(-2, 8, -310, 4, 4)},
                      kForward),
             8);
  // Tuberosity for the patellar ligament.
  bone.unite(stoutRod({section(15, 2, -44, 9, 6), section(17.5, 2, -56, 8, 6.5),
                       section(16.5, 1.5, -70, 5.5, 5)},
                      kForward),
             8);
  // Gerdy's tubercle; facet for the fibula behind.
  bone.unite(ellipsoidSolid({11, 24, -40}, {8, 7, 7}), 8);
  // Medial malleolus.
  bone.unite(stoutRod({section(1, -17, A + 32, 9, 14), section(2, -22.5, A + 14, 7, 14),
                       section(3, -24.5, A + 4, 5.2, 11.5), section(4, -25, A - 1.5, 4, 7)},
                      kForward, 2.2),
             8);
  // Joint surfaces: shallow bowls above, the mortise for the talus below, and the notches.
  bone.carve(ellipsoidSolid({-6, -20, -10}, {30, 24, 15.2}, turned(6, kLeft)), 2);
  bone.carve(ellipsoidSolid({-5, 20, -9}, {34, 27, 15.6}, turned(6, kLeft)), 2);
  bone.carve(ellipsoidSolid({-31, 0, -36}, {10, 8, 16}), 6);  // intercondylar area, behind
  bone.unite(stoutRod({section(-4, -5, -31, 4, 6), section(-5, -4.5, -22, 2.6, 5),
                       section(-5, -4.5, -17.5, 1.4, 3)},
                      kForward),
             5);
  bone.unite(stoutRod({section(-5, 5.5, -31, 4, 6), section(-6, 5.5, -23, 2.4, 4.5),
                       section(-6, 5.5, -19, 1.2, 2.5)},
                      kForward),
             5);
  bone.carve(cylinder({-1, 0, A - 11}, kLeft, 22, 16.8, 2.5), 2);
  bone.carve(stoutRod({section(-6, 25, A + 30, 9, 6), section(-6, 26, A, 12, 8)}, kLeft), 4);
  return bone.solid();
}

Solid fibula() {
  constexpr double A = -kShankLength;
  Blend bone;
  bone.unite(stoutRod({section(-16, 36, -43, 10, 10.5), section(-16, 36, -52, 9.5, 10),
                       section(-15, 35.5, -66, 6, 6.5), section(-14, 34.5, -100, 5.6, 6.2),
                       section(-14, 33, -170, 5.8, 6.8), section(-13, 31.5, -240, 5.6, 6.6),
                       section(-10, 28, -300, 5.6, 6.6), section(-7, 25, A + 42, 6, 8),
                       section(-6, 23, A + 18, 8, 11.5), section(-6, 22.8, A + 4, 7.5, 11.5),
                       section(-8, 22.5, A - 9, 5.5, 8)},
                      kForward, 2.2, 0.8));
  bone.unite(ellipsoidSolid({-20, 38, -38}, {5, 5, 6.5}), 5);  // apex of the head
  // Front and inner edges of the shaft.
  bone.unite(stoutRod({section(-8, 34, -90, 2, 3), section(-6.5, 32, -180, 1.6, 3),
                       section(-5, 29.5, -270, 1.6, 3)},
                      kForward),
             6);
  bone.carve(cylinder({-1, 0, A - 11}, kLeft, 26, 17.4, 2), 1);   // face for the talus
  bone.carve(ellipsoidSolid({-16, 17, A - 7}, {5, 4.5, 6}), 3);   // malleolar fossa
  bone.carve(ellipsoidSolid({-19, 27, A + 2}, {3.5, 4, 16}), 4);  // groove of the peronei
  return bone.solid();
}

Solid patella() {
  Blend bone;
  // A rounded triangle, point down, thick in the middle.
  bone.unite(ellipsoidSolid({36, 2, 12}, {11, 22, 17}, turned(-4, kLeft), 2.3));
  bone.unite(stoutRod({section(35, 2, 4, 15, 8.5), section(34, 2, -8, 8, 6),
                       section(33, 2, -14, 3.5, 3.5)},
                      kForward),
             9);
  return bone.solid();
}

}  // namespace

// Head in the hip joint at the origin; condyles about the knee at z = -kThighLength. Neck: 126
// degrees to the shaft, turned forward by 12.
Solid femurSolid() {
  constexpr double K = -kThighLength;
  Blend bone;
  // Shaft, bowed forward, and its lower end.
  bone.unite(stoutRod({section(-8, 48, -30, 15, 16), section(-8, 48, -46, 17.5, 16.5),
                       section(-7, 45.5, -66, 16.5, 15.5), section(-4, 42.5, -95, 14.5, 14),
                       section(3, 37, -150, 13.6, 13.6), section(7, 30, -210, 13.4, 13.8),
                       section(6, 21.5, -275, 14, 14), section(3, 14, -325, 17, 15),
                       section(0, 7, -362, 25, 17.5), section(-2, 2, K + 26, 34, 20),
                       section(-2, 0, K + 8, 37, 22), section(-2, 0, K + 2, 36, 21)},
                      kForward, 2.15, 0.3));
  // Neck.
  bone.unite(stoutRod({section(0, 8, -6, 15, 16.5), section(-3, 19, -13, 12.3, 15.5),
                       section(-5, 30, -21, 12.5, 17.5), section(-8, 42, -31, 15, 22)},
                      kUp),
             7);
  // Greater trochanter with its fossa; lesser trochanter; the crest between them behind.
  bone.unite(stoutRod({section(-8, 52, -68, 10, 14), section(-9, 57, -52, 11.5, 17),
                       section(-9, 60, -38, 12, 20), section(-11, 59, -22, 11, 18.5),
                       section(-16, 55, -10, 8.5, 13), section(-20, 50.5, -4, 5.5, 8)},
                      kForward, 2.3),
             8);
  bone.carve(ellipsoidSolid({-20, 42, -14}, {8, 8, 10}), 5);
  bone.unite(stoutRod({section(-24, 51, -14, 4.5, 5), section(-23, 46, -34, 4.5, 4.5),
                       section(-21, 36, -56, 5, 5)},
                      kForward),
             9);
  bone.unite(stoutRod({section(-14, 36, -52, 9, 9), section(-19, 30, -60, 7.5, 8.5),
                       section(-22, 26.5, -62, 4.5, 5.5)},
                      kUp),
             8);
  // Line between them in front.
  bone.unite(stoutRod({section(4, 55, -28, 3, 3.5), section(7, 45, -44, 2.5, 3),
                       section(3, 33, -64, 2.5, 3)},
                      kForward),
             8);
  // Head, with the pit of its ligament.
  bone.unite(ballSolid({0, 0, 0}, 23), 3);
  bone.carve(ballSolid(Vector3d(-0.2, -0.95, -0.22).normalized() * 25, 4.5), 2);
  // Linea aspera, forking above to the gluteal tuberosity and the lesser trochanter and below to
  // both epicondyles.
  bone.unite(stoutRod({section(-17, 52, -62, 4.5, 4), section(-15.5, 46.5, -92, 3.6, 4.5),
                       section(-10.5, 38, -140, 2.6, 4.2), section(-7, 31.5, -195, 2.6, 5),
                       section(-7.5, 25, -250, 2.6, 4.2), section(-11, 25, -300, 2.4, 3.4),
                       section(-15, 29, -350, 2.6, 3), section(-15, 35, K + 26, 4, 4)},
                      kForward),
             7);
  bone.unite(stoutRod({section(-19, 32, -68, 3, 3), section(-12, 35, -120, 2.2, 3.5),
                       section(-7, 30, -195, 2.4, 4)},
                      kForward),
             7);
  bone.unite(stoutRod({section(-7, 24, -250, 2.4, 4), section(-10.5, 9, -305, 2.2, 3.2),
                       section(-14, -13, -355, 2.4, 3), section(-14, -31, K + 28, 4, 4.5)},
                      kForward),
             7);
  // Condyles: rolls that reach back and down, farther apart behind.
  for (double side : {-1.0, 1.0}) {
    const double lateral = side > 0 ? 1.0 : 0.0;
    const Vector3d axis = turned(-6 * side, kUp) * kLeft;
    bone.unite(cylinder({-10, 24.5 * side, K + 0.5}, axis, 20.5, 12.5, 8), 6);
    bone.unite(ellipsoidSolid({lateral, 23 * side, K + 5.5}, {31, 14.5, 27.5},
                              turned(-6 * side, kUp) * turned(-15, kLeft), 2.5),
               6);
    bone.unite(ellipsoidSolid({-7, 36 * side, K + 5}, {11, 5.5, 12}), 8);  // epicondyle
    // Lips of the patellar surface, the lateral one higher.
    bone.unite(ellipsoidSolid({15 + 2 * lateral, 16 * side + 1, K + 12}, {16, 12, 22 + 3 * lateral},
                              turned(-12, kLeft)),
               7);
  }
  bone.unite(ellipsoidSolid({-14, -35, K + 24}, {5, 4.5, 6}), 5);  // adductor tubercle
  // Groove of the patella and the notch behind it.
  bone.carve(stoutRod({section(44, 2, K + 46, 19, 16), section(44.5, 2, K + 22, 19, 16),
                       section(40, 1, K - 4, 16, 15), section(26, 0, K - 28, 13, 13),
                       section(4, 0, K - 34, 10, 13)},
                      kForward),
             7);
  bone.carve(stoutRod({section(2, 0, K - 28, 9, 20), section(-12, 0, K - 18, 10, 20),
                       section(-40, 0, K - 8, 11, 22)},
                      kUp, 2.4),
             5);
  bone.carve(ellipsoidSolid({-31, 4, K + 40}, {14, 24, 30}), 7);  // popliteal surface
  return bone.solid();
}

TriMesh femurMesh(const Anatomy& anatomy) {
  return boneSurface(
      femurSolid(), 2.2, 2500,
      limbPlace(anatomy.landmark("hip_joint_centre"), anatomy.landmark("knee"), kThighLength));
}

TriMesh shinMesh(const Anatomy& anatomy) {
  const Vector3d knee = anatomy.landmark("knee");
  const Affine3d thigh = limbPlace(anatomy.landmark("hip_joint_centre"), knee, kThighLength);
  const Affine3d shank = limbPlace(knee, anatomy.landmark("ankle"), kShankLength);
  const Solid femur = moved(femurSolid(), shank.inverse() * thigh);
  const std::vector<Solid> pair = keptApart({tibia(), fibula()}, 1.2);
  const auto clearOfFemur = [&](const Solid& bone, double gap) {
    return Blend(bone).carve(grown(femur, gap), 1);
  };
  TriMesh mesh = boneSurface(clearOfFemur(pair[0], 2.5), 2.0, 1600, shank);
  append(mesh, boneSurface(pair[1], 1.5, 850, shank));
  append(mesh, boneSurface(clearOfFemur(patella(), 3), 1.3, 500, shank));
  return mesh;
}

}  // namespace torso
