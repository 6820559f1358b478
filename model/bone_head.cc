// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "model/bone_parts.h"
#include "model/fuse.h"

namespace torso {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Positions in this file: millimetres from the external auditory meatus' mid-point between left
// and right, x forward, z up (the Frankfurt plane is horizontal). Assumed after general anatomy;
// a cranium 190 mm long and 150 mm wide whose top is the landmark head_vertex.

// Distance to an ellipsoid, exact only near the surface.
double ellipsoidDistance(const Vector3d& p, const Vector3d& centre, const Vector3d& half_axes) {
  const Vector3d q = p - centre;
  const double k0 = q.cwiseQuotient(half_axes).norm();
  const double k1 = q.cwiseQuotient(half_axes.cwiseAbs2()).norm();
  return k1 > 0 ? k0 * (k0 - 1) / k1 : -half_axes.minCoeff();
}

double capsuleDistance(const Vector3d& p, const Vector3d& a, const Vector3d& b, double radius) {
  const Vector3d ab = b - a;
  const double t = std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
  return (p - a - t * ab).norm() - radius;
}

// Union and difference with a fillet of size k.
double blend(double a, double b, double k) {
  const double h = std::max(k - std::abs(a - b), 0.0) / k;
  return std::min(a, b) - h * h * k / 4;
}
double carve(double a, double b, double k) { return -blend(-a, b, k); }

// Skull without mandible and zygomatic arches; negative inside. Symmetric in y.
double skullDistance(Vector3d p, double height) {
  p.y() = std::abs(p.y());
  // Cranium: frontal, parietal and occipital, flat below.
  double d = ellipsoidDistance(p, {12, 0, height - 76}, {86, 68, 76});
  d = blend(d, ellipsoidDistance(p, {-24, 0, height - 76}, {63, 75, 68}), 18);
  d = blend(d, ellipsoidDistance(p, {-42, 0, height - 96}, {50, 58, 46}), 18);
  d = blend(d, ellipsoidDistance(p, {58, 0, height - 82}, {40, 56, 50}), 20);
  d = carve(d, p.z() + 11 + 0.12 * (p.x() + 20), 14);  // base
  // Temporal bone with the mastoid process behind the ear.
  d = blend(d, ellipsoidDistance(p, {0, 54, 4}, {26, 14, 16}), 10);
  d = blend(d, capsuleDistance(p, {-13, 55, 0}, {-9, 51, -22}, 8), 8);
  // Face: brow, upper jaw, nose.
  d = blend(d, capsuleDistance(p, {91, 12, 29}, {80, 44, 25}, 8), 14);
  d = blend(d, ellipsoidDistance(p, {66, 0, -8}, {30, 36, 32}), 14);
  d = blend(d, ellipsoidDistance(p, {73, 40, -14}, {12, 12, 10}), 14);
  d = blend(d, ellipsoidDistance(p, {70, 0, -38}, {27, 29, 14}), 10);
  d = blend(d, capsuleDistance(p, {93, 0, 24}, {101, 0, 6}, 5.5), 8);
  // Hollows: temple, orbit, nose, below the cheek.
  d = carve(d, ellipsoidDistance(p, {58, 72, 8}, {24, 15, 30}), 14);
  d = carve(d, ellipsoidDistance(p, {91, 32, 8}, {34, 17, 15}), 7);
  d = carve(d, ellipsoidDistance(p, {98, 5, -17}, {17, 7, 10}), 5);
  d = carve(d, ellipsoidDistance(p, {98, 0, -6}, {14, 5, 12}), 5);
  d = carve(d, ellipsoidDistance(p, {68, 54, -42}, {24, 16, 24}), 12);
  return d;
}

class Head {
 public:
  explicit Head(const Anatomy& anatomy) : anatomy_(anatomy) {
    ear_ = anatomy.landmark("external_auditory_meatus");
    ear_.y() = 0;
  }

  TriMesh build() {
    TriMesh skull = cranium(), jaw = mandible();
    append(skull, cheeks());
    append(skull, alveolarRidge(kUpper));
    append(jaw, alveolarRidge(kLower));
    TriMesh mesh = fuse(skull, {1.7_mm, 5_mm, 3000, 2, true});
    append(mesh, fuse(jaw, {1.4_mm, 4_mm, 700, 2, true}));
    append(mesh, crowns(kUpper));
    append(mesh, crowns(kLower));
    append(mesh, atlasMesh(anatomy_));
    append(mesh, axisMesh(anatomy_));
    return mesh;
  }

