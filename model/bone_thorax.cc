// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "model/bone_parts.h"

namespace torso {
namespace {

using Eigen::Vector3d;

constexpr int kRibs = 12, kTrueRibs = 7, kFalseRibs = 10;

// Course of a rib's middle line [mm], standing body. In plan it follows a closed oval: widest at
// `x_wide` with `half_breadth` on each side, from `x_back` to `x_front` on the mid-line. It ends at
// y_end, z_end; `back_power` > 2 squares the oval behind, where the ribs turn at their angles.
// Assumed; breadth after the landmark rib_cage_max_breadth_point (rib 7 passes it), front after the
// sternum.
struct RibCourse {
  double x_wide, half_breadth, x_back, x_front, y_end, z_end;
};
constexpr RibCourse kCourse[kRibs] = {
    {24, 53, -22, 84, 37, 394},   {22, 80, -44, 99, 49, 349},    {22, 99, -58, 109, 59, 318},
    {24, 113, -68, 115, 68, 286}, {28, 123, -76, 119, 77, 256},  {32, 130, -81, 121, 87, 228},
    {35, 134, -84, 121, 96, 204}, {34, 135, -85, 117, 106, 182}, {30, 133, -84, 109, 114, 163},
    {24, 127, -80, 99, 117, 146}, {16, 119, -73, 90, 116, 142},  {4, 107, -64, 80, 92, 140}};
constexpr double kBackPower = 2.95, kFrontPower = 2.25;

// Where a rib's cartilage meets the sternum [mm]; ribs 8 to 10 end on the cartilage above.
constexpr double kSternalEnd[kTrueRibs][2] = {  // y, z
    {27, 390}, {18, 363}, {17, 338}, {19, 316}, {20, 298}, {17, 283}, {11, 273}};

class RibCage {
 public:
  explicit RibCage(const Anatomy& anatomy) : anatomy_(anatomy) {}

  std::vector<BonePart> build() {
    TriMesh bone, cartilage;
    for (int i = 0; i < kRibs; i++) appendPair(bone, rib(i));
    append(bone, sternum());
    for (int i = 0; i < kFalseRibs; i++) appendPair(cartilage, costalCartilage(i));
    for (int i = kFalseRibs; i < kRibs; i++) appendPair(cartilage, floatingTip(i));
    return {{Tissue::kBone, bone}, {Tissue::kCartilage, cartilage}};
  }

 private:
  // Front surface of the sternum at a height, on the line from IJ to PX.
  double sternumX(double z) const {
    const Vector3d top = anatomy_.landmark("suprasternal_notch_IJ");
    const Vector3d low = anatomy_.landmark("xiphoid_PX");
    return top.x() + (low.x() - top.x()) * (top.z() - z) / (top.z() - low.z());
  }

  // Point of the oval of rib i where the angle from the rear is `angle`; z is not set.
  static Vector3d oval(const RibCourse& c, double angle) {
    const bool back = angle < EIGEN_PI / 2;
    const double e = 2 / (back ? kBackPower : kFrontPower);
    const double cosine = std::pow(std::abs(std::cos(angle)), e);
    return pointMm(c.x_wide + (back ? (c.x_back - c.x_wide) : (c.x_front - c.x_wide)) * cosine,
                   c.half_breadth * std::pow(std::sin(angle), e), 0);
  }

  // Angle of the oval at a given y, behind or in front of the widest place.
  static double ovalAngle(const RibCourse& c, double y, bool back) {
    const double s =
        std::pow(std::min(1.0, y * 1e3 / c.half_breadth), (back ? kBackPower : kFrontPower) / 2);
    return back ? std::asin(s) : EIGEN_PI - std::asin(s);
  }

  // Middle line: head, neck, tubercle, angle and on round to the front end.
  std::vector<Vector3d> middleLine(int i) const {
    const RibCourse& c = kCourse[i];
    const std::string level = "T" + std::to_string(i + 1);
    const Eigen::Isometry3d frame = anatomy_.vertebra(level).frame();
    Vector3d head = Vector3d::Zero(), tubercle = Vector3d::Zero();
    bool has_tubercle = false;
    for (const CostalJoint& j : anatomy_.costal_joints) {
      if (j.level != level) continue;
      (j.costotransverse ? tubercle : head) = frame * j.position;
      has_tubercle |= j.costotransverse;
    }
    std::vector<Vector3d> line;
    // The head's middle lies beside the joint, clear of the body.
    line.push_back(head + pointMm(-1, i == 0 ? 9.5 : 6.5, 0));
    if (has_tubercle) {
      line.push_back(0.5 * (head + tubercle) + pointMm(1.5, 5, 0));
      line.push_back(tubercle + pointMm(3.5, 4.5, 0));
    } else {
      tubercle = head + pointMm(-22, 24, -5);
      line.push_back(head + pointMm(-9, 15, -2));
    }
    const double y_angle = std::min(tubercle.y() + 22_mm + 1.2_mm * i, 0.75e-3 * c.half_breadth);
    const double first = ovalAngle(c, y_angle, true);
    const double last = ovalAngle(c, c.y_end * 1e-3, i >= 11);
    const double z_angle = tubercle.z() - 4_mm - 0.9_mm * i, z_end = c.z_end * 1e-3;
    constexpr int kSteps = 7;
    for (int k = 0; k <= kSteps; k++) {
      const double s = k / double(kSteps);
      Vector3d p = oval(c, first + s * (last - first));
      p.z() = z_angle + (z_end - z_angle) * s;
      line.push_back(p);
    }
    return line;
  }

