// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "model/bone_parts.h"
#include "model/fuse.h"

namespace torso {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// Axes of a limb segment from its proximal to its distal joint: z back along it, x forward, y left.
struct LimbFrame {
  LimbFrame(const Vector3d& proximal, const Vector3d& distal) : origin(proximal) {
    length = (distal - proximal).norm();
    const Vector3d z = (proximal - distal) / length;
    const Vector3d y = (Vector3d::UnitY() - z.y() * z).normalized();
    axes << y.cross(z), y, z;
  }
  // x and y in millimetres; `along` is the share of the way from the proximal joint, z added [mm].
  Vector3d at(double x, double y, double along, double z = 0) const {
    return origin + axes * (pointMm(x, y, z) - Vector3d(0, 0, along * length));
  }
  Section section(double x, double y, double along, double z, double side, double up) const {
    return {at(x, y, along, z), side * 1e-3, up * 1e-3, Vector3d::Zero()};
  }
  Vector3d origin;
  double length;
  Matrix3d axes;
};

// Sections of a shaft are wide in y (side) and deep in x (up).
TubeStyle shaftStyle(double cap = 0.7) {
  TubeStyle style;
  style.up = Vector3d::UnitX();
  style.cap = cap;
  return style;
}

// Small long bone: base, waist and head with the given radii [mm].
TriMesh smallBone(const Vector3d& a, const Vector3d& b, double base, double waist, double head,
                  const Vector3d& up) {
  TubeStyle style;
  style.up = up;
  style.sides = 6;
  style.steps = 1;
  style.cap = 0.5;
  const Vector3d along = (b - a).normalized();
  const Vector3d from = a + 0.5e-3 * base * along, to = b - 0.5e-3 * head * along;
  return tube(
      {{from, base * 1e-3, base * 0.92e-3},
       {0.75 * from + 0.25 * to, 0.6e-3 * (base + waist) / 1.2, 0.55e-3 * (base + waist) / 1.2},
       {0.45 * from + 0.55 * to, waist * 1e-3, waist * 1e-3},
       {to, head * 1e-3, head * 0.92e-3}},
      style);
}

}  // namespace

TriMesh humerusMesh(const Anatomy& anatomy) {
  const LimbFrame f(anatomy.landmark("glenohumeral_centre_GH"), anatomy.landmark("elbow"));
  TriMesh mesh;
  // Shaft and neck; below it flattens and widens to the epicondyles.
  append(mesh, tube({f.section(1, 4, 0, -4, 17, 16), f.section(0, 7, 0.08, 0, 15, 14.5),
                     f.section(-1, 5, 0.17, 0, 12, 12), f.section(-1, 3, 0.3, 0, 11, 11.5),
                     f.section(0, 1, 0.5, 0, 10.5, 11), f.section(1, 0, 0.7, 0, 11, 9.5),
                     f.section(1, 0, 0.84, 0, 15, 8.5), f.section(0, 0, 0.93, 0, 22, 8),
                     f.section(-1, -1, 0.97, 0, 25, 7.5)},
                    shaftStyle()));
  append(mesh, ellipsoid(f.at(0, 0, 0), pointMm(23, 23, 23), Matrix3d::Identity(), 20));
  // Greater and lesser tubercle, deltoid tuberosity.
  append(mesh, ellipsoid(f.at(-3, 17, 0, -4), pointMm(15, 10, 18), Matrix3d::Identity(), 20));
  append(mesh, ellipsoid(f.at(18, 8, 0, -9), pointMm(7, 7, 11), Matrix3d::Identity(), 20));
  append(mesh, tube({f.section(2, 9, 0.38, 0, 4, 5), f.section(2, 9.5, 0.45, 0, 4.5, 5.5),
                     f.section(2, 8, 0.53, 0, 3, 4)},
                    shaftStyle()));
  // Trochlea (a spool) and capitulum (a ball) on the axis of the elbow; epicondyles.
  TubeStyle roll;
  roll.up = Vector3d::UnitZ();
  roll.cap = 0.2;
  append(mesh, tube({f.section(0, -20, 1, 0, 12.5, 12.5), f.section(0, -10, 1, 0, 8.5, 8.5),
                     f.section(0, -1, 1, 0, 10.5, 10.5)},
                    roll));
  append(mesh, ellipsoid(f.at(2, 11, 1), pointMm(11, 10.5, 11), Matrix3d::Identity(), 20));
  append(mesh, ellipsoid(f.at(-3, -26, 1, 6), pointMm(7, 7, 9), Matrix3d::Identity(), 20));
  append(mesh, ellipsoid(f.at(-1, 22, 1, 8), pointMm(6, 6, 9), Matrix3d::Identity(), 20));
  return fuse(mesh, {1.6_mm, 6_mm, 550, 2, false});
}

