// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/bone_limb.h"
#include "model/bone_parts.h"

namespace torso {
namespace {

using Eigen::Affine3d;
using Eigen::Vector3d;

// The thumb points forward: at the elbow the radius lies to the side of the ulna, at the wrist in
// front of it.
Solid ulna() {
  constexpr double W = -kForearmLength;
  Blend bone;
  bone.unite(stoutRod({section(-17, -9, -26, 8, 12), section(-14, -8.5, -40, 7.2, 9.5),
                       section(-13, -7, -65, 6.4, 8), section(-13, -4, -105, 6, 7),
                       section(-14.5, -1.5, -150, 5.6, 6.2), section(-16.5, 0, -195, 5, 5.2),
                       section(-17.5, 0, -222, 5, 5), section(-17.5, 0, W + 27, 7, 7),
                       section(-17.5, 0, W + 21, 8, 8)},
                      kForward, 2.2, 0.5));
  // Olecranon behind the elbow, coronoid process in front of and below it.
  bone.unite(stoutRod({section(-18, -9, -26, 8.5, 10), section(-19.5, -9.5, -10, 10.5, 7.5),
                       section(-19, -9.5, 4, 11.5, 7.5), section(-15, -9.5, 12, 11, 7.5)},
                      kForward, 2.5, 0.6),
             5);
  bone.unite(stoutRod({section(-16, -9, -25, 9, 12), section(-4, -9.5, -19, 10.5, 7.5),
                       section(6, -10, -14.5, 9, 5), section(11.5, -10, -11, 5, 3)},
                      kUp, 2.3),
             6);
  bone.unite(ellipsoidSolid({-2, -8, -33}, {5, 6, 8}), 8);  // tuberosity
  // Edge for the interosseous membrane.
  bone.unite(stoutRod({section(-9, -2, -55, 2, 3), section(-6.5, 0, -110, 1.6, 3),
                       section(-10.5, 1, -165, 1.6, 3)},
                      kLeft),
             6);
  bone.unite(stoutRod({section(-22.5, 0, W + 28, 3.5, 4), section(-23.5, 0, W + 19, 2.8, 3),
                       section(-23.5, 0, W + 14.5, 2, 2)},
                      kForward),
             3);  // styloid process
  return bone.solid();
}

Solid radius() {
  constexpr double W = -kForearmLength;
  Blend bone;
  bone.unite(stoutRod({section(1, 13, -18, 7.2, 7.2), section(1, 12.5, -32, 6.2, 6.2),
                       section(2.5, 11, -46, 6.6, 7.2), section(6, 11, -70, 6, 7),
                       section(11, 11.5, -110, 5.8, 7.4), section(14, 9.5, -150, 6, 8),
                       section(14.5, 5, -195, 6.8, 9), section(11.5, 1.5, -226, 8.5, 12.5),
                       section(10, 0, W + 22, 10.5, 16), section(10, 0, W + 12, 11, 17)},
                      kForward, 2.3, 0.2));
  bone.unite(cylinder({1, 13, -16.5}, kUp, 11.3, 5, 2), 3);   // head
  bone.unite(ellipsoidSolid({-2, 6.5, -46}, {5, 5, 10}), 5);  // tuberosity
  bone.unite(stoutRod({section(1, 9, -75, 3, 2), section(3.5, 7, -120, 3, 1.6),
                       section(5.5, 4, -170, 3, 1.6), section(2, 1, -215, 3, 3)},
                      kLeft),
             6);  // edge for the interosseous membrane
  bone.unite(stoutRod({section(20, 0, W + 26, 8, 6), section(23, 0, W + 12, 6.5, 5.5),
                       section(25, 0, W + 3, 3.5, 3.2)},
                      kForward),
             5);  // styloid process
  // Tubercle of Lister on the back of the wrist, which looks outwards here.
  bone.unite(
      stoutRod({section(9, 10.5, W + 28, 2.2, 2.5), section(9, 11.5, W + 17, 2.2, 2.5)}, kForward),
      4);
  bone.carve(ballSolid({1, 13, -3.5}, 11), 1);                             // fovea of the head
  bone.carve(ellipsoidSolid({11.5, -0.5, W - 1.5}, {20, 14, 12.5}), 1.5);  // for the wrist
  bone.carve(cylinder({-17.5, 0, W + 22}, kUp, 9.2, 8, 3), 2);             // notch for the ulna
  return bone.solid();
}

}  // namespace

// Head in the shoulder joint at the origin, looking medially and back; trochlea and capitulum on
// the axis of the elbow.
Solid humerusSolid() {
  constexpr double E = -kUpperArmLength;
  Blend bone;
  bone.unite(stoutRod(
      {section(1, 8, -8, 18, 18), section(1, 8.5, -22, 16.5, 16.5),
       section(0, 7.5, -38, 13.5, 13.5), section(-1, 6, -58, 11.8, 12),
       section(-1, 4, -95, 11, 11.4), section(0, 2, -140, 10.6, 11), section(1, 0.5, -185, 11, 9.8),
       section(1, 0, -220, 14, 8.6), section(0.5, -1.5, -245, 20, 7.6),
       section(0, -3, -261, 25, 6.6), section(0, -3.5, -268, 24, 6.2)},
      kForward, 2.1, 0.4));
  bone.unite(ballSolid({0, 0, 0}, 23), 3);
  // The head is less than half a ball: the anatomical neck, a groove all around.
  const Vector3d head = Vector3d(-0.38, -0.68, 0.62).normalized();
  // Greater and lesser tubercle with their crests, the groove of the biceps between them.
  bone.unite(stoutRod({section(-4, 19, 6, 9, 13), section(-2, 20.5, -8, 8.5, 13.5),
                       section(1, 17, -26, 7, 10)},
                      kForward, 2.3),
             6);
  bone.unite(
      stoutRod({section(17, 5, -2, 7, 6), section(18, 6, -12, 6.5, 6), section(13, 4, -28, 4, 4.5)},
               kForward),
      6);
  bone.unite(stoutRod({section(12, 14.5, -20, 3, 3.5), section(10, 11.5, -48, 2.4, 3.4),
                       section(9, 7.5, -85, 2, 3)},
                      kForward),
             5);
  bone.carve(stoutRod({section(19, 14, 16, 3.6, 4.5), section(20, 14, -6, 3.6, 4.5),
                       section(17.5, 11, -30, 3, 4), section(14, 7, -60, 3, 3)},
                      kForward),
             4);
  bone.carve(torus(-2 * head, head, 25.5, 3), 5);
  // Deltoid tuberosity; groove of the radial nerve behind it.
  bone.unite(stoutRod({section(3, 11, -98, 3.5, 5), section(3, 12, -118, 4, 6),
                       section(3, 9.5, -142, 3, 4.5)},
                      kForward),
             8);
  bone.carve(stoutRod({section(-14, 6, -110, 5, 4), section(-11, 14.5, -150, 5, 4)}, kForward), 6);
  // Supracondylar ridges.
  bone.unite(stoutRod({section(0, 12, -205, 2.2, 2.5), section(0, 20, -238, 2.2, 2.5),
                       section(-1, 25, -259, 3.5, 4.5)},
                      kForward),
             6);
  bone.unite(stoutRod({section(0, -10, -200, 2, 2.5), section(-1, -18, -235, 2.2, 2.5),
                       section(-2, -29, -260, 4.5, 5)},
                      kForward),
             6);
  // Epicondyles, the medial one far out.
  bone.unite(stoutRod({section(-2, -22, E + 8, 9, 6.5), section(-5, -32, E + 11, 5.5, 5)}, kUp), 6);
  bone.unite(ellipsoidSolid({-1, 24, E + 9}, {6, 5.5, 8}), 5);
  // Trochlea, a spool with a higher medial lip, and capitulum, a ball that looks forward.
  const Vector3d axis = turned(-4, kForward) * kLeft;
  bone.unite(stoutRod({section(0, -19.5, E - 0.5, 13.4, 13.4), section(0, -16, E, 12.2, 12.2),
                       section(0, -9, E, 9, 9), section(0, -2, E, 10.8, 10.8),
                       section(0, 1, E, 10.6, 10.6)},
                      kUp, 2, 0.12),
             3);
  bone.unite(ellipsoidSolid({2, 11.5, E}, {11.2, 10.5, 11.2}), 2);
  bone.unite(cylinder({-1, 8, E + 4}, axis, 7, 12, 4), 4);
  bone.carve(ellipsoidSolid({-13, -9.5, E + 20}, {10.5, 11, 11}), 3);  // olecranon fossa
  bone.carve(ellipsoidSolid({11, -9.5, E + 18}, {6, 8, 7}), 3);        // coronoid fossa
  bone.carve(ellipsoidSolid({12, 11, E + 18}, {6, 7, 6}), 3);          // radial fossa
  return bone.solid();
}

TriMesh humerusMesh(const Anatomy& anatomy) {
  return boneSurface(humerusSolid(), 1.8, 2000,
                     limbPlace(anatomy.landmark("glenohumeral_centre_GH"),
                               anatomy.landmark("elbow"), kUpperArmLength));
}

TriMesh forearmMesh(const Anatomy& anatomy) {
  const Vector3d elbow = anatomy.landmark("elbow");
  const Affine3d upper_arm =
      limbPlace(anatomy.landmark("glenohumeral_centre_GH"), elbow, kUpperArmLength);
  const Affine3d forearm = limbPlace(elbow, anatomy.landmark("wrist"), kForearmLength);
  const Solid humerus = grown(moved(humerusSolid(), forearm.inverse() * upper_arm), 1.2);
  TriMesh mesh;
  for (const Solid& bone : keptApart({ulna(), radius()}, 1)) {
    append(mesh, boneSurface(Blend(bone).carve(humerus, 0.5), 1.4, 1250, forearm));
  }
  return mesh;
}

}  // namespace torso
