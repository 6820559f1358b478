// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/bone_rib.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "model/bone_parts.h"

namespace torso {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Course of a rib's middle line [mm], in a body of the tables' size. In plan it follows a closed
// oval: widest at `x_wide` with `half_breadth` on each side, from `x_back` to `x_front` on the
// mid-line. It ends at y_end, z_end; kBackPower > 2 squares the oval behind, where the ribs turn at
// their angles. Assumed; breadth after the landmark rib_cage_max_breadth_point (rib 7 passes it),
// front after the sternum.
struct RibCourse {
  double x_wide, half_breadth, x_back, x_front, y_end, z_end;
};
constexpr RibCourse kCourse[kRibs] = {
    {24, 53, -22, 84, 37, 394},   {22, 80, -44, 99, 49, 349},    {22, 99, -58, 109, 59, 318},
    {24, 113, -68, 115, 68, 286}, {28, 123, -76, 119, 77, 256},  {32, 130, -81, 121, 87, 228},
    {35, 134, -84, 121, 96, 204}, {34, 135, -85, 117, 106, 182}, {30, 133, -84, 109, 114, 163},
    {24, 127, -80, 99, 117, 146}, {16, 119, -73, 90, 116, 142},  {4, 107, -64, 80, 92, 140}};
constexpr double kBackPower = 2.95, kFrontPower = 2.25;

// Point of the oval of a rib where the angle from the rear is `angle` [mm].
Vector2d oval(const RibCourse& c, double angle) {
  const bool back = angle < EIGEN_PI / 2;
  const double e = 2 / (back ? kBackPower : kFrontPower);
  const double cosine = std::pow(std::abs(std::cos(angle)), e);
  return {c.x_wide + (back ? c.x_back - c.x_wide : c.x_front - c.x_wide) * cosine,
          c.half_breadth * std::pow(std::sin(angle), e)};
}

// Angle of the oval at a given y [mm], behind or in front of the widest place.
double ovalAngle(const RibCourse& c, double y, bool back) {
  const double s =
      std::pow(std::min(1.0, y / c.half_breadth), (back ? kBackPower : kFrontPower) / 2);
  return back ? std::asin(s) : EIGEN_PI - std::asin(s);
}

// The same curve with points at equal distances.
std::vector<Vector3d> resampled(const std::vector<Vector3d>& line, int points) {
  std::vector<double> length = {0};
  for (std::size_t i = 1; i < line.size(); i++) {
    length.push_back(length.back() + (line[i] - line[i - 1]).norm());
  }
  std::vector<Vector3d> out;
  std::size_t k = 1;
  for (int i = 0; i < points; i++) {
    const double at = length.back() * i / (points - 1);
    while (k + 1 < line.size() && length[k] < at) k++;
    const double t = std::clamp((at - length[k - 1]) / (length[k] - length[k - 1]), 0.0, 1.0);
    out.push_back((1 - t) * line[k - 1] + t * line[k]);
  }
  return out;
}

double smoothStep(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

double bump(double centre, double width, double x) {
  return std::exp(-std::pow((x - centre) / width, 2));
}

// Of the shaft behind, at the side, and at its front end [mm].
struct ShaftSizes {
  double height[3], thickness[3];
};
ShaftSizes shaftSizes(int rib) {
  if (rib == 0) return {{6.5, 8.5, 9.5}, {3.0, 2.7, 3.2}};
  if (rib == 1) return {{5.2, 5.8, 6.5}, {3.3, 3.0, 3.3}};
  if (rib == 10) return {{5.2, 5.4, 3.4}, {3.1, 2.7, 2.2}};
  if (rib == 11) return {{4.6, 4.4, 2.8}, {2.7, 2.4, 1.9}};
  return {{5.4, 6.4, 7.0}, {3.7, 3.0, 3.4}};
}

}  // namespace

RibLines::RibLines(const Anatomy& anatomy) {
  fitPlacement(anatomy);
  for (int i = 0; i < kRibs; i++) makeLine(anatomy, i);
}

// The affine map in the sagittal plane that takes the ends of the thoracic spine and of the sternum
// from where they are in the tables to where they are in this body.
void RibLines::fitPlacement(const Anatomy& anatomy) {
  constexpr double kTables[4][2] = {{2.37, 445.17}, {-13.32, 188.22}, {78, 408}, {124, 250}};
  constexpr double kTablesBreadth = 138;
  const Vector3d here[4] = {anatomy.vertebra("T1").position, anatomy.vertebra("T12").position,
                            anatomy.landmark("suprasternal_notch_IJ"),
                            anatomy.landmark("xiphoid_PX")};
  Eigen::Matrix<double, 4, 3> A;
  Eigen::Matrix<double, 4, 2> b;
  for (int i = 0; i < 4; i++) {
    A.row(i) << kTables[i][0], kTables[i][1], 1;
    b.row(i) << here[i].x(), here[i].z();
  }
  sagittal_ = A.colPivHouseholderQr().solve(b).transpose();
  breadth_ = anatomy.landmark("rib_cage_max_breadth_point").y() / kTablesBreadth;
}

Vector3d RibLines::placed(double x, double y, double z) const {
  const Vector2d p = sagittal_ * Vector3d(x, z, 1);
  return {p.x(), breadth_ * y, p.y()};
}

void RibLines::makeLine(const Anatomy& anatomy, int rib) {
  const RibCourse& c = kCourse[rib];
  const std::string level = "T" + std::to_string(rib + 1);
  const Eigen::Isometry3d frame = anatomy.vertebra(level).frame();
  const double mm = 1e-3 * anatomy.length_scale;
  Vector3d head = Vector3d::Zero(), tubercle = Vector3d::Zero();
  bool has_tubercle = false;
  for (const CostalJoint& j : anatomy.costal_joints) {
    if (j.level != level) continue;
    (j.costotransverse ? tubercle : head) = frame * j.position;
    has_tubercle |= j.costotransverse;
  }
  // Head and neck stay clear of the body and in front of the transverse process.
  std::vector<Vector3d> knots = {head + mm * Vector3d(-1, rib == 0 ? 10.2 : 6.7, 0)};
  if (has_tubercle) {
    knots.push_back(0.5 * (head + tubercle) + mm * Vector3d(1.7, 5.4, 0));
    knots.push_back(tubercle + mm * Vector3d(6.6, 5.7, 0));
  } else {
    tubercle = head + mm * Vector3d(-22, 24, -5);
    knots.push_back(head + mm * Vector3d(-9, 15, -2));
  }
  // Round the oval at an even slope.
  const double y_angle = rib < kFalseRibs
                             ? std::min(tubercle.y() / mm + 22 + 1.2 * rib, 0.75 * c.half_breadth)
                             : 0.5 * c.half_breadth;
  const double first = ovalAngle(c, y_angle, true);
  const double last = ovalAngle(c, c.y_end, rib == kRibs - 1);
  constexpr int kSteps = 24;
  std::vector<Vector2d> plan;
  std::vector<double> way = {0};
  for (int k = 0; k <= kSteps; k++) {
    plan.push_back(oval(c, first + (last - first) * k / kSteps));
    if (k > 0) way.push_back(way.back() + (plan[k] - plan[k - 1]).norm());
  }
  const double z_first = tubercle.z() - mm * (rib < kFalseRibs ? 4 + 0.9 * rib : 6);
  for (int k = 0; k <= kSteps; k += 2) {
    const double s = way[k] / way.back();
    Vector3d p = placed(plan[k].x(), plan[k].y(), c.z_end);
    p.z() = z_first + (p.z() - z_first) * s;
    knots.push_back(p);
  }
  std::vector<Vector3d> fine;
  constexpr int kPerKnot = 12;
  for (std::size_t i = 0; i <= (knots.size() - 1) * kPerKnot; i++) {
    fine.push_back(curveAt(knots, double(i) / kPerKnot));
  }
  std::vector<Vector3d>& line = lines_[rib];
  line = resampled(fine, kPoints);
  for (int pass = 0; pass < 40; pass++) {  // no kinks
    std::vector<Vector3d> old = line;
    for (int i = 1; i + 1 < kPoints; i++) line[i] = 0.25 * (old[i - 1] + 2 * old[i] + old[i + 1]);
  }
  line = resampled(line, kPoints);
  int nearest = 0;
  for (int i = 0; i < kPoints; i++) {
    if ((line[i] - tubercle).norm() < (line[nearest] - tubercle).norm()) nearest = i;
  }
  tubercle_[rib] = nearest / (kPoints - 1.0);
}

Vector3d RibLines::point(int rib, double share) const {
  return curveAt(lines_[rib], share * (kPoints - 1));
}

Vector3d RibLines::heading(int rib, double share) const {
  constexpr double kStep = 0.01;
  return (point(rib, std::min(1.0, share + kStep)) - point(rib, std::max(0.0, share - kStep)))
      .normalized();
}

Vector3d RibLines::outward(int rib, double share) const {
  // The surface of the thorax goes through the neighbouring ribs, too. The last two are shorter.
  const int above = std::max(0, rib - 1), below = std::min(rib + 1, kFalseRibs);
  Vector3d up = Vector3d::UnitZ();
  if (above < below && rib < kFalseRibs) {
    up = (point(above, share) - point(below, share)).normalized();
  }
  // Head and neck stand upright.
  const double shaft = smoothStep(tubercle_[rib], tubercle_[rib] + 0.15, share);
  up = ((1 - shaft) * Vector3d::UnitZ() + shaft * up).normalized();
  const Vector3d n = up.cross(heading(rib, share)).normalized();
  return n;
}

RibSection ribEndSection(int rib) {
  const ShaftSizes sizes = shaftSizes(rib);
  return {1e-3 * sizes.height[2], 1e-3 * sizes.thickness[2]};
}

TriMesh ribMesh(const RibLines& lines, int rib) {
  const ShaftSizes sizes = shaftSizes(rib);
  const double tubercle = lines.tubercle(rib);
  const double length = 1e-3 * sizes.height[1] +
                        (lines.line(rib)[1] - lines.line(rib)[0]).norm() * (RibLines::kPoints - 1);
  const bool jointed = rib < 10;  // has a tubercle and an angle
  // Shares of the length at which rings lie: closer at head, neck, tubercle and angle.
  std::vector<double> shares;
  const double per_mm = 1e-3 / length;
  const double angle = tubercle + (jointed ? (20 + 2 * rib) : 30) * per_mm;
  for (int k = 0; k <= 4; k++) shares.push_back(0.5 * tubercle * k / 4);
  for (int k = 1; k <= 4; k++) shares.push_back(tubercle * (0.5 + 0.5 * k / 4));
  for (int k = 1; k <= 5; k++) shares.push_back(tubercle + (angle + 0.03 - tubercle) * k / 5);
  const double rest = shares.back();
  const int shaft_rings = rib == 0 ? 10 : 13;
  for (int k = 1; k <= shaft_rings; k++) shares.push_back(rest + (1 - rest) * k / shaft_rings);

  // Around a section, from the outer face over the upper edge to the inner face and the lower edge.
  constexpr double kAround[] = {-0.30, 0.30, 0.95, 1.57, 2.25, 2.9, 3.55, 4.05, 4.6, 5.35};
  std::vector<Ring> rings;
  const auto addRing = [&](double share, double shrink, double beyond) {
    const Vector3d centre = lines.point(rib, share), t = lines.heading(rib, share);
    const Vector3d out = lines.outward(rib, share), up = t.cross(out).normalized();
    // Between the shaft's three sizes.
    const double s = std::clamp((share - tubercle) / (1 - tubercle), 0.0, 1.0);
    const double w0 = 1 - smoothStep(0, 0.4, s), w2 = smoothStep(0.6, 1, s), w1 = 1 - w0 - w2;
    double height = w0 * sizes.height[0] + w1 * sizes.height[1] + w2 * sizes.height[2];
    double thick = w0 * sizes.thickness[0] + w1 * sizes.thickness[1] + w2 * sizes.thickness[2];
    // Neck, head, tubercle.
    const double neck = 1 - smoothStep(0.6 * tubercle, tubercle, share);
    const double head = 1 - smoothStep(0, 0.35 * tubercle, share);
    height += neck * (4.3 - height);
    thick += neck * (2.7 - thick);
    height += head * (4.6 - height);
    thick += head * (4.4 - thick);
    const double knob = jointed ? bump(tubercle, 4.5 * per_mm, share) : 0;
    const double crook = jointed ? bump(angle, 9 * per_mm, share) : 0;
    // Groove along the inner face above the lower edge.
    const double groove = rib == 0 || rib > 10 ? 0
                                               : 1.7 * smoothStep(tubercle, angle, share) *
                                                     (1 - smoothStep(0.6, 0.85, share));
    Ring ring;
    for (double a : kAround) {
      const double c = std::cos(a), h = std::sin(a);
      const auto boxy = [](double x) { return std::copysign(std::pow(std::abs(x), 0.8), x); };
      double n = thick * boxy(c) * (1 + (1 - neck) * (rib > 0 ? 0.2 : 0) * h), u = height * boxy(h);
      if (c < 0 && h < -0.2) n += groove * bump(-0.62, 0.3, h);
      if (c < 0 && h < 0) u -= 0.35 * groove * (h < -0.95);
      if (c > 0) n += 0.8 * crook;                    // rough line on the back of the angle
      n *= 1 + (c > 0 && h < 0.3 ? 0.48 * knob : 0);  // tubercle, on the rear and below
      ring.push_back(centre + beyond * t + shrink * 1e-3 * (n * out + u * up));
    }
    rings.push_back(ring);
  };
  addRing(0, 0.45, -3.2e-3);
  addRing(0, 0.8, -2e-3);
  for (double share : shares) addRing(share, 1, 0);
  addRing(1, rib < kFalseRibs ? 0.85 : 0.75, rib < kFalseRibs ? 0.8e-3 : 2e-3);
  TriMesh mesh = loft(rings);
  if (volume(mesh) < 0) {
    for (auto& f : mesh.faces) std::swap(f[1], f[2]);
  }
  return mesh;
}

}  // namespace torso