TriMesh forearmMesh(const Anatomy& anatomy) {
  // The thumb points forward: at the elbow the radius lies to the side, at the wrist in front.
  const LimbFrame f(anatomy.landmark("elbow"), anatomy.landmark("wrist"));
  TubeStyle upright;
  TriMesh ulna, radius;
  // Ulna: olecranon behind the elbow, coronoid process below it, shaft, small head and styloid.
  append(ulna, tube({f.section(-17, -8, 0, 9, 10, 7), f.section(-20, -8, 0, -4, 10, 6.5),
                     f.section(-16, -8, 0.08, 0, 9, 8.5), f.section(-11, -7, 0.16, 0, 7.5, 8.5),
                     f.section(-12, -3, 0.35, 0, 6.5, 7.5), f.section(-15, 0, 0.6, 0, 6, 6.5),
                     f.section(-18, 0, 0.82, 0, 5.5, 5.5), f.section(-19, 0, 0.94, 0, 7.5, 7.5),
                     f.section(-19, 0, 0.965, 0, 7.5, 7.5)},
                    shaftStyle()));
  append(ulna, tube({f.section(-12, -8, 0.085, 0, 9, 6), f.section(-2, -8, 0.075, 0, 9, 5),
                     f.section(6, -8, 0.06, 0, 7, 4)},
                    upright));
  append(ulna, smallBone(f.at(-23, 0, 0.95), f.at(-24, 0, 0.99), 3.2, 2.8, 2.2, Vector3d::UnitX()));
  // Radius: disc-shaped head, neck, tuberosity, bowed shaft, broad lower end.
  append(radius, tube({f.section(1, 13, 0.05, 0, 11, 11), f.section(1, 13, 0.085, 0, 10.5, 10.5)},
                      shaftStyle(0.15)));
  append(radius, tube({f.section(1, 13, 0.07, 0, 8, 8), f.section(1, 12, 0.13, 0, 6.5, 6.5),
                       f.section(3, 10, 0.19, 0, 7.5, 8), f.section(8, 11, 0.35, 0, 6, 7.5),
                       f.section(14, 9, 0.55, 0, 6, 8), f.section(15, 4, 0.78, 0, 7, 9),
                       f.section(11, 1, 0.91, 0, 9.5, 14), f.section(10, 0, 0.965, 0, 10, 15.5)},
                      shaftStyle()));
  append(radius, smallBone(f.at(21, 0, 0.94), f.at(24, 0, 1.0), 5.5, 4.8, 3.2, Vector3d::UnitX()));
  TriMesh mesh = fuse(ulna, {1.3_mm, 4_mm, 350, 2, false});
  append(mesh, fuse(radius, {1.3_mm, 4_mm, 350, 2, false}));
  return mesh;
}