 private:
  Vector3d at(double x, double y, double z) const { return ear_ + pointMm(x, y, z); }
  Section section(double x, double y, double z, double side, double up) const {
    return {at(x, y, z), side * 1e-3, up * 1e-3};
  }

  // First way out of the bone from a point inside it.
  TriMesh cranium() const {
    const double height = (anatomy_.landmark("head_vertex").z() - ear_.z()) * 1e3;
    const Vector3d centre(48, 0, 8);
    const auto radius = [&](const Vector3d& direction) {
      double r = 5;
      for (int i = 0; i < 200; i++) {
        const double d = -skullDistance(centre + r * direction, height);
        if (d < 0.02) break;
        r += std::clamp(0.7 * d, 0.05, 6.0);
      }
      return r * 1e-3;
    };
    // Denser towards the face, in front.
    constexpr int kLongitudes = 130, kLatitudes = 80;
    std::vector<double> longitudes, latitudes;
    for (int i = 0; i < kLongitudes; i++) {
      const double u = 2 * EIGEN_PI * i / kLongitudes;
      longitudes.push_back(u - 0.6 * std::sin(u));
    }
    for (int i = 1; i < kLatitudes; i++) {
      const double u = -1 + 2.0 * i / kLatitudes, middle = -0.18;
      latitudes.push_back(EIGEN_PI / 2 *
                          (u - 0.17 * std::sin(EIGEN_PI * (u - middle)) * (1 - u * u)));
    }
    TriMesh mesh = star(ear_ + centre * 1e-3, radius, longitudes, latitudes);
    // The sampled top shall be the landmark's height.
    double top = -1;
    for (const Vector3d& v : mesh.vertices) top = std::max(top, v.z() - ear_.z());
    for (Vector3d& v : mesh.vertices) {
      if (v.z() > ear_.z()) v.z() = ear_.z() + (v.z() - ear_.z()) * height * 1e-3 / top;
    }
    return mesh;
  }

  // Cheek bone with the arch to the ear, and the rim of the orbit.
  TriMesh cheeks() const {
    TriMesh mesh;
    TubeStyle style;
    appendPair(mesh, tube({section(4, 60, 2, 3, 4), section(14, 65, 1, 2.6, 4),
                           section(28, 67.5, -2, 2.2, 4.2), section(42, 65.5, -5, 2.3, 4.8),
                           section(56, 60, -8, 3.2, 6.5), section(68, 52, -11, 4.5, 9),
                           section(78, 40, -13, 5, 9), section(84, 28, -14, 4, 7)},
                          style));
    std::vector<Section> rim;
    constexpr int kPoints = 14;
    for (int k = 0; k <= kPoints; k++) {
      const double angle = 2 * EIGEN_PI * k / kPoints + 0.2;
      // Rounded rectangle, drooping to the side; the lateral rim lies further back.
      const double c = std::cos(angle), s = std::sin(angle);
      const double y = 20.5 * std::copysign(std::pow(std::abs(c), 0.8), c);
      const double z = 17.5 * std::copysign(std::pow(std::abs(s), 0.8), s) - 0.10 * y;
      const double girth = 3.2 + 1.2 * std::max(0.0, c);
      rim.push_back(section(88 - 0.32 * y - 0.006 * y * y + 0.10 * z, 32 + y, 8 + z, girth, girth));
    }
    style.up = Vector3d::UnitX();
    appendPair(mesh, tube(rim, style));
    // Occipital condyles, on C1.
    const Matrix3d tilt = Eigen::AngleAxisd(-0.15, Vector3d::UnitX()).toRotationMatrix();
    appendPair(mesh,
               ellipsoid(anatomy_.c2.position + pointMm(1, 17, 29), pointMm(11, 6, 5.5), tilt));
    return mesh;
  }

  // Arch of half width `width` and length `length` behind its foremost point; an ellipse [mm].
  struct Arch {
    double front, width, length;
    Vector3d point(double angle, double z) const {
      return {front - length * (1 - std::cos(angle)), width * std::sin(angle), z};
    }
    double speed(double angle) const {
      return std::hypot(width * std::cos(angle), length * std::sin(angle));
    }
  };

