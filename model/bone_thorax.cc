// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "model/bone_parts.h"
#include "model/bone_rib.h"
#include "model/sheet.h"
#include "model/surface.h"

namespace torso {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Where cartilages meet the sternum: half its width there and height above the xiphoid's tip along
// the sternum [mm]. Ribs 8 to 10 end on the cartilage above.
constexpr double kSternalEnd[kTrueRibs][2] = {{29, 140}, {18, 116}, {17, 92}, {19, 70},
                                              {20, 51},  {17, 35},  {10, 25}};
constexpr double kSternumLength = 164.6;  // of the table's landmarks IJ to PX, for the sizes here

class RibCage {
 public:
  explicit RibCage(const Anatomy& anatomy) : ribs_(anatomy) {
    const Vector3d top = anatomy.landmark("suprasternal_notch_IJ");
    const Vector3d tip = anatomy.landmark("xiphoid_PX");
    scale_ = (top - tip).norm() / kSternumLength;
    // x to the front, y to the left, z up along the sternum.
    sternum_.linear().col(0) = Vector3d::UnitY().cross((top - tip).normalized());
    sternum_.linear().col(1) = Vector3d::UnitY();
    sternum_.linear().col(2) = (top - tip).normalized();
    sternum_.translation() = tip;
  }

  std::vector<BonePart> build() {
    TriMesh bone;
    for (int i = 0; i < kRibs; i++) appendPair(bone, ribMesh(ribs_, i));
    append(bone, sternum());
    return {{Tissue::kBone, bone}, {Tissue::kCartilage, cartilage()}};
  }

 private:
  // Height of the sternum's middle surface above the plane through IJ and PX, whose front it lies
  // behind but for the forward bend at the sternal angle; half its thickness [mm].
  static double bend(double z) {
    const double angle = z > 116 ? std::max(0.0, (164 - z) / 48) : std::min(1.0, z / 80);
    return -5 + 4.5 * angle;
  }
  static double halfThickness(double z) {
    const double manubrium = std::clamp((z - 112) / 8, 0.0, 1.0);
    const double xiphoid = std::clamp((27 - z) / 6, 0.0, 1.0);
    double t = 4.6 + 1.2 * manubrium - 1.8 * xiphoid + 1.2 * std::clamp((z - 130) / 25, 0.0, 1.0);
    const auto line = [&](double at, double width) {
      return std::exp(-std::pow((z - at) / width, 2));
    };
    t += 0.7 * line(116, 5) - 2.2 * line(116, 1.4) - 1.2 * line(26, 1.4);  // joints
    return t + 0.7 * (line(92, 2.5) + line(70, 2.5) + line(51, 2.5));      // where its parts fused
  }

  // Point of the sternum's middle surface [mm -> m].
  Vector3d onSternum(double y, double z) const {
    return sternum_ * Vector3d(scale_ * Vector3d(bend(z), y, z));
  }

  TriMesh sternum() const {
    // Left half of the outline from the tip up: xiphoid, body, manubrium with the notches for the
    // ribs and the clavicle.
    const std::vector<Vector2d> left = {
        {2.5, 0.5},  {4.5, 5},    {6, 14},     {7.5, 21},   {10, 24.5},  {13.5, 29},  {16.3, 34},
        {16.8, 38},  {19.5, 43},  {19.2, 50},  {19.8, 54},  {19.5, 61},  {17.8, 69},  {18, 73},
        {17.2, 82},  {15.8, 91},  {16.2, 95},  {15.5, 104}, {16.3, 111}, {16.6, 116}, {17.8, 120},
        {20, 126},   {25, 133},   {28.5, 138}, {29.5, 145}, {27.5, 150}, {24, 153.5}, {21, 158.5},
        {19.5, 165}, {15.5, 168}, {9, 164.5},  {3, 162.8}};
    std::vector<Vector2d> outline;
    for (auto it = left.rbegin(); it != left.rend(); ++it) outline.push_back({-it->x(), it->y()});
    outline.insert(outline.end(), left.begin(), left.end());
    // Counter-clockwise: up on the right side of the picture, which is the body's left.
    std::rotate(outline.begin(), outline.begin() + left.size(), outline.end());
    Sheet sheet;
    sheet.frame = Eigen::Isometry3d::Identity();
    sheet.frame.linear() << Vector3d::UnitY(), Vector3d::UnitZ(), Vector3d::UnitX();
    sheet.outline = smoothOutline(outline, 3);
    sheet.middle = [](double, double z) { return bend(z); };
    sheet.half_thickness = [](double y, double z, double) {
      const double notch = z > 150 ? 0.03 * std::abs(y) : 0;  // thick at the clavicles
      return halfThickness(z) + notch;
    };
    sheet.max_height = 9;
    sheet.max_half_thickness = 9;
    Blend s;
    s.unite(sheetSolid(sheet), 0);
    // Faces for the clavicles.
    s.carvePair(ellipsoidSolid({-5, 33.5, 164}, {14, 12, 13}), 2);
    TriMesh mesh = surface(s, 1.3, 1700, true, Finish::kEven);
    for (Vector3d& v : mesh.vertices) v = sternum_ * Vector3d(scale_ * v);
    return mesh;
  }