TriMesh handMesh(const Anatomy& anatomy) {
  const Vector3d wrist = anatomy.landmark("wrist"), tip = anatomy.landmark("hand_tip");
  // Distance from the wrist along the hand, to the thumb's side and to the palm [mm]; the palm is
  // medial, the thumb in front.
  const Vector3d along = (tip - wrist).normalized();
  const Vector3d thumb = (Vector3d::UnitX() - along.x() * along).normalized();
  const Vector3d palm =
      thumb.cross(along).y() < 0 ? Vector3d(thumb.cross(along)) : Vector3d(along.cross(thumb));
  const double scale = (tip - wrist).norm() / 185_mm;  // the numbers below are for a hand of 185 mm
  const auto at = [&](double d, double r, double p) -> Vector3d {
    return wrist + scale * (d * along + r * thumb + p * palm) * 1e-3;
  };
  TriMesh mesh;
  Matrix3d axes;
  axes << thumb, palm, thumb.cross(palm);
  // Carpal bones: centre and half axes to the thumb, to the palm, along.
  const double carpals[][6] = {{10, 11, 0, 8, 7, 7},     {7, 0, 0, 6.5, 8, 6.5},
                               {9, -10, 0, 6.5, 6.5, 6}, {9, -13, 8, 4.5, 4, 5},
                               {20, 17, 3, 6.5, 6, 6},   {22, 9, 0, 5.5, 7, 6},
                               {21, 0, 0, 6, 8, 9},      {22, -10, 1, 6.5, 8, 7}};
  for (const auto& c : carpals) {
    append(mesh, ellipsoid(at(c[0], c[1], c[2]), scale * pointMm(c[3], c[4], c[5]), axes, 6, 2.4));
  }
  // Rays: base of the metacarpal, its head, then the ends of the phalanges (d, r, p), slightly
  // flexed; girth of the metacarpal.
  struct Finger {
    double girth;
    std::vector<Vector3d> ends;
  };
  const Finger fingers[] = {
      {5.2, {{25, 20, 6}, {62, 40, 14}, {91, 50, 16}, {114, 56, 16}}},
      {4.6, {{28, 11, 0}, {92, 20, 0}, {132, 24, 5}, {154, 25, 9}, {171, 25, 12}}},
      {4.6, {{29, 1, 0}, {93, 4, -1}, {137, 4, 4}, {164, 3, 4}, {185, 0, 0}}},
      {4.1, {{28, -7, 0}, {87, -10, 0}, {128, -13, 6}, {153, -14, 10}, {172, -14, 13}}},
      {3.9, {{26, -13, 1}, {78, -22, 2}, {110, -28, 8}, {128, -30, 12}, {145, -31, 15}}}};
  for (const Finger& finger : fingers) {
    double girth = finger.girth;
    for (size_t k = 0; k + 1 < finger.ends.size(); k++) {
      const auto point = [&](const Vector3d& e) { return at(e.x(), e.y(), e.z()); };
      const bool last = k + 2 == finger.ends.size();
      append(mesh,
             smallBone(point(finger.ends[k]), point(finger.ends[k + 1]), girth * 1.25, girth * 0.75,
                       girth * (k == 0 ? 1.2
                                : last ? 0.8
                                       : 1.0),
                       palm));
      girth *= k == 0 ? 0.95 : 0.85;
    }
  }
  return mesh;
}

TriMesh femurMesh(const Anatomy& anatomy) {
  const LimbFrame f(anatomy.landmark("hip_joint_centre"), anatomy.landmark("knee"));
  TriMesh mesh;
  append(mesh, ellipsoid(f.origin, pointMm(23, 23, 23), Matrix3d::Identity(), 20));
  TubeStyle style;
  // Neck, to the side and down.
  append(mesh, tube({f.section(0, 6, 0, -4, 17, 16), f.section(-3, 22, 0, -14, 12.5, 15.5),
                     f.section(-7, 42, 0, -30, 14, 20)},
                    style));
  // Shaft, bowed forward; wide at the knee.
  append(mesh, tube({f.section(-9, 50, 0, -22, 13, 14), f.section(-8, 48, 0, -45, 17, 16),
                     f.section(-6, 44, 0.19, 0, 15, 15), f.section(4, 37, 0.35, 0, 13.5, 14.5),
                     f.section(8, 29, 0.52, 0, 13.5, 14.5), f.section(6, 19, 0.70, 0, 15, 15),
                     f.section(1, 9, 0.84, 0, 21, 17), f.section(-1, 3, 0.93, 0, 33, 20),
                     f.section(-1, 1, 0.98, 0, 37, 20)},
                    shaftStyle()));
  // Greater and lesser trochanter.
  append(mesh, tube({f.section(-13, 58, 0, -48, 11, 13), f.section(-12, 57, 0, -24, 11, 15),
                     f.section(-17, 52, 0, -3, 7, 10)},
                    shaftStyle()));
  append(mesh, ellipsoid(f.at(-19, 36, 0, -60), pointMm(9, 9, 12), Matrix3d::Identity(), 20));
  // Linea aspera.
  append(mesh, tube({f.section(-16, 44, 0.22, 0, 4, 5), f.section(-6.5, 35, 0.4, 0, 4, 5.5),
                     f.section(-4.5, 27, 0.58, 0, 4, 5), f.section(-8, 17, 0.74, 0, 4, 4)},
                    shaftStyle()));
  // Condyles: rolls that reach back and down; the groove for the patella between them in front.
  TubeStyle roll;
  roll.squareness = 2.2;
  roll.cap = 0.5;
  for (double side : {-1.0, 1.0}) {
    const double y = 23 * side;
    append(mesh,
           tube({f.section(-8, y + 14 * side, 1, -1, 20, 18), f.section(-9, y, 1, -1, 24, 22.5),
                 f.section(-7, y - 12 * side, 1, 0, 21, 19)},
                roll));
    append(mesh,
           ellipsoid(f.at(14, y - 4 * side, 1, 4), pointMm(17, 16, 24), Matrix3d::Identity(), 20));
    append(mesh,
           ellipsoid(f.at(-3, y + 16 * side, 1, 6), pointMm(10, 6, 10), Matrix3d::Identity(), 20));
  }
  return fuse(mesh, {1.8_mm, 8_mm, 750, 2, false});
}

