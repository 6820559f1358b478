// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include "model/bone_parts.h"
#include "model/fuse.h"

namespace torso {

using Eigen::Matrix3d;
using Eigen::Vector3d;

TriMesh clavicleMesh(const Anatomy& anatomy) {
  const Vector3d sc = anatomy.landmark("sternoclavicular_joint_SC");
  const Vector3d ac = anatomy.landmark("acromioclavicular_joint_AC");
  const Vector3d along = ac - sc;
  const Vector3d front = along.normalized().cross(Vector3d::UnitZ()).normalized() *
                         (along.y() > 0 ? 1 : -1);  // forward, across the clavicle
  // The medial part convex to the front, the lateral third concave: an S seen from above. Share of
  // the length, offset to the front and up, half axes across and up [mm].
  const double stations[][5] = {{0.03, 2, 2, 11, 11},     {0.12, 6, 3, 8, 8.5},
                                {0.28, 11, 3, 6.2, 6.5},  {0.45, 9, 3, 5.8, 6},
                                {0.62, 0, 2.5, 6.5, 5.5}, {0.78, -7, 2, 8.5, 5.2},
                                {0.90, -6, 1, 10, 5.2},   {0.975, -2, 0, 8, 5}};
  std::vector<Section> sections;
  for (const auto& s : stations) {
    sections.push_back({sc + s[0] * along + s[1] * 1e-3 * front + s[2] * 1e-3 * Vector3d::UnitZ(),
                        s[3] * 1e-3, s[4] * 1e-3});
  }
  TubeStyle style;
  style.sides = 10;
  style.steps = 2;
  style.cap = 0.35;
  return tube(sections, style);
}

TriMesh scapulaMesh(const Anatomy& anatomy) {
  const Vector3d aa = anatomy.landmark("acromion_angle_AA");
  const Vector3d ts = anatomy.landmark("scapula_root_of_spine_TS");
  const Vector3d ai = anatomy.landmark("scapula_inferior_angle_AI");
  const Vector3d gh = anatomy.landmark("glenohumeral_centre_GH");
  const Vector3d ac = anatomy.landmark("acromioclavicular_joint_AC");
  const double kHeadRadius = 26_mm;  // humeral head with both cartilages

  // Glenoid: faces the joint centre, along the blade.
  const Vector3d out = (gh - ts - pointMm(0, 0, -6)).normalized();
  const Vector3d glenoid = gh - kHeadRadius * out;
  const Vector3d up = (Vector3d::UnitZ() - out.z() * out).normalized();
  const Vector3d back = up.cross(out).normalized();  // dorsal side of the blade

  TriMesh mesh;
  TubeStyle style;

  // Blade: rows from the inferior angle up, columns from the medial to the lateral border.
  const Vector3d superior_angle = ts + pointMm(18, -5, 33);
  const Vector3d neck = glenoid - 13_mm * out;
  const Vector3d low_neck = neck - 17_mm * up - 4_mm * out,
                 top_neck = neck + 17_mm * up - 8_mm * out;
  const std::vector<Vector3d> medial = {ai + pointMm(1, -7, 5),
                                        0.70 * ai + 0.30 * ts + pointMm(-1, -6, 0),
                                        0.35 * ai + 0.65 * ts + pointMm(-2, -3, 0),
                                        ts,
                                        0.5 * (ts + superior_angle) + pointMm(0, -2, 0),
                                        superior_angle};
  const std::vector<Vector3d> lateral = {ai + pointMm(3, 7, 3),
                                         0.70 * ai + 0.30 * low_neck + pointMm(-1, 6, 0),
                                         0.33 * ai + 0.67 * low_neck + pointMm(0, 3, 0),
                                         low_neck,
                                         neck - 2_mm * out,
                                         top_neck};
  constexpr int kRows = 26, kColumns = 14;
  std::vector<std::vector<Vector3d>> grid(kRows, std::vector<Vector3d>(kColumns));
  std::vector<std::vector<double>> thickness(kRows, std::vector<double>(kColumns));
  for (int i = 0; i < kRows; i++) {
    const double t = 5.0 * i / (kRows - 1);
    const Vector3d a = curveAt(medial, t), b = curveAt(lateral, t);
    for (int j = 0; j < kColumns; j++) {
      const double s = j / (kColumns - 1.0);
      // Bent around the thorax; the superior border dips before the coracoid.
      const double bend = 4 * s * (1 - s);
      grid[i][j] = (1 - s) * a + s * b + bend * (i > 0 ? 0.05 : 0) * (b - a).norm() * back;
      if (t > 4) grid[i][j] -= (t - 4) * 9_mm * bend * up;
      thickness[i][j] = 3.0_mm + 1.5_mm * (s < 0.05) + 5.5_mm * std::max(0.0, (s - 0.7) / 0.3);
    }
  }
  append(mesh, plate(grid, thickness));

  // Neck and glenoid with a shallow dish; a pear, wider below.
  const Vector3d root = neck - 10_mm * out;
  append(mesh, tube({{root, 5.5_mm, 15_mm, up},
                     {neck, 7.5_mm, 15_mm, up},
                     {glenoid - 6_mm * out, 10_mm, 16_mm, up}},
                    style));
  std::vector<Ring> dish;
  for (const auto& s : {std::array<double, 2>{-7, 0.75},
                        {-4, 0.92},
                        {0.5, 1},
                        {1.2, 0.97},
                        {0.4, 0.8},
                        {-1, 0.4}}) {
    Ring ring;
    for (int k = 0; k < 28; k++) {
      const double angle = 2 * EIGEN_PI * k / 28;
      const double width = 12.5_mm - 2.5_mm * std::sin(angle);
      ring.push_back(glenoid + s[0] * 1e-3 * out +
                     s[1] * (width * std::cos(angle) * back + 18_mm * std::sin(angle) * up));
    }
    dish.push_back(ring);
  }
  append(mesh, loft(dish));

  // Spine: a plate that stands off the back of the blade from TS to the acromion.
  const Vector3d acromion_root = aa + pointMm(-6, -24, -8);
  constexpr int kAlong = 13;
  std::vector<std::vector<Vector3d>> fin(5, std::vector<Vector3d>(kAlong));
  std::vector<std::vector<double>> fin_thickness(5, std::vector<double>(kAlong));
  const Vector3d notch = neck - 14_mm * out + 7_mm * up;
  for (int j = 0; j < kAlong; j++) {
    const double s = j / (kAlong - 1.0);
    const Vector3d foot = ts + s * (notch - ts) + 4 * s * (1 - s) * 3_mm * back;
    const Vector3d crest =
        ts + s * (acromion_root - ts) + 2_mm * back + 4 * s * (1 - s) * pointMm(-6, 0, 3);
    for (int i = 0; i < 5; i++) {
      fin[i][j] = foot + 0.25 * i * (crest - foot);
      fin_thickness[i][j] = 3.5_mm + 4_mm * std::pow(0.5 * i - 1, 2);
    }
  }
  append(mesh, plate(fin, fin_thickness));

  // Acromion: from the spine around the angle AA forward over the joint to the clavicle.
  style.squareness = 2.6;
  append(mesh, tube({{acromion_root - pointMm(2, 12, 2), 5_mm, 6_mm},
                     {aa + pointMm(-1, -12, -2), 8_mm, 4.5_mm},
                     {aa + pointMm(12, -9, 3), 11_mm, 4_mm},
                     {0.35 * aa + 0.65 * ac + pointMm(6, 9, -1), 10.5_mm, 4_mm},
                     {ac + pointMm(7, 10, -3), 7_mm, 3.5_mm}},
                    style));
  // Coracoid: up and forward from the neck, then hooks to the side.
  style.squareness = 2;
  append(mesh, tube({{top_neck - 2_mm * up + 2_mm * out, 8_mm, 7_mm},
                     {top_neck + pointMm(10, -3, 8), 7_mm, 6.5_mm},
                     {top_neck + pointMm(24, -2, 10), 6_mm, 5.5_mm},
                     {top_neck + pointMm(36, 6, 4), 5.5_mm, 5_mm},
                     {top_neck + pointMm(42, 12, -2), 4.5_mm, 4.5_mm}},
                    style));
  return fuse(mesh, {1.1_mm, 5_mm, 1000, 2, false},
              ellipsoid(gh, pointMm(25.5, 25.5, 25.5), Matrix3d::Identity(), 28));
}

}  // namespace torso
