// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "model/bone_parts.h"
#include "model/bone_skull.h"
#include "model/loft.h"
#include "model/mesh_checks.h"
#include "model/sheet.h"
#include "model/surface.h"

namespace torso {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

Vector3d DentalArch::outwards(double angle) const {
  return Vector3d(width * std::cos(angle), length * std::sin(angle), 0).normalized();
}

Vector3d DentalArch::point(double angle, double root, double inset) const {
  const double behind = length * (1 - std::cos(angle));
  return Vector3d(front - behind, width * std::sin(angle),
                  edge_front + edge_rise * behind + (upper ? root : -root)) -
         inset * outwards(angle);
}

double DentalArch::speed(double angle) const {
  return std::hypot(width * std::cos(angle), length * std::sin(angle));
}

double DentalArch::curvature(double angle) const {
  return width * length / std::pow(speed(angle), 3);
}

double DentalArch::lastAngle() const {
  double angle = 0;
  for (double crown : crowns) {
    angle += 0.5 * crown / speed(angle);
    angle += 0.5 * crown / speed(angle);
  }
  return angle;
}

// Widths of crowns: Wheeler's means (incisors, canine, premolars, two molars; no wisdom teeth).
const DentalArch& upperArch() {
  static const DentalArch arch = {95, 29.5, 47, -53.5, 0.11, true, {8.5, 6.5, 7.5, 7, 7, 10, 9.5}};
  return arch;
}

const DentalArch& lowerArch() {
  static const DentalArch arch = {92, 27.5, 48, -53.2, 0.064, false, {5, 5.5, 7, 7, 7, 11, 10.5}};
  return arch;
}

// Crowns as shells of their own, round at the neck, wider towards the edge of incisors and the face
// of molars.
TriMesh teethMesh(const DentalArch& arch, const TriMesh& jaw) {
  TriMesh mesh;
  const MeshTree bone(jaw);
  constexpr int kSides = 8;
  constexpr double kGap = 0.35;  // so that no two shells touch [mm]
  double angle = 0;
  for (std::size_t i = 0; i < arch.crowns.size(); i++) {
    const double half = 0.5 * arch.crowns[i];
    angle += half / arch.speed(angle);
    const bool incisor = i<2, canine = i == 2, molar = i> 4;
    // Depth, front to back or cheek to tongue, at the neck and at the edge; height of the crown.
    const double neck = incisor ? 3 : canine ? 3.8 : molar ? 5 : 4.2;
    const double edge = incisor ? 0.9 : canine ? 1.1 : molar ? 3.9 : 2.9;

    // Along the crown: share of its height from the edge, depth, share of its width.
    const double rows[][3] = {{1.0, neck, 0.74},
                              {0.62, 1.08 * neck, 0.92},
                              {0.25, 0.5 * (neck + edge), 0.97},
                              {0.05, edge, 0.95},
                              {-0.02, 0.6 * edge, canine ? 0.4 : 0.8}};
    const Vector3d outwards = arch.outwards(angle), along(-outwards.y(), outwards.x(), 0);
    // Of a row of a crown so high: a point at a share of its depth and width.
    const auto at = [&](const double* row, double height, double out, double side) -> Vector3d {
      const double inset = 0.9 * row[1] + std::max(0.0, row[0] - 0.4);  // roots lie further in
      const double inside = inset - row[1] * out;  // where the neighbours come closer
      return arch.point(angle, row[0] * height, inset) + row[1] * out * outwards +
             row[2] * half * (1 - inside * arch.curvature(angle)) * side * along;
    };
    // Down to the bone.
    double height = incisor ? (arch.upper ? 10.5 : 9) : canine ? 10.5 : molar ? 7 : 8;
    const auto clear = [&] {
      for (double out : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
        for (double side : {-1.0, 0.0, 1.0}) {
          if (bone.signedDistance(at(rows[0], height, out, side)) < kGap) return false;
        }
      }
      return true;
    };
    while (height > 2 && !clear()) height -= 0.1;
    std::vector<Ring> rings;
    for (const auto& row : rows) {
      Ring ring;
      for (int k = 0; k < kSides; k++) {
        const double turn = 2 * EIGEN_PI * (k + 0.5) / kSides;
        const auto boxy = [](double x) { return std::copysign(std::pow(std::abs(x), 0.75), x); };
        ring.push_back(at(row, height, boxy(std::sin(turn)), boxy(std::cos(turn))));
      }
      rings.push_back(ring);
    }
    TriMesh crown = loft(rings);
    if (volume(crown) < 0) {
      for (auto& f : crown.faces) std::swap(f[1], f[2]);
    }
    append(mesh, crown);
    append(mesh, mirrored(crown));
    angle += half / arch.speed(angle);
  }
  return mesh;
}

TriMesh mandibleMesh() {
  Blend s;
  // Body, round from angle to angle.
  std::vector<Section> body = {{{24, 46, -63}, 4, 9},      {{34, 43.5, -69}, 5, 11},
                               {{48, 37.5, -73}, 5.2, 12}, {{62, 30.5, -76.5}, 5, 13},
                               {{74, 21, -78.5}, 5, 14},   {{81.5, 10, -79}, 5.2, 15}};
  const std::size_t n = body.size();
  body.push_back({{84, 0, -79}, 5.4, 15.5});
  for (std::size_t i = n; i-- > 0;) {
    body.push_back(body[i]);
    body.back().centre.y() *= -1;
  }
  s.unite(bar(body, Vector3d::UnitZ(), 2.5), 0);
  // Bone of the teeth's roots.
  std::vector<Section> ridge;
  for (int k = -6; k <= 6; k++) {
    ridge.push_back({lowerArch().point(k / 6.0 * lowerArch().lastAngle(), 14, 4), 4.6, 5.5});
  }
  s.unite(bar(ridge, Vector3d::UnitZ(), 4), 5);
  // Ramus: a plate with the neck of the joint's head, the notch and the coronoid process above, and
  // the angle below; turned so that it spreads upwards and to the rear.
  Sheet ramus;
  ramus.frame = Isometry3d::Identity();
  ramus.frame.linear().col(0) = Vector3d::UnitX();
  ramus.frame.linear().col(1) = Vector3d::UnitZ();
  ramus.frame.linear().col(2) = -Vector3d::UnitY();
  ramus.outline = smoothOutline({{8.5, -9},
                                 {7, -22},
                                 {8, -38},
                                 {11, -54},
                                 {17, -67},
                                 {28, -75},
                                 {44, -80},
                                 {56, -78},
                                 {52, -62},
                                 {46, -52},
                                 {42, -38},
                                 {40, -22},
                                 {37.5, -9},
                                 {33, -9.5},
                                 {29, -17},
                                 {23.5, -20},
                                 {18, -16},
                                 {14.5, -9}});
  ramus.middle = [](double x, double z) {
    return -(45.5 + 0.085 * (z + 66) - 0.12 * std::max(0.0, x - 26) * std::max(0.0, -z - 20) / 40);
  };
  ramus.half_thickness = [](double x, double z, double) {
    const double low = std::clamp((-z - 45) / 25, 0.0, 1.0);
    return 2.6 + 1.2 * low + (x < 16 && z > -30 ? 0.6 : 0.0);
  };
  ramus.max_height = 60;
  ramus.max_half_thickness = 5;
  s.unitePair(sheetSolid(ramus), 8);
  s.unitePair(ellipsoidSolid({10.5, 51, -6.8}, {4.2, 9.5, 5},
                             Eigen::AngleAxisd(-0.2, Vector3d::UnitZ()).toRotationMatrix()),
              4);
  s.unitePair(bar({{{11.5, 51, -9}, 3.2, 3.6}, {{12, 50, -20}, 2.4, 2.6}}), 6);
  // Oblique line, chin.
  s.unitePair(bar({{{41, 46, -38}, 2.4, 3}, {{48, 43.5, -55}, 2.2, 3}, {{60, 35, -67}, 1.5, 2}}),
              5);
  s.unite(ellipsoidSolid({86, 0, -88}, {5.5, 9, 6.5}), 7);
  s.unitePair(ellipsoidSolid({83, 11, -92}, {5, 6, 3.5}), 6);
  s.carvePair(ellipsoidSolid({70, 33.5, -76}, {2.2, 4, 1.6}), 1.5);  // mental foramen
  s.carvePair(ellipsoidSolid({30, 40.3, -58}, {9, 3.2, 9}), 4);      // inside of the angle
  return surface(s, 1.2, 2300, true, Finish::kEven);
}

}  // namespace torso