TriMesh shinMesh(const Anatomy& anatomy) {
  const LimbFrame f(anatomy.landmark("knee"), anatomy.landmark("ankle"));
  TriMesh tibia;
  TubeStyle slender = shaftStyle();
  slender.sides = 9;
  slender.steps = 1;
  TubeStyle plateau = shaftStyle(0.15);
  plateau.squareness = 2.5;
  // Tibia: plateau, shaft with a front edge, medial malleolus.
  append(tibia, tube({f.section(-3, 0, 0, -28, 37, 23), f.section(-4, 0, 0, -40, 36, 22),
                      f.section(-3, 0, 0.16, 0, 26, 19), f.section(2, -4, 0.26, 0, 16, 17),
                      f.section(1, -7, 0.45, 0, 12.5, 15), f.section(0, -7, 0.65, 0, 11.5, 13),
                      f.section(0, -5, 0.82, 0, 13.5, 13), f.section(0, -4, 0.92, 0, 19, 16),
                      f.section(0, -3, 0.955, 0, 22, 17)},
                     plateau));
  append(tibia, tube({f.section(0, -20, 0.93, 0, 8, 14), f.section(2, -25, 0.975, 0, 6, 12),
                      f.section(2, -25, 1.015, 0, 4.5, 8)},
                     shaftStyle()));
  append(tibia, tube({f.section(16, 0, 0.1, 0, 9, 8), f.section(20, 0, 0.14, 0, 9, 7),
                      f.section(15, -2, 0.2, 0, 6, 6)},
                     shaftStyle()));  // tuberosity
  append(tibia, tube({f.section(14, -3, 0.2, 0, 4, 6), f.section(13, -8, 0.4, 0, 3.5, 6),
                      f.section(10, -9, 0.6, 0, 3, 5)},
                     shaftStyle()));  // front edge
  append(tibia, ellipsoid(f.at(-3, 0, 0, -27), pointMm(9, 6, 6), Matrix3d::Identity(), 20));
  TriMesh mesh = fuse(tibia, {1.7_mm, 6_mm, 550, 2, false});
  // Fibula, behind and to the side; its malleolus reaches lower.
  append(mesh, tube({f.section(-13, 37, 0, -44, 10, 11), f.section(-13, 37, 0, -56, 9, 10),
                     f.section(-13, 35, 0.22, 0, 6, 6.5), f.section(-12, 33, 0.45, 0, 6, 7),
                     f.section(-10, 31, 0.7, 0, 5.5, 7), f.section(-7, 29, 0.88, 0, 7, 9),
                     f.section(-6, 28, 0.96, 0, 8, 12), f.section(-7, 27, 1.045, 0, 5, 8)},
                    slender));
  // Patella.
  append(mesh, ellipsoid(f.at(44, 1, 0, 6), pointMm(9.5, 21, 21),
                         AngleAxisd(-0.12, Vector3d::UnitY()).toRotationMatrix(), 14, 2.2));
  return mesh;
}

