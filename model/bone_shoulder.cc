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
         {11, -98},
         {20, -86},  // where teres major springs
         {31, -75},
         {48, -60},
         {63, -45},
         {76, -32},
         {87, -24},
         {95, -18},
         // glenoid
         {98, 0},
         {94, 17},
         // superior border with its notch beside the coracoid
         {86, 27},
         {77, 28},
         {72.5, 23.5},
         {69.0, 22.5},
         {65, 28},
         {55, 35},
         {42, 42},
         {32, 48},
         {24, 51},
         {18, 48},
         // medial border, convex, bent at the root of the spine
         {11, 36},
         {3.5, 18},
         {-1.5, 2},
         {-6, -15},
         {-10.5, -42},
         {-12.5, -72},
         {-12, -94},
         {-10.5, -102}},
        4);
    sheet.middle = [](double u, double v) {
      // Hollow towards the ribs, most of all beside the lateral bar; above the spine the blade
      // leans forward, and so does the inferior angle.
      const double across = std::max(0.0, 1 - std::pow((u - 44) / 56, 2));
      const double low = smoothStep(-105, -45, v);
      return -8.5 * across * (0.25 + 0.75 * low) +
             0.42 * 6 * std::log1p(std::exp((v - 8) / 6)) * (1 - u / 130) +
             0.0014 * std::pow(std::min(0.0, v + 55), 2);
    };
    sheet.half_thickness = [](double u, double v, double inset) {
      double t = 1.25 + 1.3 * std::exp(-inset / 2.2);
      // Bar along the lateral border, from the glenoid down.
      const double bar =
          std::min({beside({90, -20}, {58, -44}, u, v), beside({58, -44}, {26, -73}, u, v),
                    beside({26, -73}, {4, -99}, u, v)});
      t += (2.4 + 3.6 * smoothStep(-100, -25, v)) * std::exp(-std::pow(bar / 5.8, 2));
      t += 4.0 * smoothStep(66, 98, u) * (1 - smoothStep(10, 30, std::abs(v)));  // neck
      // Ridges of subscapularis' tendons, from the medial border towards the neck.
      for (double from : {-20.0, -45.0, -70.0}) {
        const double ridge = beside({-6, from}, {52, -10 + 0.55 * (from + 10)}, u, v);
        t += 0.55 * std::exp(-std::pow(ridge / 2.8, 2));
      }
      return t + 1.6 * std::exp(-std::pow(std::hypot(u + 4, v + 99) / 9, 2)) +
             0.9 * std::exp(-std::pow(std::hypot(u - 22, v - 47) / 8, 2));
    };
    sheet.max_height = 24;
    sheet.max_half_thickness = 12;
    return sheetSolid(sheet);
  }

  // A plate off the back of the blade that begins with a flat triangle at the medial border and
  // rises steadily towards the acromion; its crest is thick, with the tubercle of trapezius, and
  // droops over the infraspinous fossa. x along u, y away from the blade, z along v.
  static Solid spine() {
    Sheet sheet;
    sheet.frame = Isometry3d::Identity();
    sheet.frame.linear() << Vector3d::UnitX(), -Vector3d::UnitZ(), Vector3d::UnitY();
    sheet.outline = smoothOutline({{86, 5},
                                   {84, 10},
                                   {88, 18},
                                   {95, 25},
                                   {106, 30},
                                   {119, 33},
                                   {121, 40},
                                   {110, 42.5},
                                   {92, 40},
                                   {72, 35},
                                   {52, 28.5},
                                   {36, 22},
                                   {20, 13.5},
                                   {8, 7},
                                   {-1, 3.5},
                                   {-2, 0},
                                   {20, 6},
                                   {40, 9},
                                   {64, 9}},
                                  4);
    // From TS it climbs towards the acromion; its free edge is turned up a little.
    sheet.middle = [](double u, double h) {
      return 0.10 * u + 0.10 * h -
             3.2 * std::exp(-std::pow((u - 30) / 22, 2)) * smoothStep(6, 22, h);
    };
    sheet.half_thickness = [](double u, double h, double inset) {
      const double crest =
          std::min({beside({-1, 2}, {36, 20.5}, u, h), beside({36, 20.5}, {72, 33}, u, h),
                    beside({72, 33}, {120, 40}, u, h)});
      return 1.5 + 0.9 * std::exp(-inset / 3) +
             (2.6 + 0.6 * smoothStep(70, 110, u)) * std::exp(-std::pow(crest / 4.2, 2)) +
             2.4 * std::exp(-std::pow(std::hypot(u - 34, h - 19) / 8, 2)) +  // trapezius
             2.6 * std::exp(-std::pow(std::hypot(u - 1, h - 3) / 9, 2));     // triangle of the root
    };
    sheet.max_height = 24;
    sheet.max_half_thickness = 10;
    return sheetSolid(sheet);
  }

  // From the spine around the angle AA forward over the joint; ends beside the clavicle. x along u,
  // y along n, z down.
  static Solid acromion() {
    Sheet sheet;
    sheet.frame = Isometry3d::Identity();
    sheet.frame.linear() << Vector3d::UnitX(), Vector3d::UnitZ(), -Vector3d::UnitY();
    sheet.outline = smoothOutline({{96, -41},
                                   {110, -43},
                                   {122, -40},
                                   {133, -31},
                                   {142, -18},
                                   {147, -4},
                                   {147, 7},
                                   {142, 11.5},
                                   {138.5, 10},
                                   {136, 5},
                                   {130.5, 1.5},
                                   {124, -2.5},
                                   {115, -12},
                                   {109, -22},
                                   {101, -30},
                                   {93, -34}},
                                  4);
    // Vaulted, as the head of the humerus is below.
    sheet.middle = [](double u, double n) {
      return -(18 + 0.42 * (n + 36) - 0.004 * std::pow(n + 16, 2) + 1.6 -
               0.010 * std::pow(std::max(0.0, u - 124), 2));
    };
    sheet.half_thickness = [](double u, double n, double inset) {
      const double facet = std::hypot(u - 133, n - 5) / 8;  // for the clavicle
      return 3.4 - 0.012 * (n + 36) + 1.0 * std::exp(-inset / 3.5) + 0.8 * std::exp(-facet * facet);
    };
    sheet.max_height = 45;
    sheet.max_half_thickness = 6;
    return sheetSolid(sheet);
  }

  static void addGlenoid(Blend& s) {
    // Neck, and a pear wider below with a raised rim, the tubercles of biceps and triceps above and
    // below it.
    s.unite(bar({{{70, -2, -2.5}, 10, 3}, {{80, -1, -1.5}, 11.5, 4.5}, {{90, -1, -0.5}, 12.5, 6.5}},
                Vector3d::UnitZ()),
            10);
    s.unite(
        bar({{{97.5, -8.5, 0}, 5.2, 13.6}, {{97.5, 1, 0}, 5.2, 12}, {{97.5, 13.5, 0.5}, 4.6, 7.6}},
            Vector3d::UnitZ(), 2.3),
        2.5);
    s.unite(ellipsoidSolid({93.5, 20, 1}, {4.5, 3.6, 3.6}), 3);
    s.unite(bar({{{92, -21.5, 0}, 5, 3.2}, {{84, -28, -1}, 3.6, 2.6}}), 4);
  }

  // Up and forward from the neck, flattened, then a hook to the side with a blunt tip.
  static void addCoracoid(Blend& s) {
    s.unite(bar({{{82, 14, 2}, 10, 6.5},
                 {{83, 25, 6}, 8.6, 6.2},
                 {{86, 31.5, 13}, 8, 5.4},
                 {{94, 33, 24}, 7.2, 4.8},
                 {{103, 29, 33}, 6.6, 4.6},
                 {{110, 23, 38}, 5.8, 4.6},
                 {{114, 19, 40}, 4.8, 4.2}},
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
  // The medial part convex to the front, the lateral third concave: an S seen from above. Bernat et
  // al. 2014, Clin Anat 27:712-723, found the ends of men's bones 24.7 (SD 2.8) and 25.9 (4.1) mm
  // broad at a length of 167 mm; these are shorter.
  // Share of the length, offset to the front and up, half axes across and up [mm].
  constexpr double kStations[][5] = {
      {0.024, 1, 4.6, 10.6, 8.2}, {0.055, 3, 5.4, 11.4, 8.8}, {0.12, 6, 5.4, 9.8, 8.4},
      {0.20, 9, 4.6, 7.6, 7.6},   {0.30, 10.5, 4, 6.5, 6.6},  {0.42, 9, 3, 6.1, 6.0},
      {0.54, 4.5, 3, 6.4, 5.7},   {0.65, -1, 2.5, 7.8, 5.7},  {0.74, -5.5, 2.2, 9.8, 5.7},
      {0.83, -7, 2.2, 11.4, 5.6}, {0.91, -5, 1.6, 10.6, 5.3}, {0.970, -1.5, 0.6, 7.6, 4.4}};
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
