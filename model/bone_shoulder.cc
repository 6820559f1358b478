// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "model/bone_parts.h"
#include "model/sheet.h"
#include "model/surface.h"

namespace torso {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

double smoothStep(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

// Distance from a line segment.
double beside(const Vector2d& a, const Vector2d& b, double x, double y) {
  const Vector2d p(x, y);
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - t * (b - a)).norm();
}

// The scapula in axes of its own: origin at TS, u towards the glenoid's middle, v up in the plane
// of TS, glenoid and AI, n out of the costal face. Millimetres in a body of the tables' size, where
// the glenoid lies at (101, 0, 0), AI at (-10, -102, 0), AA at (121, 18, -36), AC at (130, 36, 4).
// Solid after general anatomy.
class Scapula {
 public:
  explicit Scapula(const Anatomy& anatomy) {
    constexpr double kJointDistance = 127;  // TS to GH
    const Vector3d ts = anatomy.landmark("scapula_root_of_spine_TS");
    const Vector3d ai = anatomy.landmark("scapula_inferior_angle_AI");
    const Vector3d gh = anatomy.landmark("glenohumeral_centre_GH");
    scale_ = (gh - ts).norm() / kJointDistance;
    const Vector3d glenoid =
        gh - 26 * scale_ * (gh - ts + 6 * scale_ * Vector3d::UnitZ()).normalized();
    const Vector3d u = (glenoid - ts).normalized();
    const Vector3d n = u.cross(ts - ai).normalized();
    frame_.linear() << u, n.cross(u), n;
    frame_.translation() = ts;
    joint_ = frame_.inverse() * gh / scale_;
  }

  TriMesh build() const {
    Blend s;
    s.unite(blade(), 0);
    s.unite(spine(), 4);
    addGlenoid(s);
    s.unite(acromion(), 5);
    addCoracoid(s);
    constexpr double kSocket = 25.5;  // a little wider than the head of the humerus
    s.carve(ellipsoidSolid(joint_, Vector3d::Constant(kSocket)), 2);
    TriMesh mesh = surface(s, 1, 3000, false, Finish::kEven);
    for (Vector3d& v : mesh.vertices) v = frame_ * Vector3d(scale_ * v);
    return mesh;
  }

 private:
  static Solid blade() {
    Sheet sheet;
    sheet.frame = Isometry3d::Identity();
    sheet.outline = smoothOutline(
        {// lateral border, from the inferior angle up to the glenoid
         {-6, -105.5},
         {2, -105},
         {10, -99},
         {22, -88},
         {40, -70},
         {60, -50},
         {78, -33},
         {90, -22},
         {97, -16},
         // glenoid
         {99, 0},
         {95, 18},
         // superior border with its notch beside the coracoid
         {86, 27},
         {77, 28},
         {72.5, 24.5},
         {69.5, 23.5},
         {66, 29},
         {55, 36},
         {42, 43},
         {32, 49},
         {25, 51.5},
         {20, 48},
         // medial border
         {13, 36},
         {5, 18},
         {-0.5, 2},
         {-4.5, -15},
         {-8.5, -42},
         {-11, -72},
         {-11, -94},
         {-10, -102}},
        4);
    sheet.middle = [](double u, double v) {
      // Hollow towards the ribs; above the spine the blade leans forward.
      const double across = std::max(0.0, 1 - std::pow((u - 42) / 60, 2));
      const double low = smoothStep(-105, -60, v);
      return -7.0 * across * (0.35 + 0.65 * low) +
             0.30 * 6 * std::log1p(std::exp((v - 8) / 6)) * (1 - u / 140) +
             0.0008 * std::pow(std::min(0.0, v + 60), 2);
    };
    sheet.half_thickness = [](double u, double v, double inset) {
      double t = 1.25 + 1.0 * std::exp(-inset / 2.5);
      // Bar along the lateral border, from the glenoid down.
      const double bar = beside({92, -20}, {6, -98}, u, v);
      t += (1.0 + 2.6 * smoothStep(-100, -30, v)) * std::exp(-std::pow(bar / 6.5, 2));
      t += 4.0 * smoothStep(66, 98, u) * (1 - smoothStep(10, 30, std::abs(v)));  // neck
      return t + 1.2 * std::exp(-std::pow(std::hypot(u + 4, v + 100) / 9, 2));
    };
    sheet.max_height = 20;
    sheet.max_half_thickness = 11;
    return sheetSolid(sheet);
  }

  // A plate off the back of the blade, higher towards the acromion, with a thick crest. x along u,
  // y away from the blade, z along v.
  static Solid spine() {
    Sheet sheet;
    sheet.frame = Isometry3d::Identity();
    sheet.frame.linear() << Vector3d::UnitX(), -Vector3d::UnitZ(), Vector3d::UnitY();
    sheet.outline = smoothOutline({{86, 5},
                                   {87, 11},
                                   {90, 18},
                                   {97, 25},
                                   {108, 30},
                                   {120, 32},
                                   {122, 37},
                                   {112, 38.5},
                                   {92, 35},
                                   {72, 29.5},
                                   {50, 23},
                                   {30, 16.5},
                                   {14, 9},
                                   {3, 4},
                                   {1, 1},
                                   {20, 6},
                                   {40, 9},
                                   {64, 9}},
                                  4);
    sheet.middle = [](double u, double h) { return 0.1 * u + 0.18 * h; };
    sheet.half_thickness = [](double u, double h, double inset) {
      const double crest = beside({3, 3}, {50, 23}, u, h), far = beside({50, 23}, {120, 38}, u, h);
      return 1.5 + 1.0 * std::exp(-inset / 3) +
             2.2 * std::exp(-std::pow(std::min(crest, far) / 4.5, 2)) +
             1.3 * std::exp(-std::pow(std::hypot(u - 30, h - 15) / 9, 2));
    };
    sheet.max_height = 22;
    sheet.max_half_thickness = 6.5;
    return sheetSolid(sheet);
  }