TriMesh footMesh(const Anatomy& anatomy) {
  const Vector3d heel = anatomy.landmark("heel"), toe = anatomy.landmark("toe_tip");
  const Vector3d sole = anatomy.landmark("sole");
  // Forward from the heel, to the side (the little toe's) and up from the sole [mm].
  Vector3d forward = toe - heel;
  forward.z() = 0;
  const double scale = forward.norm() / 248.6_mm;
  forward.normalize();
  const Vector3d lateral = Vector3d::UnitZ().cross(forward);
  Matrix3d axes;
  axes << forward, lateral, Vector3d::UnitZ();
  const Vector3d origin(heel.x(), heel.y(), sole.z());
  const auto at = [&](double x, double y, double z) -> Vector3d {
    return origin + scale * x * 1e-3 * forward + scale * y * 1e-3 * lateral + pointMm(0, 0, z);
  };
  const auto section = [&](double x, double y, double z, double side, double up) {
    return Section{at(x, y, z), side * 1e-3, up * 1e-3, Vector3d::Zero()};
  };
  TubeStyle style;
  style.sides = 10;
  style.steps = 1;
  style.squareness = 2.4;
  style.cap = 0.5;
  TriMesh mesh;
  // Calcaneus: stands on its tuber.
  append(mesh,
         tube({section(7, -1, 23, 13, 17), section(20, -1, 24, 15, 23.8),
               section(42, 1, 32, 13, 19), section(64, 3, 35, 17, 16), section(84, 7, 33, 13, 14)},
              style));
  // Talus: body with the trochlea, neck and head.
  style.squareness = 2;
  append(mesh, ellipsoid(at(59, 0, 68), pointMm(21, 15.5, 16.5), axes, 10, 2.4));
  append(mesh, tube({section(64, -2, 62, 13, 12), section(82, -6, 55, 10, 10),
                     section(93, -8, 51, 12, 11)},
                    style));
  const double tarsals[][6] = {// centre, half axes
                               {103, -10, 49, 6.5, 16, 12},
                               {103, 15, 31, 18, 12, 12.5},
                               {118, -22, 41, 11.5, 8.5, 14},
                               {117, -8, 47, 9, 8, 12},
                               {118, 4, 43, 11, 8, 12}};
  for (const auto& t : tarsals) {
    append(mesh, ellipsoid(at(t[0], t[1], t[2]), pointMm(t[3], t[4], t[5]), axes, 8, 2.5));
  }
  // Rays from the great toe: base and head of the metatarsal, ends of the phalanges; girth.
  struct Ray {
    double girth;
    std::vector<Vector3d> ends;
  };
  const Ray rays[] = {
      {8.2, {{127, -25, 36}, {186, -29, 17}, {218, -24, 12}, {244, -20, 10}}},
      {5.2, {{125, -9, 47}, {197, -8, 15}, {223, -6, 16}, {235, -5, 11}, {246, -4, 7}}},
      {5.0, {{126, 4, 42}, {194, 7, 14}, {217, 9, 15}, {227, 10, 10}, {238, 10, 6}}},
      {5.0, {{119, 16, 35}, {185, 21, 13}, {206, 23, 13}, {215, 24, 9}, {225, 24, 6}}},
      {5.4, {{112, 27, 26}, {172, 34, 12}, {191, 36, 11}, {199, 37, 8}, {208, 37, 6}}}};
  for (const Ray& ray : rays) {
    double girth = ray.girth;
    for (size_t k = 0; k + 1 < ray.ends.size(); k++) {
      const Vector3d &a = ray.ends[k], &b = ray.ends[k + 1];
      append(mesh, smallBone(at(a.x(), a.y(), a.z()), at(b.x(), b.y(), b.z()), girth * 1.3,
                             girth * 0.8, girth * 1.1, Vector3d::UnitZ()));
      girth *= k == 0 ? 0.95 : 0.8;
    }
  }
  append(mesh, ellipsoid(at(104, 31, 22), pointMm(9, 5, 5), axes, 8));  // tuber of the fifth
  return mesh;
}

}  // namespace torso