  TriMesh rib(int i) const {
    const std::vector<Vector3d> line = middleLine(i);
    const int n = static_cast<int>(line.size());
    std::vector<Section> sections;
    for (int k = 0; k < n; k++) {
      const double s = k / (n - 1.0);
      Section section{line[k], 3.1_mm, 5.6_mm};
      if (k == 0) section.side = section.up = 4.2_mm;  // head
      if (k == 1) section.side = 2.9_mm, section.up = 4.2_mm;
      if (i > 0 && s > 0.75) section.up = 6.4_mm;
      if (i >= 10) section.up *= s > 0.8 ? 0.75 : 0.9;
      if (i == 0 && k > 2) section.side = 7.0_mm, section.up = 2.6_mm;  // a flat, broad rib
      if (i == 1 && k > 1) section.side = 4.2_mm, section.up = 4.6_mm;
      // The upper edge leans towards the axis of the thorax, which narrows upwards.
      const Vector3d inward = Vector3d(kCourse[i].x_wide * 1e-3 - line[k].x(), -line[k].y(), 0);
      const double lean = k < 3 ? 0 : std::max(0.0, 0.45 - 0.06 * i);
      section.up_direction = Vector3d::UnitZ() + lean * inward.normalized();
      sections.push_back(section);
    }
    TubeStyle style;
    style.sides = 7;
    style.steps = 2;
    style.squareness = 2.2;
    return tube(sections, style);
  }

  Vector3d ribEnd(int i) const { return middleLine(i).back(); }

  std::vector<Vector3d> cartilageLine(int i) const {
    const Vector3d from = ribEnd(i);
    const std::vector<Vector3d> rib = middleLine(i);
    const Vector3d heading = (rib[rib.size() - 1] - rib[rib.size() - 2]).normalized();
    Vector3d to;
    double bend;  // how far it runs on in the rib's heading before it turns up
    if (i < kTrueRibs) {
      const double z = kSternalEnd[i][1] * 1e-3;
      to = Vector3d(sternumX(z) - 7_mm, kSternalEnd[i][0] * 1e-3 - 2_mm, z);
      bend = 0.42;
    } else {
      const std::vector<Vector3d> above = cartilageLine(i - 1);
      to = curveAt(above, i == kTrueRibs ? 2.3 : 1.9) - pointMm(0, 0, 5);
      bend = 0.42;
    }
    const double length = (to - from).norm();
    const Vector3d corner = from + bend * length * heading;
    std::vector<Vector3d> line;  // a parabola with that corner
    for (double t : {0.0, 0.22, 0.42, 0.62, 0.82, 1.0}) {
      line.push_back((1 - t) * (1 - t) * from + 2 * t * (1 - t) * corner + t * t * to);
    }
    return line;
  }

  TriMesh costalCartilage(int i) const {
    const std::vector<Vector3d> line = cartilageLine(i);
    std::vector<Section> sections;
    for (size_t k = 0; k < line.size(); k++) {
      const double up = i == 0 ? 4.5_mm : k + 1 < line.size() ? 5.6_mm : 4.6_mm;
      sections.push_back({line[k], i == 0 ? 5.0_mm : 3.9_mm, up});
    }
    TubeStyle style;
    style.sides = 7;
    style.steps = 1;
    return tube(sections, style);
  }

  TriMesh floatingTip(int i) const {
    const std::vector<Vector3d> line = middleLine(i);
    const Vector3d end = line.back();
    const Vector3d heading = (end - line[line.size() - 2]).normalized();
    TubeStyle style;
    style.sides = 8;
    style.steps = 1;
    return tube({{end - 1_mm * heading, 2.9_mm, 4.2_mm}, {end + 9_mm * heading, 1.8_mm, 2.6_mm}},
                style);
  }

  TriMesh sternum() const {
    const Vector3d top = anatomy_.landmark("suprasternal_notch_IJ");
    const Vector3d low = anatomy_.landmark("xiphoid_PX");
    const Vector3d down = (low - top).normalized();
    TubeStyle style;
    style.up = Vector3d::UnitY().cross(down);  // to the rear or the front, across the plate
    style.sides = 16;
    style.steps = 2;
    style.squareness = 2.8;
    style.cap = 0.25;
    // Half width and half thickness at a height; the middle lies half a thickness behind the front.
    const auto at = [&](double z, double half_width, double half_thickness) {
      return Section{Vector3d(sternumX(z * 1e-3) - half_thickness * 1e-3, 0, z * 1e-3),
                     half_width * 1e-3, half_thickness * 1e-3};
    };
    TriMesh mesh;
    // Manubrium; its upper edge is notched between the clavicles, so the corners are parts of
    // their own.
    append(mesh, tube({at(405, 22, 6), at(396, 28, 7), at(386, 29, 6.5), at(374, 21, 5.5),
                       at(364, 17, 5)},
                      style));
    appendPair(mesh, ellipsoid(Vector3d(sternumX(0.400) - 7_mm, 22_mm, 0.401),
                               Vector3d(7.5_mm, 9_mm, 8_mm), Eigen::Matrix3d::Identity(), 10));
    append(mesh, tube({at(361, 16.5, 5.3), at(340, 16, 5), at(318, 18.5, 5), at(298, 20.5, 5),
                       at(282, 18, 4.8), at(271, 11, 4.2)},
                      style));
    style.sides = 10;
    const double tip = low.z() * 1e3;
    append(mesh, tube({at(273, 8, 3.2), at(tip + 10, 7, 2.8), at(tip + 1, 3.5, 2.2)}, style));
    return mesh;
  }

  const Anatomy& anatomy_;
};

}  // namespace

std::vector<BonePart> ribCageMesh(const Anatomy& anatomy) { return RibCage(anatomy).build(); }

}  // namespace torso