  // Middle line of a costal cartilage: on in the rib's heading, then up to its end.
  std::vector<Vector3d> cartilageLine(int i) const {
    const Vector3d from = ribs_.point(i, 1), heading = ribs_.heading(i, 0.99);
    const Vector3d to = i < kTrueRibs ? onSternum(kSternalEnd[i][0] - 1.5, kSternalEnd[i][1])
                                      : curveAt(cartilageLine(i - 1), i == kTrueRibs ? 3.4 : 2.9);
    const Vector3d corner = from + 0.45 * (to - from).norm() * heading;
    std::vector<Vector3d> line;  // a parabola with that corner
    for (int k = 0; k <= 6; k++) {
      const double t = k / 6.0;
      line.push_back((1 - t) * (1 - t) * from + 2 * t * (1 - t) * corner + t * t * to);
    }
    return line;
  }

  // Bar from the end of a rib to the sternum, to the cartilage above or, of the last two, to a tip.
  Solid costalCartilage(int i) const {
    const RibSection end = ribEndSection(i);
    std::vector<Section> sections;
    if (i < kFalseRibs) {
      const std::vector<Vector3d> line = cartilageLine(i);
      const double narrow = i == 0 ? 5.5_mm : i < kTrueRibs ? 4.6_mm : 3.6_mm;
      for (std::size_t k = 0; k < line.size(); k++) {
        // It starts within the rib's end, which is a little wider.
        const double t = k / (line.size() - 1.0);
        sections.push_back({line[k], (1 - t) * 0.88 * end.height + t * narrow,
                            (1 - t) * 0.88 * end.thickness + t * 3.4_mm});
      }
    } else {
      const Vector3d from = ribs_.point(i, 1), heading = ribs_.heading(i, 0.99);
      sections = {{from - 1_mm * heading, 0.88 * end.height, 0.88 * end.thickness},
                  {from + 4_mm * heading, 0.75 * end.height, 0.75 * end.thickness},
                  {from + 9_mm * heading, 0.4 * end.height, 0.4 * end.thickness}};
    }
    // The section's "up" is its thickness, out of the thorax.
    return bar(sections, ribs_.outward(i, 0.97), 2);
  }

  TriMesh cartilage() const {
    TriMesh mesh;
    // Those that end on one another are one piece.
    constexpr int kFirstJoined = 6;
    constexpr double kVoxel = 1.4_mm, kFillet = 4_mm;
    Blend joined;
    for (int i = 0; i < kRibs; i++) {
      if (i >= kFirstJoined && i < kFalseRibs) {
        joined.unite(costalCartilage(i), i > kTrueRibs ? kFillet : 1.5_mm);
        continue;
      }
      Blend alone;
      alone.unite(costalCartilage(i), 0);
      appendPair(mesh, surface(alone, kVoxel, i < kFirstJoined ? 170 : 60, false, Finish::kEven));
    }
    appendPair(mesh, surface(joined, kVoxel, 1000, false, Finish::kEven));
    return mesh;
  }

  const RibLines ribs_;
  double scale_;
  Eigen::Isometry3d sternum_ = Eigen::Isometry3d::Identity();
};

}  // namespace

std::vector<BonePart> ribCageMesh(const Anatomy& anatomy) { return RibCage(anatomy).build(); }

}  // namespace torso
