// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/bone_skull.h"

#include <cmath>

#include "model/bone_parts.h"
#include "model/surface.h"

// Sizes after the means that craniometry gives for European men (Howells 1973, Cranial Variation in
// Man: lengths, breadths, and radii from the ear holes); the course in between after general
// anatomy.

namespace torso {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d turned(double x, double y, double z) {  // [rad]
  return (AngleAxisd(z, Vector3d::UnitZ()) * AngleAxisd(y, Vector3d::UnitY()) *
          AngleAxisd(x, Vector3d::UnitX()))
      .toRotationMatrix();
}

// Half space below z = height + slope_x * x, as far as the skull reaches.
Solid below(double height, double slope_x) {
  const Vector3d normal = Vector3d(-slope_x, 0, 1).normalized();
  const Vector3d on(0, 0, height);
  return {Eigen::AlignedBox3d(Vector3d(-200, -200, -200), Vector3d(200, 200, 200)),
          [=](const Vector3d& p) { return (p - on).dot(normal); }};
}

void addVault(Blend& s) {
  s.unite(ellipsoidSolid({-3, 0, 54}, {86, 65, 71}), 0);
  s.unite(ellipsoidSolid({-22, 0, 57}, {60, 70.5, 60}), 14);      // parietal bones
  s.unite(ellipsoidSolid({34, 0, 61}, {52, 55, 52}), 14);         // frontal
  s.unite(ellipsoidSolid({-45, 0, 26}, {42, 52, 46}), 14);        // occipital
  s.unitePair(ellipsoidSolid({20, 26, 16}, {34, 27.5, 28}), 12);  // poles of the temporal lobes
  s.carve(below(-14.5, 0.13), 12);                                // base
  s.unitePair(ellipsoidSolid({-4, 50, 8}, {32, 13, 18}), 10);     // temporal bones
  // Protuberance and lines where the neck's muscles end.
  s.unite(ellipsoidSolid({-82, 0, 2}, {6, 8, 5}), 10);
  s.unitePair(bar({{{-83, 3, 4}, 1.5, 1.5},
                   {{-72, 29, 5}, 1.5, 1.5},
                   {{-53, 43, 0}, 2, 2},
                   {{-32, 53, -5}, 3, 3}}),
              8);
  // Temporal lines, as far as they stand out.
  s.unitePair(bar({{{72, 47.5, 36}, 2.5, 2.5}, {{69, 47, 48}, 2, 2}, {{62, 47, 60}, 2, 2}}), 8);
}

void addBase(Blend& s, const Vector3d& condyle) {
  s.unite(bar({{{2, 0, -9}, 12, 6}, {{18, 0, -6}, 13, 9}, {{36, 0, 2}, 14, 12}}),
          8);  // clivus
  s.unitePair(bar({{{-4, 48, -6}, 10, 9}, {{8, 32, -10}, 8, 7}, {{20, 16, -9}, 6, 6}}), 8);
  // Mastoid process, with the notch for the digastric muscle on its inside.
  s.unitePair(bar({{{-17, 55.5, 4}, 9, 13}, {{-14, 55, -9}, 8.5, 10}, {{-9, 52, -23}, 4.5, 5.5}},
                  Vector3d::UnitX()),
              8);
  s.carvePair(bar({{{-30, 45, -19}, 2.5, 5}, {{-10, 43, -21}, 2.5, 6}}), 4);
  s.unitePair(
      bar({{{1, 38, -13}, 2.8, 2.8}, {{5, 36.5, -25}, 1.9, 1.9}, {{10, 34, -40}, 1.3, 1.3}}),
      4);  // styloid process
  // Occipital condyles on C1, converging forward.
  s.unitePair(
      ellipsoidSolid(condyle + Vector3d(0, -0.8, 5.5), {11, 6, 5.5}, turned(-0.3, 0, -0.35)), 5);
  s.carve(ellipsoidSolid({-17, 0, -20}, {18, 15, 26}, turned(0, -0.12, 0)), 4);  // foramen magnum
  s.unitePair(ellipsoidSolid({-47, 24, -11}, {20, 20, 8}), 14);  // floor of the rear fossa
  // Pterygoid plates behind the upper jaw.
  s.unitePair(bar({{{42, 12, -8}, 2, 5}, {{44, 12.5, -22}, 1.3, 4.5}, {{44, 13, -36}, 1.2, 3}},
                  Vector3d::UnitX()),
              3);
  s.unitePair(bar({{{40, 17, -6}, 2, 6}, {{39, 20, -18}, 1.3, 7}, {{37, 22, -32}, 1.2, 5}},
                  Vector3d::UnitX()),
              3);
  s.unitePair(ellipsoidSolid({46, 20, -10}, {8, 12, 8}), 6);
  // Passages of nerves and vessels.
  s.carvePair(ellipsoidSolid({4, 26, -16}, {5, 3.5, 7}), 2.5);   // jugular
  s.carvePair(ellipsoidSolid({16, 27, -15}, {3, 3, 7}), 2);      // carotid
  s.carvePair(ellipsoidSolid({27, 24, -10}, {3.5, 2.3, 7}), 2);  // oval
  // Joint of the jaw: hollow and eminence; ear hole.
  s.unitePair(bar({{{22, 44, -3}, 6, 4.5}, {{21, 58, -3}, 5, 4}}), 6);
  s.carvePair(ellipsoidSolid({10.5, 51, -7}, {7, 12, 8.2}, turned(0, 0, -0.2)), 4);
  s.carvePair(bar({{{-1.5, 72, -5}, 4.2, 5}, {{-1, 46, -4.5}, 3, 3.4}}), 2.5);
}

void addFace(Blend& s) {
  s.unite(ellipsoidSolid({63, 0, 14}, {24, 15, 26}), 8);        // between the orbits
  s.unitePair(ellipsoidSolid({66, 18, -16}, {20, 21, 24}), 8);  // upper jaw
  s.unitePair(ellipsoidSolid({48, 24, -26}, {14, 10, 12}), 8);  // tuberosity
  // Brow, from the glabella to the cheek bone.
  s.unitePair(bar({{{85.5, 5, 37}, 6.5, 7},
                   {{85.5, 18, 40}, 5.2, 6},
                   {{80.5, 33, 40.5}, 4.3, 5.5},
                   {{73.5, 44, 36.5}, 4, 5},
                   {{69.5, 48.5, 29}, 3.6, 4.5}}),
              15);
  s.unite(ellipsoidSolid({86.5, 0, 33}, {6, 9, 9}), 8);  // glabella
  // Cheek bone: side of the orbit, body, and its way down to the upper jaw.
  s.unitePair(bar({{{69, 48.8, 30}, 3.2, 4},
                   {{64.5, 50, 18}, 3.2, 4.5},
                   {{65, 49.5, 6}, 3.8, 6},
                   {{68, 46.5, -4}, 4.5, 7},
                   {{73, 40, -9}, 4.5, 7},
                   {{79, 31, -9}, 4.5, 6},
                   {{84, 21, -4}, 4, 5}},
                  Vector3d(1, 0.75, 0)),
              6);
  s.unitePair(bar({{{67, 46.5, -9}, 6, 5},
                   {{66.5, 42.5, -18}, 6, 5},
                   {{66, 36.5, -26}, 6, 5},
                   {{65, 30, -34}, 6, 5}},
                  Vector3d(1, 0.5, 0)),
              6);
  // Side wall of the orbit, which is the great wing of the sphenoid bone.
  s.unitePair(bar({{{66, 48, 17}, 2.5, 14}, {{54, 40, 14}, 3.5, 16}, {{44, 32, 10}, 5, 16}}), 6);
  // Arch to the ear, free of the vault.
  s.unitePair(bar({{{62, 52, -7}, 2.8, 7},
                   {{50, 60, -8}, 2.2, 5},
                   {{36, 64.4, -8}, 1.9, 4},
                   {{22, 64.3, -5.5}, 2.1, 4},
                   {{9, 61, -1}, 3, 3.6},
                   {{-6, 59, 4}, 3, 3}}),
              4);
  // Nasal bones, and beside them the upper jaw's way up to the brow.
  s.unite(bar({{{86, 0, 29}, 6, 4.5}, {{89.5, 0, 19}, 5.6, 3.6}, {{94.5, 0, 7}, 7, 3}},
              Vector3d::UnitX()),
          4);
  s.unitePair(bar({{{83, 8.5, 27}, 3.4, 6},
                   {{86, 9.8, 12}, 3.4, 6},
                   {{87, 13.5, -3}, 3.2, 5},
                   {{87, 17, -16}, 3.2, 5},
                   {{88, 12, -27}, 4, 5}},
                  Vector3d(1, -0.4, 0)),
              5);
  s.unite(bar({{{84, -12, -29}, 4, 4}, {{88.5, 0, -29}, 4, 4}, {{84, 12, -29}, 4, 4}}), 5);
  // Bone of the upper teeth's roots.
  const DentalArch& arch = upperArch();
  std::vector<Section> ridge, floor;
  for (int k = -6; k <= 6; k++) {
    const double angle = k / 6.0 * arch.lastAngle();
    ridge.push_back({arch.point(angle, 14, 4.4), 5, 5.5});
    floor.push_back({arch.point(angle, 23, 6), 6, 7});
  }
  s.unite(bar(ridge, Vector3d::UnitZ(), 4), 4);
  s.unite(bar(floor, Vector3d::UnitZ(), 2), 5);
}

void cutFace(Blend& s) {
  // Orbits: four-sided pyramids, wider and drooping to the side, their axes 22 degrees apart from
  // the mid-line.
  s.carvePair(bar({{{41, 13.5, 19}, 2.5, 2.5},
                   {{50, 17.5, 19}, 7.5, 8},
                   {{60, 22.5, 18.5}, 12.5, 13},
                   {{70, 27, 18}, 16.3, 16.3},
                   {{79, 30.3, 17.5}, 18.6, 17},
                   {{100, 39, 16}, 21, 17}},
                  Vector3d(0, 0.17, 1), 2.5),
              4);
  s.carvePair(ellipsoidSolid({40, 12.5, 21}, {5, 2.6, 2.6}), 1.5);            // optic canal
  s.carvePair(bar({{{43, 15, 14}, 1.6, 2.5}, {{47, 22, 20}, 1.4, 2}}), 1.5);  // upper fissure
  // Nose: a pear.
  s.carvePair(ellipsoidSolid({86, 6, -15}, {30, 6, 9.5}), 2.5);
  s.carve(ellipsoidSolid({90, 0, -4}, {26, 6.5, 12.5}), 3);
  s.unite(bar({{{66, 0, -8}, 1.3, 20}, {{80, 0, -9}, 1.2, 17}}), 1.5);  // its wall
  s.unite(bar({{{84, 0, -25.5}, 2.6, 2.6}, {{94, 0, -24}, 1.2, 1.4}}), 3);
  s.unitePair(bar({{{60, 11, -13}, 3.4, 3.2}, {{80, 11, -15}, 2.6, 2.6}}), 2);  // concha

  s.carvePair(ellipsoidSolid({92, 28, -20}, {10, 9, 9}), 8);    // hollow above the canine
  s.carvePair(ellipsoidSolid({85, 27, -8}, {6, 1.8, 1.5}), 2);  // below the orbit
  s.carvePair(ellipsoidSolid({92, 24.5, 35}, {6, 2, 2}), 2);    // notch in the brow
  s.carve(ellipsoidSolid({64, 0, -45}, {21, 19.5, 14}), 5);     // palate
  s.carvePair(ellipsoidSolid({42, 6.3, -18}, {16, 5, 10}), 2);  // rear openings of the nose
}

}  // namespace

TriMesh skullMesh(const Vector3d& condyle) {
  Blend s;
  addVault(s);
  addBase(s, condyle);
  addFace(s);
  cutFace(s);
  return surface(s, 1.4, 7000, true, Finish::kEven);
}

}  // namespace torso
