// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/bone_limb.h"
#include "model/bone_parts.h"
#include "model/surface.h"

namespace torso {
namespace {

using Eigen::Affine3d;
using Eigen::Vector3d;

// Half the distance of the hip joint centres that the numbers below are for [mm].
constexpr double kHalfHipWidth = 85;

// Half the gap between the pubic bones [mm].
constexpr double kHalfSymphysis = 2.5;

// Wing of the ilium, without what carries the acetabulum. From the posterior to the anterior
// superior spine.
void addWing(Blend& bone) {
  const std::vector<Vector3d> crest = {{-93, -43, 86}, {-87, -33, 103}, {-71, -16, 119},
                                       {-49, 10, 130}, {-19, 34, 134},  {9, 46.5, 127},
                                       {32, 48, 105},  {49, 36, 75}};
  const std::vector<Vector3d> middle = {{-88, -43, 78},  {-79, -37, 90}, {-63, -27, 101},
                                        {-45, -11, 106}, {-20, 12, 107}, {2, 24, 101},
                                        {23, 31, 86},    {43, 29, 63}};
  const std::vector<Vector3d> low = {{-82, -43, 67}, {-72, -38, 72}, {-56, -31, 76}, {-41, -21, 76},
                                     {-22, -1, 72},  {-3, 11, 64},   {17, 18, 56},   {36, 22, 50}};
  const std::vector<Vector3d> base = {{-76, -42, 58}, {-66, -38, 56}, {-52, -31, 54},
                                      {-38, -22, 50}, {-22, -10, 42}, {-4, 2, 34},
                                      {14, 9, 30},    {30, 15, 40}};
  bone.unite(bentPlate({base, low, middle, crest}, {{12, 16, 18, 17, 16, 16, 15, 12},
                                                    {14, 17, 16, 9, 6.5, 7.5, 8, 9},
                                                    {14, 15, 12, 6, 3.8, 5, 7, 8},
                                                    {9, 9, 8, 7, 7, 8, 8, 8}}));
  // The auricular part, across the side of the sacrum, of which pelvisMesh cuts the face.
  bone.unite(stoutRod({section(-37, -27, 98, 11, 13), section(-50, -32, 88, 15, 13),
                       section(-64, -37, 76, 14, 11), section(-76, -40, 66, 9, 9)},
                      kLeft),
             10);
  // The crest's lips, thickest at its tubercle; the spines at its ends.
  const double half_width[] = {7.5, 7.5, 6.5, 5, 5.2, 7.5, 6.5, 5.5};
  std::vector<Section> lips;
  for (std::size_t k = 0; k < crest.size(); k++) {
    lips.push_back({crest[k] - 1.5 * (crest[k] - middle[k]).normalized(), half_width[k], 5,
                    crest[k] - middle[k]});
  }
  bone.unite(stoutRod(lips, kUp), 5);
  bone.unite(ellipsoidSolid({48, 36, 73}, {5.5, 6, 7.5}), 4);
  bone.unite(ellipsoidSolid({-94.5, -43, 83}, {5.5, 6.5, 7}), 3);
  bone.unite(ellipsoidSolid({-79, -42, 57}, {6.5, 6, 5.5}), 4);
  bone.carve(ballSolid({-100, -43, 67}, 12), 6);
  // Pillar from the acetabulum to the tubercle of the crest.
  bone.unite(stoutRod({section(2, 12, 34, 10, 9), section(9, 26, 70, 9, 3.4),
                       section(14, 38.5, 98, 9, 3.2), section(17, 47, 116, 9, 4)},
                      kLeft),
             18);
}

// Left hip bone [mm]; origin in the hip joint. The iliac bone reaches into the sacrum.
Solid hipBone() {
  Blend bone;
  addWing(bone);
  // Arcuate line, from the roof of the acetabulum to the joint with the sacrum.
  bone.unite(stoutRod({section(12, -6, 22, 11, 12), section(-8, -12, 31, 9, 12),
                       section(-28, -20, 44, 8, 11), section(-46, -29, 60, 9, 12),
                       section(-60, -35, 74, 9, 14)},
                      kUp),
             8);
  bone.unite(stoutRod({section(28, 13, 38, 7, 7), section(34, 16, 44, 6, 6),
                       section(37, 16.5, 47, 4.5, 4.5)},
                      kUp),
             6);  // anterior inferior spine

  // Acetabulum: most of a ball, open to the side, downwards and a little forward.
  const Vector3d open = Vector3d(0.30, 0.76, -0.58).normalized();
  const Vector3d notch =
      (Vector3d(0.12, -0.1, -1) - Vector3d(0.12, -0.1, -1).dot(open) * open).normalized();
  bone.unite(Blend()
                 .unite(ballSolid({0, 0, 0}, 33.5))
                 .clip(halfSpace(1.5 * open, open), 3)
                 .carve(halfSpace({0, -28, 0}, kLeft), 6)
                 .solid(),
             7);

  // Behind and below it the ischium with its spine, tuberosity and ramus.
  bone.unite(stoutRod({section(-20, -13, 30, 13, 10), section(-23, -15, 10, 12.5, 8.5),
                       section(-24, -15, -12, 13, 8.5), section(-23, -13, -32, 15, 11.5),
                       section(-28, -15, -48, 16, 13.5), section(-30, -18, -60, 15, 14),
                       section(-27, -22, -69, 10, 10.5)},
                      kLeft, 2.3),
             8);
  bone.unite(ellipsoidSolid({-35, -16, -54}, {8.5, 12, 18.5}, turned(-14, kLeft), 2.3), 7);
  bone.unite(stoutRod({section(-31, -18, -7, 12, 6), section(-43, -28, -14, 7, 3.8),
                       section(-51, -36, -18.5, 2.6, 2.4)},
                      kLeft),
             8);
  bone.unite(stoutRod({section(-24, -23, -70, 11, 10), section(-8, -35, -74, 8.5, 6.5),
                       section(8, -51, -67, 7.5, 4.8), section(20, -65, -53, 8, 4.8),
                       section(28, -74, -38, 9.5, 6)},
                      kLeft),
             6);
  // Pubis: superior ramus, body and tubercle; the pecten on top; the iliopubic eminence.
  bone.unite(stoutRod({section(12, -12, 6, 13, 13), section(26, -25, 8, 9.5, 9.5),
                       section(38, -43, 5, 7, 8), section(44, -60, 0, 7.5, 8.5),
                       section(44, -72, -4, 8, 9)},
                      kUp),
             8);
  bone.unite(stoutRod({section(44, -74, 1, 10, 6.5), section(41, -74.5, -10, 11, 7.5),
                       section(35, -76, -22, 10, 7.5), section(28, -77, -35, 8, 6.5)},
                      kForward, 2.5),
             6);
  bone.unite(ellipsoidSolid({50, -62, 4.5}, {5, 5.5, 4.5}), 5);
  bone.unite(stoutRod({section(14, -20, 19, 3, 3.5), section(28, -31, 16, 2.4, 3),
                       section(42, -54, 9, 2.2, 3), section(49, -63, 7, 2.5, 3)},
                      kUp),
             6);
  bone.unite(ellipsoidSolid({24, -13, 19}, {8, 8, 6}), 8);
  // Groove under the superior ramus, for the obturator nerve.
  bone.carve(stoutRod({section(6, -34, -9, 5, 5), section(28, -46, -8, 4, 5)}, kUp), 5);
  // Symphyseal face; the socket with its fossa and notch, which leave a crescent.
  bone.carve(halfSpace({0, -kHalfHipWidth + kHalfSymphysis, 0}, kLeft), 1.5);
  bone.carve(ballSolid({0, 0, 0}, 25.5), 1);
  bone.carve(stoutRod({{-16.5 * open, 10, 10.5, open},
                       {-9 * open + 13 * notch, 10, 10.5, open},
                       {1 * open + 25 * notch, 9.5, 10, open},
                       {8 * open + 38 * notch, 9.5, 10, open}},
                      open),
             2);
  return bone.solid();
}

// Fibrocartilage between the pubic bones.
Solid symphysis() {
  return stoutRod({section(44, -kHalfHipWidth, -1, kHalfSymphysis + 0.2, 5.5),
                   section(40, -kHalfHipWidth, -11, kHalfSymphysis + 0.2, 6.5),
                   section(34, -kHalfHipWidth, -23, kHalfSymphysis + 0.2, 6),
                   section(29, -kHalfHipWidth, -31, kHalfSymphysis + 0.2, 5)},
                  kForward, 3);
}

}  // namespace

std::vector<BonePart> pelvisMesh(const Anatomy& anatomy) {
  const Vector3d hip = anatomy.landmark("hip_joint_centre");
  Affine3d X = Affine3d::Identity();
  X.translation() = hip;
  X.linear() *= hip.y() / kHalfHipWidth;

  TriMesh bone = sacrumMesh(anatomy);
  // The auricular faces: what the sacrum leaves of the iliac bones, less the cartilage.
  const Solid clear_of = grown(moved(meshSolid(bone), X.inverse()), 1);
  const Blend left = Blend(hipBone()).carve(clear_of, 1);
  appendPair(bone, boneSurface(left, 2.0, 3300, X));
  const Blend joint = Blend(moved(symphysis(), X));
  return {{Tissue::kBone, bone},
          {Tissue::kCartilage, surface(joint, 1.2_mm, 200, true, Finish::kRounded)}};
}

}  // namespace torso
