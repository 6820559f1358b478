// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "model/bone_vertebra.h"
#include "model/surface.h"

namespace torso {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Shape assumed after general anatomy, about the table's S1 endplate and facets. Millimetres in the
// standing body, in this file, but for solids.

// Smooth table: linear between its rows, x ascending.
double table(const std::vector<Vector2d>& rows, double x) {
  std::size_t i = 1;
  while (i + 1 < rows.size() && x > rows[i].x()) i++;
  const Vector2d &a = rows[i - 1], &b = rows[i];
  const double t = std::clamp((x - a.x()) / (b.x() - a.x()), 0.0, 1.0), w = t * t * (3 - 2 * t);
  return (1 - w) * a.y() + w * b.y();
}

double bump(double x, double half_width) {
  const double u = x / half_width;
  return std::exp(-u * u);
}

// Coordinates along the pelvic surface: s along its mid-line from the promontory, depth behind it.
class PelvicCurve {
 public:
  PelvicCurve() {
    const std::vector<Vector3d> points = {{12.6, 0, -10.6}, {-8, 0, -30},    {-25.5, 0, -46},
                                          {-39, 0, -61},    {-48.5, 0, -77}, {-53, 0, -93},
                                          {-52.5, 0, -106}, {-48, 0, -118},  {-40, 0, -128}};
    constexpr int kSteps = 10;
    const int spans = static_cast<int>(points.size()) - 1;
    for (int k = 0; k <= spans * kSteps; k++) {
      line_.push_back(curveAt(points, static_cast<double>(k) / kSteps));
      s_.push_back(k == 0 ? 0 : s_.back() + (line_[k] - line_[k - 1]).norm());
    }
  }
  struct Place {
    double s, depth;
  };
  Place find(const Vector3d& p) const {
    const Vector3d q(p.x(), 0, p.z());
    double least = 1e9;
    Place out{0, 0};
    const std::size_t n = line_.size();
    for (std::size_t k = 0; k + 1 < n; k++) {
      const Vector3d e = line_[k + 1] - line_[k];
      double t = (q - line_[k]).dot(e) / e.squaredNorm();
      t = std::clamp(t, k == 0 ? -10.0 : 0.0, k + 2 == n ? 10.0 : 1.0);
      const Vector3d off = q - line_[k] - t * e;
      if (off.squaredNorm() >= least) continue;
      least = off.squaredNorm();
      // Behind is to the left of the way down: e turned towards the back.
      const double behind = (off.x() * e.z() - off.z() * e.x()) / e.norm();
      out = {s_[k] + t * e.norm(), behind};
    }
    return out;
  }
  // Standing body [m].
  Vector3d at(double s, double y, double depth) const {
    std::size_t k = 0;
    while (k + 2 < s_.size() && s_[k + 1] < s) k++;
    const Vector3d e = (line_[k + 1] - line_[k]).normalized();
    const Vector3d back(e.z(), 0, -e.x());
    return 1e-3 * (line_[k] + (s - s_[k]) * e + depth * back + Vector3d(0, y, 0));
  }

