// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/bone_parts.h"
#include "model/fuse.h"

namespace torso {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Left hip bone; coordinates from the hip joint centre [mm].
TriMesh hipBone(const Anatomy& anatomy) {
  const Vector3d hip = anatomy.landmark("hip_joint_centre");
  const auto at = [&](double x, double y, double z) -> Vector3d { return hip + pointMm(x, y, z); };
  const auto section = [&](double x, double y, double z, double side, double up) {
    return Section{at(x, y, z), side * 1e-3, up * 1e-3};
  };
  TriMesh mesh;

  // Wing: columns from the posterior to the anterior superior spine.
  const std::vector<Vector3d> crest = {at(-92, -43, 90), at(-84, -31, 116), at(-64, -5, 142),
                                       at(-34, 25, 157), at(0, 44, 155),    at(26, 51, 138),
                                       at(42, 46, 110),  at(49, 37, 77)};
  const std::vector<Vector3d> middle = {at(-88, -41, 82), at(-76, -33, 84), at(-55, -16, 92),
                                        at(-30, 8, 96),   at(-4, 23, 96),   at(17, 28, 90),
                                        at(34, 29, 78),   at(37, 27, 63)};
  const std::vector<Vector3d> base = {at(-83, -40, 66), at(-70, -34, 60), at(-51, -23, 60),
                                      at(-31, -9, 50),  at(-10, 3, 36),   at(10, 9, 31),
                                      at(24, 13, 36),   at(33, 16, 45)};
  constexpr int kRows = 12, kColumns = 25;
  std::vector<std::vector<Vector3d>> grid(kRows, std::vector<Vector3d>(kColumns));
  std::vector<std::vector<double>> thickness(kRows, std::vector<double>(kColumns));
  for (int j = 0; j < kColumns; j++) {
    const double s = 7.0 * j / (kColumns - 1);
    const std::vector<Vector3d> column = {curveAt(base, s), curveAt(middle, s), curveAt(crest, s)};
    for (int i = 0; i < kRows; i++) {
      const double t = i / (kRows - 1.0);
      grid[i][j] = curveAt(column, 2 * t);
      const double back = std::max(0.0, 1 - s / 2.5);  // thick where it meets the sacrum
      thickness[i][j] = (4.5 + 8 * std::pow(1 - t, 2) + 6.5 * std::pow(t, 6) + 7 * back) * 1e-3;
    }
  }
  append(mesh, plate(grid, thickness));
  TubeStyle style;
  // Lip of the crest, and the anterior spines.
  std::vector<Section> lip;
  const double lip_width[] = {7, 6.5, 5.5, 5.5, 6.5, 6.5, 5.5, 6};
  for (int k = 0; k < 8; k++) lip.push_back({crest[k], lip_width[k] * 1e-3, 4.5_mm});
  style.up = Vector3d(0.2, 1, 0.2);
  for (Section& s : lip) std::swap(s.side, s.up);
  append(mesh, tube(lip, style));
  append(mesh, tube({section(30, 14, 42, 8, 7), section(35, 16, 47, 6, 5.5)}, style));
  // Arcuate line: from the roof of the acetabulum to the joint with the sacrum.
  style.up = Vector3d::UnitZ();
  append(mesh, tube({section(14, 0, 28, 12, 12), section(-12, -6, 38, 11, 11),
                     section(-34, -18, 56, 8, 10), section(-54, -28, 72, 7, 12),
                     section(-72, -34, 78, 6, 14)},
                    style));

  // Acetabulum: a cup open to the side, the front and below.
  const Vector3d open = Vector3d(0.30, 0.80, -0.52).normalized();
  const Vector3d a = open.unitOrthogonal(), b = open.cross(a);
  std::vector<Ring> cup;
  const double inner = 26.5_mm, outer = 34_mm;
  const auto cupRing = [&](double radius, double degrees) {
    const double polar = degrees * EIGEN_PI / 180;  // from the bottom of the cup
    Ring ring;
    for (int k = 0; k < 32; k++) {
      const double angle = 2 * EIGEN_PI * k / 32;
      ring.push_back(hip +
                     radius * (-std::cos(polar) * open +
                               std::sin(polar) * (std::cos(angle) * a + std::sin(angle) * b)));
    }
    cup.push_back(ring);
  };
  for (double d : {20, 40, 60, 78}) cupRing(outer, d);
  cupRing(0.96 * outer, 88);
  cupRing(0.5 * (inner + outer), 91);
  for (double d : {86, 70, 50, 25}) cupRing(inner, d);
  append(mesh, loft(cup));

  // Posterior column, ischium with its tuberosity and ramus, up to the pubis.
  style.up = Vector3d(0, 1, 0.0);
  append(mesh, tube({section(-16, -12, 34, 11, 10), section(-24, -16, 8, 9, 12),
                     section(-26, -16, -22, 9, 13), section(-30, -17, -46, 12, 13),
                     section(-34, -19, -66, 13, 14), section(-30, -23, -82, 12, 12)},
                    style));
  append(mesh, tube({section(-8, -12, -28, 8, 11), section(-18, -14, -50, 8, 12)}, style));
  append(mesh, tube({section(-30, -22, -80, 11, 10), section(-14, -33, -83, 7, 6),
                     section(4, -48, -74, 6.5, 5), section(20, -62, -62, 7, 5),
                     section(32, -72, -48, 9, 6)},
                    style));
  // Ischial spine.
  append(mesh, tube({section(-36, -20, -14, 7, 6), section(-47, -29, -18, 4, 3),
                     section(-53, -34, -19, 2, 1.8)},
                    style));
  // Superior ramus and body of the pubis.
  style.up = Vector3d::UnitZ();
  append(mesh,
         tube({section(12, -12, 2, 14, 13), section(30, -27, 4, 9, 9), section(43, -46, -2, 7, 7.5),
               section(49, -62, -13, 7, 8), section(46, -72, -22, 8, 10)},
              style));
  style.up = Vector3d::UnitX();
  style.squareness = 2.4;
  append(mesh, tube({section(48, -72, -18, 9, 6.5), section(43, -74, -32, 9, 7),
                     section(34, -75, -47, 7.5, 6)},
                    style));
  // Pubic tubercle.
  append(mesh, ellipsoid(at(51, -60, -13), Vector3d(5_mm, 5_mm, 5_mm), Matrix3d::Identity(), 14));
  return mesh;
}

}  // namespace

std::vector<BonePart> pelvisMesh(const Anatomy& anatomy) {
  const TriMesh socket = ellipsoid(anatomy.landmark("hip_joint_centre"), pointMm(25.5, 25.5, 25.5),
                                   Matrix3d::Identity(), 28);
  TriMesh bone = sacrumMesh(anatomy);
  appendPair(bone, fuse(hipBone(anatomy), {1.6_mm, 8_mm, 1500, 2, false}, socket));
  // Symphysis, between the two bodies of the pubis.
  const Vector3d hip = anatomy.landmark("hip_joint_centre");
  TubeStyle style;
  style.up = Vector3d::UnitX();
  const Vector3d middle(hip.x(), 0, hip.z());
  const TriMesh symphysis = tube({{middle + pointMm(47, 0, -19), 5_mm, 6.5_mm},
                                  {middle + pointMm(42, 0, -32), 5_mm, 6.5_mm},
                                  {middle + pointMm(34, 0, -46), 4.5_mm, 5.5_mm}},
                                 style);
  return {{Tissue::kBone, bone}, {Tissue::kCartilage, symphysis}};
}

}  // namespace torso