  // From the spine around the angle AA forward over the joint; ends beside the clavicle. x along u,
  // y along n, z down.
  static Solid acromion() {
    Sheet sheet;
    sheet.frame = Isometry3d::Identity();
    sheet.frame.linear() << Vector3d::UnitX(), Vector3d::UnitZ(), -Vector3d::UnitY();
    sheet.outline = smoothOutline({{100, -38},
                                   {112, -39},
                                   {121, -37},
                                   {131, -29},
                                   {139, -16},
                                   {144, -3},
                                   {145.5, 7},
                                   {142, 11.5},
                                   {138.5, 10},
                                   {135.5, 5},
                                   {130, 2},
                                   {124, -1},
                                   {118, -8},
                                   {112, -18},
                                   {104, -28},
                                   {97, -33}},
                                  4);
    sheet.middle = [](double u, double n) {
      return -(18 + 0.42 * (n + 36) - 0.004 * std::pow(n + 16, 2) + 1.6 -
               0.006 * std::pow(std::max(0.0, u - 128), 2));
    };
    sheet.half_thickness = [](double, double n, double) { return 4.2 - 0.02 * (n + 36); };
    sheet.max_height = 45;
    sheet.max_half_thickness = 5;
    return sheetSolid(sheet);
  }

  static void addGlenoid(Blend& s) {
    // Neck, and a pear wider below, with the tubercles of biceps and triceps above and below it.
    s.unite(bar({{{74, -2, -2}, 10, 3}, {{85, -1, -1}, 12, 5}, {{95, -1, 0}, 14, 8.5}},
                Vector3d::UnitZ()),
            10);
    s.unite(bar({{{98.5, -7.5, 0}, 6, 12.5}, {{98.5, 3, 0}, 6, 11}, {{98.5, 13, 0}, 5.5, 7.5}},
                Vector3d::UnitZ(), 2.3),
            3);
    s.unite(ellipsoidSolid({95, 19, 1}, {5, 4, 4}), 4);
    s.unite(ellipsoidSolid({92, -21.5, 0}, {6, 5, 3.5}), 5);
  }

  // Up and forward from the neck, then a hook to the side.
  static void addCoracoid(Blend& s) {
    s.unite(bar({{{83, 16, 2}, 8, 6},
                 {{84, 26, 7}, 7.5, 6},
                 {{88, 33, 15}, 7, 5.5},
                 {{96, 33, 26}, 6.5, 5},
                 {{105, 27.5, 35}, 6, 4.8},
                 {{112, 21, 40}, 4.6, 4.2}},
                Vector3d(0.3, 0.7, -0.3)),
            6);
  }

  Isometry3d frame_ = Isometry3d::Identity();
  double scale_;  // [m] of one of these millimetres
  Vector3d joint_;
};

}  // namespace

TriMesh clavicleMesh(const Anatomy& anatomy) {
  const Vector3d sc = anatomy.landmark("sternoclavicular_joint_SC");
  const Vector3d ac = anatomy.landmark("acromioclavicular_joint_AC");
  const Vector3d along = ac - sc;
  const Vector3d front = along.normalized().cross(Vector3d::UnitZ()).normalized();
  // The medial part convex to the front, the lateral third concave: an S seen from above. Share of
  // the length, offset to the front and up, half axes across and up [mm].
  constexpr double kStations[][5] = {
      {0.024, 1, 4, 8, 8.2},     {0.055, 3, 4.8, 8.8, 8.8}, {0.12, 6, 5, 7.6, 7.8},
      {0.20, 9, 4.6, 6.5, 6.8},  {0.30, 10.5, 4, 6, 6.2},   {0.42, 9, 3, 5.8, 5.8},
      {0.54, 4.5, 3, 6, 5.4},    {0.65, -1, 2.5, 6.8, 5.3}, {0.74, -5.5, 2, 8.2, 5.2},
      {0.83, -7, 1.8, 9.2, 4.9}, {0.91, -5, 1.2, 9, 4.7},   {0.982, -1.5, 0.3, 7.2, 4.4}};
  std::vector<Section> sections;
  const double mm = 1e-3 * anatomy.length_scale;
  for (const auto& s : kStations) {
    sections.push_back(
        {sc + s[0] * along + mm * (s[1] * front + s[2] * Vector3d::UnitZ()), s[3] * mm, s[4] * mm});
  }
  TubeStyle style;
  style.sides = 14;
  style.steps = 3;
  style.cap = 0.3;
  style.squareness = 2.2;
  TriMesh mesh = tube(sections, style);
  return mesh;
}

TriMesh scapulaMesh(const Anatomy& anatomy) { return Scapula(anatomy).build(); }

}  // namespace torso