 private:
  std::vector<Vector3d> line_;
  std::vector<double> s_;
};

// Levels S1/S2 .. S4/S5: the ridges where the bodies have fused, and the foramina beside them.
constexpr double kFusion[] = {30, 53, 73, 91};
constexpr double kForamen[] = {19.5, 17.5, 15.5, 13.5};

// Fused bodies, laminae and lateral parts, without foramina.
double plateDistance(const PelvicCurve& curve, const Vector3d& p_m) {
  const Vector3d p = 1e3 * p_m;
  const double y = std::abs(p.y());
  const auto [s, depth] = curve.find(p);
  // Front: the alae fall back from the promontory; further down it is hollow from side to side.
  const double fall = table({{-20, 13}, {0, 10}, {20, 3}, {35, 0}, {60, -2.5}, {110, -1}}, s);
  const double aside = std::clamp((y - 14) / 26, 0.0, 1.0);
  double front = fall * aside * aside * (3 - 2 * aside);
  for (double f : kFusion) front -= 0.9 * bump(s - f, 2.2) * bump(y, 11);
  // Back: laminae, highest in the middle, with the intermediate and lateral crests.
  const double middle =
      table({{-12, 44}, {8, 45}, {30, 41}, {53, 33}, {73, 25}, {91, 17}, {108, 9}}, s);
  const double down = table({{0, 15}, {40, 10}, {75, 6}, {105, 3}}, s);
  double back = middle - down * std::pow(std::min(y / 26, 1.3), 1.6);
  for (double f : {16.0, 41.0, 63.0, 82.0}) {
    back += table({{16, 9}, {41, 8.5}, {63, 6.5}, {82, 4}}, f) * bump(s - f, 7.5) * bump(y, 3.6);
    back += 1.6 * bump(s - f, 6) * bump(y - 13, 3);
    back += 2.6 * bump(s - f, 7) * bump(y - 25 + 0.06 * f, 4.5);
  }
  // The ala's upper face slopes down to the side, behind the body.
  const double top =
      s - table({{0, 4.5}, {24, 4.5}, {36, 2.5}, {53, 9}}, y) - 0.25 * std::max(depth - 14, 0.0);
  // Side: the auricular surface faces the ilium, narrower behind; below it a thin edge.
  const double wide = table(
      {{-10, 53}, {8, 55}, {28, 53}, {48, 46}, {58, 39}, {75, 29}, {92, 21}, {104, 13}, {116, 9}},
      s);
  const double wedge = table({{0, 0.42}, {45, 0.38}, {65, 0.1}}, s);
  const double side = (y - wide + wedge * std::max(depth - 8, 0.0)) * 0.9;
  const auto smaller = [](double a, double b, double k) {
    const double h = std::max(k - std::abs(a - b), 0.0) / k;
    return std::max(a, b) + h * h * k / 4;
  };
  double d = smaller(front - depth, depth - back, 5);
  d = smaller(d, side, 7);
  d = smaller(d, -top, 5);
  d = smaller(d, s - 107, 4);
  return 0.85e-3 * d;
}

void addBase(Blend& bone, const Anatomy& anatomy) {
  // S1's body. The disc has the mean size of its two endplates.
  const Disc& disc = anatomy.discs.front();
  const Vertebra& l5 = anatomy.vertebrae.front();
  const double width = 2 * disc.shape.width - l5.lower_endplate_width;
  const double depth = 2 * disc.shape.depth - l5.lower_endplate_depth;
  const Isometry3d top = anatomy.boneFrame("S1");
  Isometry3d bottom = top;
  bottom.translate(pointMm(-4, 0, -28));
  DrumStyle style;
  style.waist = 0.06;
  style.hollow = 0.5_mm;
  bone.unite(drum({bottom, 0.72 * width, 0.72 * depth}, {top, width, depth}, style), 5.0_mm);
}

void addSuperiorProcesses(Blend& bone, const Anatomy& anatomy) {
  for (const ArticularFacet& f : anatomy.facets) {
    if (f.level != "S1") continue;
    const VertebraPlan::Face face = {facetFrame(anatomy, f), f.width, f.height};
    TubeStyle style;
    style.up = face.frame.linear().col(2);
    bone.unitePair(rod({{pointMm(-29, 26.5, -14), 7.5_mm, 5.0_mm},
                        {face.at(0, -0.15 * f.height, -3.3_mm), 0.46 * f.width, 2.8_mm},
                        {face.at(0, 0.2 * f.height, -2.6_mm), 0.42 * f.width, 2.3_mm}},
                       style),
                   2.5_mm);
    addFace(bone, face, 3.2_mm, 2.0_mm);
    clearFace(bone, face);
    outlineFace(bone, face);
  }
  // The nerve of L5 passes before them.
  bone.carvePair(capsule(pointMm(-18.4, 12, 4.8), pointMm(-17.8, 34, 4.8), 3.3_mm), 1.0_mm);
}

void carveForamina(Blend& bone, const PelvicCurve& curve) {
  // Sacral canal, open above behind the body and below at the hiatus.
  TubeStyle style;
  style.up = Vector3d(-0.7, 0, 0.7);
  style.squareness = 2;
  const auto canal = [&](double s, double depth, double side, double up) {
    return Section{curve.at(s, 0, depth), side * 1e-3, up * 1e-3, Vector3d::Zero()};
  };
  bone.carve(rod({canal(-26, 43, 15, 8), canal(-8, 42, 14.5, 7), canal(14, 36, 13, 5.5),
                  canal(40, 25, 9.5, 4.2), canal(70, 16, 6.5, 3.2), canal(92, 12, 4.5, 2.8),
                  canal(112, 10, 4, 4)},
                 style),
             1.5_mm);
  for (int i = 0; i < 4; i++) {
    const double s = kFusion[i], y = kForamen[i], r = (6.4 - 0.5 * i) * 1e-3;
    const double deep = table({{30, 27}, {53, 20}, {73, 14}, {91, 9}}, s);
    // From the canal forwards; a furrow leads the nerve on to the side.
    bone.carvePair(capsule(curve.at(s, y - 6, deep), curve.at(s + 0.5, y, 4), 0.72 * r), 1.5_mm);
    bone.carvePair(capsule(curve.at(s, y - 1, 7), curve.at(s + 1, y + 1.5, -4), r), 2.5_mm);
    bone.carvePair(capsule(curve.at(s + 1, y + 2, -3.0), curve.at(s + 3, y + 15, -5.5), 1.05 * r),
                   3.0_mm);
    // And to the back, smaller.
    bone.carvePair(capsule(curve.at(s, y - 5, deep), curve.at(s, y - 0.5, deep + 30), 0.62 * r),
                   1.5_mm);
  }
}

// Four fused segments; the first has horns and transverse processes.
void addCoccyx(Blend& bone, const PelvicCurve& curve) {
  TubeStyle style;
  style.up = Vector3d(-1, 0, 0);
  const auto section = [&](double s, double y, double depth, double side, double up) {
    return Section{curve.at(s, y, depth), side * 1e-3, up * 1e-3, Vector3d::Zero()};
  };
  bone.unite(rod({section(105, 0, 5, 9.5, 5.0), section(111, 0, 4.4, 9.5, 4.4),
                  section(117, 0, 3.6, 7, 3.4)},
                 style),
             2.0_mm);
  bone.unitePair(rod({section(110, 5, 4, 3.8, 3.2), section(109, 13.5, 5, 2.6, 2.2)}, style),
                 2.5_mm);
  bone.unitePair(rod({section(110, 6, 6, 2.0, 2.2), section(100, 7, 12, 1.5, 1.6)}, style), 1.5_mm);
  bone.unite(rod({section(118, 0, 3.4, 7.0, 3.4), section(123, 0, 3.0, 5.8, 3.0)}, style), 1.0_mm);
  bone.unite(rod({section(126, 0, 2.8, 5.2, 3.0), section(130, 0, 2.6, 4.0, 2.5)}, style), 1.0_mm);
  bone.unite(rod({section(133, 0, 2.4, 3.4, 2.4), section(137, 0, 2.2, 2.4, 1.9)}, style), 1.0_mm);
}

}  // namespace

TriMesh sacrumMesh(const Anatomy& anatomy) {
  const PelvicCurve curve;
  Blend bone;
  const AlignedBox3d box(pointMm(-85, -62, -125), pointMm(20, 62, 25));
  bone.unite({box, [&curve](const Vector3d& p) { return plateDistance(curve, p); }}, 0);
  addBase(bone, anatomy);
  carveForamina(bone, curve);
  addCoccyx(bone, curve);
  addSuperiorProcesses(bone, anatomy);
  return surface(bone, 1.2_mm, 3200, true);
}

}  // namespace torso
