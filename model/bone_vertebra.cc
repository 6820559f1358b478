// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/bone_vertebra.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "model/surface.h"

namespace torso {
namespace {

using Eigen::AlignedBox3d;
using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kFacetGap = 2.0_mm;  // two cartilages between two facet faces

const ArticularFacet* findFacet(const Anatomy& anatomy, const std::string& level) {
  for (const ArticularFacet& f : anatomy.facets) {
    if (f.level == level) return &f;
  }
  return nullptr;
}

// The outline of an endplate: distance from its centre by direction, and by how much the outline
// is turned against the direction.
class Outline {
 public:
  // Hollowed behind by `hollow` on the mid-line.
  Outline(double width, double depth, double hollow) {
    constexpr int kPoints = 480;
    std::vector<Vector2d> ring = endplateOutline(width, depth, kPoints);
    double back = 0;
    for (Vector2d& p : ring) {
      const double u = p.y() / (0.26 * width);
      if (p.x() < 0 && std::abs(u) < 1) p.x() += hollow * std::pow(1 - u * u, 2);
      back = std::min(back, p.x());
    }
    for (Vector2d& p : ring) {
      if (p.x() < 0) p.x() *= 0.5 * depth / -back;
    }
    int i = 0;
    for (int k = 0; k < kSize; k++) {
      const double angle = 2 * EIGEN_PI * k / kSize;
      const Vector2d d(std::cos(angle), std::sin(angle));
      const auto side = [&](const Vector2d& p) { return d.x() * p.y() - d.y() * p.x(); };
      while (i + 1 < kPoints && side(ring[i + 1]) <= 0) i++;
      const Vector2d &a = ring[i], &b = ring[(i + 1) % kPoints];
      const double t = side(b) == side(a) ? 0 : -side(a) / (side(b) - side(a));
      radius_[k] = (a + t * (b - a)).dot(d);
    }
  }

  double radius(double angle) const { return at(radius_, angle); }
  // Cosine between direction and normal.
  double facing(double angle) const {
    const double step = 2 * EIGEN_PI / kSize;
    const double slope = (radius(angle + step) - radius(angle - step)) / (2 * step);
    return 1 / std::hypot(1, slope / radius(angle));
  }