  TriMesh mandible() const {
    TriMesh mesh;
    TubeStyle style;
    style.squareness = 2.4;
    // Body: a horseshoe with the chin in front.
    std::vector<Section> body = {section(20, 47, -62, 4, 9),      section(28, 46, -69, 5, 11.5),
                                 section(44, 41, -77, 5.5, 11.5), section(60, 35, -81, 5.5, 12),
                                 section(74, 26, -84, 5.5, 12.5), section(84, 14, -86, 6, 12.5),
                                 section(88, 0, -87, 6.5, 12.5)};
    const int n = static_cast<int>(body.size());
    for (int i = n - 2; i >= 0; i--) {
      body.push_back(body[i]);
      body.back().centre.y() = -body[i].centre.y();
    }
    append(mesh, tube(body, style));
    append(mesh, ellipsoid(at(88, 0, -92), pointMm(8, 14, 7), Matrix3d::Identity(), 12));
    // Ramus, a plate up to the joint and the coronoid process.
    const std::vector<std::vector<Vector3d>> ramus = {
        {at(20, 47, -71), at(28, 46.5, -76), at(37, 44.5, -76), at(46, 42, -74)},
        {at(13, 49, -58), at(23, 48, -60), at(33, 46, -60), at(43, 43, -60)},
        {at(10, 51, -40), at(19, 50, -40), at(29, 48, -40), at(38, 45, -40)},
        {at(8, 52, -20), at(16, 51, -24), at(26, 49, -24), at(35, 46, -20)},
        {at(8, 53, -10), at(14, 53, -12), at(27, 49, -13), at(32, 48, -8)}};
    const std::vector<std::vector<double>> thickness = {{7_mm, 8_mm, 9_mm, 9_mm},
                                                        {6_mm, 5.5_mm, 6_mm, 7_mm},
                                                        {6_mm, 5_mm, 5_mm, 5.5_mm},
                                                        {6_mm, 4.5_mm, 4_mm, 4.5_mm},
                                                        {5_mm, 4.5_mm, 3_mm, 3_mm}};
    appendPair(mesh, plate(ramus, thickness));
    appendPair(mesh, ellipsoid(at(10, 52, -7), pointMm(4.5, 9, 5), Matrix3d::Identity(), 10));
    return mesh;
  }

  struct Jaw {
    Arch arch;
    double sign;      // of the way from the bite to the root
    double sizes[7];  // of the crowns along the arch, from the mid-line
  };
  static constexpr double kBite = -60;  // height at which the rows meet
  static constexpr Jaw kUpper = {{93, 28.5, 46}, 1, {7.6, 6.8, 7.2, 6.8, 6.8, 9.5, 9.5}};
  static constexpr Jaw kLower = {{90.5, 27, 46}, -1, {5.6, 5.8, 7, 6.8, 6.8, 10, 9.5}};

  // Bone that the teeth stand in.
  TriMesh alveolarRidge(const Jaw& jaw) const {
    std::vector<Section> ridge;
    for (int k = -4; k <= 4; k++) {
      ridge.push_back(
          {ear_ + 1e-3 * jaw.arch.point(k * 1.35 / 4, kBite + jaw.sign * 15) - pointMm(2.5, 0, 0),
           4.6_mm, 8_mm});
    }
    TubeStyle style;
    style.squareness = 2.3;
    return tube(ridge, style);
  }

  TriMesh crowns(const Jaw& jaw) const {
    TriMesh mesh;
    TubeStyle style;
    style.sides = 4;
    style.steps = 1;
    style.cap = 0.25;
    double angle = 0;
    for (int i = 0; i < 7; i++) {
      const double half = 0.5 * jaw.sizes[i];
      angle += half / jaw.arch.speed(angle);
      const Vector3d crown = ear_ + 1e-3 * jaw.arch.point(angle, kBite + jaw.sign * 0.8);
      const Vector3d root = ear_ + 1e-3 * jaw.arch.point(angle, kBite + jaw.sign * 10);
      style.up = Vector3d(-jaw.arch.length * std::sin(angle), jaw.arch.width * std::cos(angle), 0);
      // Incisors have an edge, molars a face.
      const bool incisor = i < 3;
      const double thick = incisor ? 2.6_mm : 4.2_mm, along = 1.32e-3 * half;
      appendPair(mesh, tube({{root, 1.3 * thick, 0.85 * along},
                             {crown, (incisor ? 0.7 : 1.3) * thick, along}},
                            style));
      angle += half / jaw.arch.speed(angle);
    }
    return mesh;
  }

  const Anatomy& anatomy_;
  Vector3d ear_;
};

}  // namespace

TriMesh headMesh(const Anatomy& anatomy) { return Head(anatomy).build(); }

}  // namespace torso