 private:
  static constexpr int kSize = 360;
  static double at(const std::array<double, kSize>& table, double angle) {
    double t = angle / (2 * EIGEN_PI);
    t = (t - std::floor(t)) * kSize;
    const int i = static_cast<int>(t);
    const double s = t - i;
    return (1 - s) * table[i % kSize] + s * table[(i + 1) % kSize];
  }
  std::array<double, kSize> radius_;
};

// Pulls what lies beyond 70 % of `reach` along a unit direction, and behind x = `limit`, so that it
// reaches just that far: thinning shortens round tips by up to a millimetre.
void stretch(TriMesh& mesh, const Vector3d& direction, double reach, double limit) {
  double furthest = 0;
  for (const Vector3d& p : mesh.vertices) {
    if (p.x() < limit) furthest = std::max(furthest, p.dot(direction));
  }
  const double from = 0.7 * reach;
  for (Vector3d& p : mesh.vertices) {
    const double d = p.dot(direction);
    if (p.x() >= limit || d <= from) continue;
    p += (d - from) * ((reach - from) / (furthest - from) - 1) * direction;
  }
}

}  // namespace

VertebraPlan::VertebraPlan(const Anatomy& anatomy_, const Vertebra& vertebra)
    : anatomy(anatomy_),
      v(vertebra),
      half_height((v.body_height_anterior + v.body_height_posterior) / 4),
      back(-(v.upper_endplate_depth + v.lower_endplate_depth) / 4),
      canal_end(back - v.canal_depth),
      canal_half(v.canal_width / 2),
      spinous_tip(v.spinous_tip_distance *
                  Vector3d(-std::cos(v.spinous_declination), 0, -std::sin(v.spinous_declination))) {
  const Isometry3d into = v.frame().inverse();
  const ArticularFacet* above = findFacet(anatomy, v.name);
  has_superior = above != nullptr;
  if (has_superior) superior = {into * facetFrame(anatomy, *above), above->width, above->height};
  const ArticularFacet* below = findFacet(anatomy, levelBelow());
  inferior = {into * facetFrame(anatomy, *below), below->width, below->height};
  inferior.frame.translate(Vector3d(0, 0, kFacetGap));
  // Turned about its height to look at the other face.
  inferior.frame.rotate(AngleAxisd(EIGEN_PI, Vector3d::UnitY()));

  // Pedicles spring from the upper half of the body, in the neck from its middle.
  const double z = cervical() ? 0.5_mm : half_height - 0.5 * v.pedicle_height - 2.2_mm;
  pedicle_end = {back - v.pedicle_length, canal_half + v.pedicle_width / 2, z};
}

std::string VertebraPlan::levelBelow() const {
  std::string below = "S1";
  for (const Vertebra& other : anatomy.vertebrae) {
    if (other.name == v.name) break;
    below = other.name;
  }
  return below;
}

Isometry3d VertebraPlan::endplate(bool upper) const {
  Isometry3d X = Isometry3d::Identity();
  X.translate(Vector3d(0, 0, upper ? half_height : -half_height));
  const double pitch = upper ? v.upper_endplate_pitch : v.lower_endplate_pitch;
  X.rotate(AngleAxisd(pitch - v.pitch, Vector3d::UnitY()));
  return X;
}

const CostalJoint* VertebraPlan::costalJoint(const std::string& level, bool costotransverse) const {
  for (const CostalJoint& j : anatomy.costal_joints) {
    if (j.level == level && j.costotransverse == costotransverse) return &j;
  }
  return nullptr;
}

Solid drum(const Endplate& below, const Endplate& above, const DrumStyle& style) {
  const Outline lower(below.width, below.depth, style.hollow);
  const Outline upper(above.width, above.depth, style.hollow);
  const Isometry3d into_lower = below.frame.inverse(), into_upper = above.frame.inverse();
  AlignedBox3d box;
  for (const Endplate* e : {&below, &above}) {
    const double out = 0.6 * std::max(e->width, e->depth);
    for (double x : {-out, out}) {
      for (double y : {-out, out}) box.extend(e->frame * Vector3d(x, y, 0));
    }
  }
  return {box, [=](const Vector3d& p) {
            const double height = (into_lower * p).z(), under = -(into_upper * p).z();
            const double t = std::clamp(height / (height + under), 0.0, 1.0);
            const Vector3d axis =
                (1 - t) * below.frame.translation() + t * above.frame.translation();
            const double x = p.x() - axis.x(), r = std::hypot(x, p.y());
            const double angle = std::atan2(p.y(), x);
            const double edge = (1 - t) * lower.radius(angle) + t * upper.radius(angle);
            // The back is straighter; a heart's sides run together towards the front.
            double narrow = 1 - 0.85 * std::clamp(-std::cos(angle), 0.0, 1.0);
            if (style.heart && x > 0) narrow += 0.5 * std::pow(std::sin(2 * angle), 2);
            // The rims are as wide as the endplates, the waist lies between them.
            const double w = std::min(1.14 * std::abs(2 * t - 1), 1.0);
            const double radius = edge * (1 - style.waist * narrow * (1 - std::pow(w, 2.2)));
            const double facing = (1 - t) * lower.facing(angle) + t * upper.facing(angle);
            const double around = (r - radius) * facing;
            // Endplates: a rim with a dish inside.
            constexpr double kDish = 0.4_mm, kRim = 0.05_mm;
            const double in = std::clamp((0.84 - r / edge) / 0.25, 0.0, 1.0);
            const double sunk = kDish * in * in * (3 - 2 * in) - kRim;
            const double ends = sunk - std::min(height, under);
            const double k = 0.6_mm, h = std::max(k - std::abs(around - ends), 0.0) / k;
            return std::max(around, ends) + h * h * k / 4;
          }};
}

Solid vertebralBody(const VertebraPlan& plan) {
  const Vertebra& v = plan.v;
  DrumStyle style;
  style.waist = plan.cervical() ? 0.02 : plan.thoracic() ? 0.06 : 0.05;
  // Round before the thorax' round canal, kidney-shaped in the loins, flat in the neck.
  style.hollow = plan.cervical() || v.name == "T1" || v.name == "T2" ? 0.3_mm : 0.8_mm;
  style.heart = plan.thoracic();
  return drum({plan.endplate(false), v.lower_endplate_width, v.lower_endplate_depth},
              {plan.endplate(true), v.upper_endplate_width, v.upper_endplate_depth}, style);
}

void addPedicles(Blend& bone, const VertebraPlan& plan) {
  const Vertebra& v = plan.v;
  const Vector3d end = plan.pedicle_end;
  const double half = v.pedicle_width / 2, height = v.name == "C7" || v.name == "L5" ? 0.88 : 0.98;
  const double up = height * v.pedicle_height / 2;
  TubeStyle style;
  style.cap = 0.5;
  style.squareness = 2.2;
  if (plan.cervical()) {
    // Obliquely outwards from the body's rear corner; narrowest just behind it.
    const Vector3d middle(plan.back - 1.0_mm, plan.canal_half + half, end.z());
    const Vector3d along(-std::cos(v.pedicle_inclination), std::sin(v.pedicle_inclination), 0);
    bone.unitePair(rod({{middle - 7.0_mm * along, 1.1 * half, up},
                        {middle, 0.85 * half, up},
                        {middle + 5.0_mm * along, 1.1 * half, up}},
                       style),
                   2.0_mm);
    return;
  }
  // Inside the body it starts closer to the mid-line, by the inclination.
  const double inside = std::min(-0.45 * plan.back, 8.0_mm);
  Vector3d start = end, edge = end;
  start.x() = plan.back + inside;
  start.y() -= std::tan(std::max(v.pedicle_inclination, 0.0)) * inside;
  edge.x() = plan.back;
  bone.unitePair(
      rod({{start, 0.7 * half, 0.9 * up}, {edge, half, up}, {end, 1.08 * half, up}}, style),
      plan.thoracic() ? 2.0_mm : 3.0_mm);
}

void carveCanal(Blend& bone, const VertebraPlan& plan) {
  Isometry3d X = Isometry3d::Identity();
  const double off = 1.2_mm;  // from the body's back, which stays as it is
  X.translate(Vector3d(0.5 * (plan.back - off + plan.canal_end), 0, 2 * plan.half_height));
  bone.carve(facePlate(X, plan.v.canal_depth - off, plan.v.canal_width, 4 * plan.half_height, 0),
             1.0_mm);
}

void addFace(Blend& bone, const VertebraPlan::Face& face, double depth, double fillet) {
  bone.unitePair(facePlate(face.frame, face.width, face.height, depth, 1.0_mm), fillet);
}

void clearFace(Blend& bone, const VertebraPlan::Face& face) {
  constexpr double kClear = 6.0_mm;
  Isometry3d X = face.frame;
  X.translate(Vector3d(0, 0, kClear));
  bone.carvePair(facePlate(X, face.width + 1.0_mm, face.height + 1.0_mm, kClear, 0), 0.4_mm);
}

void outlineFace(Blend& bone, const VertebraPlan::Face& face) {
  constexpr double kClear = 6.0_mm, kStep = 0.9_mm, kMargin = 3.0_mm;
  Isometry3d X = face.frame;
  X.translate(Vector3d(0, 0, kClear));
  const Solid around =
      facePlate(X, face.width + 2 * kMargin, face.height + 2 * kMargin, kClear + kStep, 0);
  const Solid kept = facePlate(X, face.width, face.height, 2 * kClear, 0);
  bone.carvePair({around.box,
                  [around, kept](const Vector3d& p) {
                    return std::max(around.distance(p), -kept.distance(p));
                  }},
                 1.0_mm);
}

Isometry3d facetFrame(const Anatomy& anatomy, const ArticularFacet& facet) {
  const Vector3d n = facet.normal;
  const Vector3d up = (Vector3d::UnitZ() - n.z() * n).normalized();
  Isometry3d X = Isometry3d::Identity();
  X.translate(facet.position);
  Matrix3d R;
  R << up.cross(n), up, n;
  X.rotate(R);
  return anatomy.boneFrame(facet.level) * X;
}

TriMesh vertebraSurface(const Blend& bone, const VertebraPlan& plan, double voxel) {
  constexpr int kFaces = 2400;
  TriMesh mesh = surface(bone, voxel, kFaces, true);
  // The transverse processes of the neck lie beside the body, far from it.
  const double limit = plan.cervical() ? 0 : plan.back;
  for (double side : {1.0, -1.0}) {
    stretch(mesh, side * Vector3d::UnitY(), plan.v.transverse_process_span / 2, limit);
  }
  stretch(mesh, plan.spinous_tip.normalized(), plan.spinous_tip.norm(), limit);
  return mesh;
}

TriMesh vertebraMesh(const Anatomy& anatomy, const std::string& level) {
  const VertebraPlan plan(anatomy, anatomy.vertebra(level));
  Blend bone;
  bone.unite(vertebralBody(plan), 0);
  addPedicles(bone, plan);
  if (plan.lumbar()) addLumbarArch(bone, plan);
  if (plan.thoracic()) addThoracicArch(bone, plan);
  if (plan.cervical()) addCervicalArch(bone, plan);
  const double voxel = plan.lumbar() ? 0.9_mm : plan.thoracic() ? 0.8_mm : 0.7_mm;
  return transformed(vertebraSurface(bone, plan, voxel), plan.v.frame());
}

}  // namespace torso
