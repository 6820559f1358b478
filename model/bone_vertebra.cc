// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "model/bone_parts.h"
#include "model/fuse.h"

namespace torso {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kRim = 1.2_mm;         // rounding of the endplates' edge
constexpr double kFacetGap = 2.0_mm;    // two cartilages between two facet faces
constexpr double kFacetDepth = 4.5_mm;  // bone behind a facet face

const ArticularFacet* findFacet(const Anatomy& anatomy, const std::string& level) {
  for (const ArticularFacet& f : anatomy.facets) {
    if (f.level == level) return &f;
  }
  return nullptr;
}

const CostalJoint* findCostotransverse(const Anatomy& anatomy, const std::string& level) {
  for (const CostalJoint& j : anatomy.costal_joints) {
    if (j.level == level && j.costotransverse) return &j;
  }
  return nullptr;
}

// Everything below in the vertebra frame; of a pair the left one.
class VertebraBuilder {
 public:
  VertebraBuilder(const Anatomy& anatomy, const Vertebra& v)
      : anatomy_(anatomy),
        v_(v),
        half_height_((v.body_height_anterior + v.body_height_posterior) / 4),
        back_(-(v.upper_endplate_depth + v.lower_endplate_depth) / 4),
        canal_end_(back_ - v.canal_depth),
        superior_(findFacet(anatomy, v.name)) {
    // The facet of the bone below, to lie against.
    const int n = static_cast<int>(anatomy.vertebrae.size());
    std::string below = n > 0 ? anatomy.vertebrae[n - 1].name : "";  // of C2
    for (int i = 0; i < n; i++) {
      if (anatomy.vertebrae[i].name == v.name) below = i > 0 ? anatomy.vertebrae[i - 1].name : "S1";
    }
    const ArticularFacet* facet = findFacet(anatomy, below);
    inferior_ = v.frame().inverse() * facetFrame(anatomy, *facet);
    inferior_.translate(Vector3d(0, 0, kFacetGap));
    // Turned about its height to look at the other face.
    inferior_.rotate(AngleAxisd(EIGEN_PI, Vector3d::UnitY()));
    inferior_size_ = {facet->width, facet->height};
  }

  // One surface that keeps the table's lengths, which fillets and thinning change by up to a
  // millimetre.
  TriMesh fused() {
    TriMesh mesh = fuse(build(), {1.2_mm, 3.5_mm, 1000, 0, true});
    for (bool upper : {true, false}) fitEndplate(mesh, upper);
    for (double side : {1.0, -1.0}) {
      stretch(mesh, side * Vector3d::UnitY(), v_.transverse_process_span / 2);
    }
    stretch(mesh, spinousTip().normalized(), v_.spinous_tip_distance);
    return mesh;
  }

  TriMesh build() {
    append(mesh_, body());
    appendPair(mesh_, pedicle());
    append(mesh_, laminae());
    articularProcesses();
    spinousProcess();
    if (v_.region == Region::kLumbar) lumbarTransverse();
    if (v_.region == Region::kThoracic) thoracicTransverse();
    if (v_.region == Region::kCervical) cervicalTransverse();
    return mesh_;
  }

 private:
  bool lumbar() const { return v_.region == Region::kLumbar; }
  bool thoracic() const { return v_.region == Region::kThoracic; }
  bool cervical() const { return v_.region == Region::kCervical; }

  // Frame of an endplate: origin in its middle, z along the body's axis.
  Isometry3d endplate(bool upper) const {
    Isometry3d X = Isometry3d::Identity();
    X.translate(Vector3d(0, 0, upper ? half_height_ : -half_height_));
    const double pitch = upper ? v_.upper_endplate_pitch : v_.lower_endplate_pitch;
    X.rotate(AngleAxisd(pitch - v_.pitch, Vector3d::UnitY()));
    return X;
  }

  TriMesh body() const {
    constexpr int kPoints = 48;
    const auto plane = [&](bool upper, double width, double depth) {
      Ring ring;
      for (const Vector2d& p : endplateOutline(width, depth, kPoints)) {
        ring.push_back(endplate(upper) * Vector3d(p.x(), p.y(), 0));
      }
      return ring;
    };
    const Ring lower = plane(false, v_.lower_endplate_width, v_.lower_endplate_depth);
    const Ring upper = plane(true, v_.upper_endplate_width, v_.upper_endplate_depth);
    // Height share and girth: rims, and a waist between them, deeper in front and at the sides.
    const double height = 2 * half_height_, rim = kRim / height;
    const double waist = cervical() ? 0.06 : thoracic() ? 0.10 : 0.13;
    std::vector<Ring> rings;
    const auto add = [&](double t, double inset, double hollow) {
      Ring ring;
      for (int i = 0; i < kPoints; i++) {
        const Vector3d p = (1 - t) * lower[i] + t * upper[i];
        const Vector3d centre = (2 * t - 1) * half_height_ * Vector3d::UnitZ();
        const Vector3d r = p - centre;
        const double behind = std::clamp(-r.x() / r.norm(), 0.0, 1.0);
        ring.push_back(centre + r * (1 - inset / r.norm() - hollow * (1 - 0.6 * behind)));
      }
      rings.push_back(ring);
    };
    add(0, 0.55 * lower[0].norm(), 0);
    add(0, 0.8 * kRim, 0);
    add(0.35 * rim, 0.25 * kRim, 0);
    for (double t : {rim, 2.5 * rim}) add(t, 0, 0.1 * waist * (t > rim));
    for (double t : {0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8}) {
      add(t, 0, waist * (1 - std::pow(std::abs(2 * t - 1), 2.2)));
    }
    for (double t : {1 - 2.5 * rim, 1 - rim}) add(t, 0, 0.1 * waist * (t < 1 - rim));
    add(1 - 0.35 * rim, 0.25 * kRim, 0);
    add(1, 0.8 * kRim, 0);
    add(1, 0.55 * upper[0].norm(), 0);
    return loft(rings);
  }

  // Centre of the pedicle's far end; there begin the lamina and the articular processes.
  Vector3d pedicleEnd() const {
    const double z = cervical() ? 0 : half_height_ - v_.pedicle_height * 0.5 - 2.2_mm;
    const double y =
        std::max(v_.canal_width / 2 + v_.pedicle_width * 0.5, v_.canal_width / 2 + 2.0_mm);
    return {back_ - v_.pedicle_length, y, z};
  }

  TriMesh pedicle() const {
    const Vector3d end = pedicleEnd();
    const double half = v_.pedicle_width / 2;
    // Inside the body it starts closer to the mid-line, by the inclination.
    const double inside = std::min(0.45 * -back_, 8.0_mm);
    Vector3d start = end;
    start.x() = back_ + inside;
    start.y() -= std::tan(std::max(v_.pedicle_inclination, 0.0)) * inside;
    Vector3d edge = end;
    edge.x() = back_;
    TubeStyle style;
    style.squareness = 2.4;
    style.cap = 0.3;
    const double up = v_.pedicle_height / 2;
    return tube({{start, half, up}, {edge, half, up}, {end, 1.05 * half, 0.95 * up}}, style);
  }

  // Its upper edge leans forward by this angle, to pass in front of the arch above.
  double laminaTilt() const { return lumbar() ? 0.20 : thoracic() ? 0.12 : 0.40; }
  double laminaHalfThickness() const { return lumbar() ? 3.2_mm : thoracic() ? 2.6_mm : 2.0_mm; }
  double laminaHalfHeight() const {
    return lumbar() ? 8.0_mm : thoracic() ? 0.48 * 2 * half_height_ : 0.42 * 2 * half_height_;
  }
  // Middle of the lamina on the mid-line. It hangs lower than the pedicles.
  Vector3d laminaMiddle() const {
    const double z = lumbar() ? -7.0_mm : thoracic() ? -3.0_mm : -1.5_mm;
    return {canal_end_ - laminaHalfThickness() - 0.5 * laminaHalfHeight() * std::sin(laminaTilt()),
            0, z};
  }

  // One arch from pedicle to pedicle behind the canal. Its upper edge leans forward, so that it
  // passes in front of the arch above.
  TriMesh laminae() const {
    const Vector3d end = pedicleEnd(), middle = laminaMiddle();
    const double tilt = laminaTilt();
    const Vector3d up(std::sin(tilt), 0, std::cos(tilt));
    const double t = laminaHalfThickness(), h = laminaHalfHeight();
    std::vector<Section> arch;
    const int n = 3;
    for (int i = -n; i <= n; i++) {
      const double s = std::abs(i) / double(n), side = i < 0 ? -1 : 1;
      // A flattened ellipse around the canal.
      const double angle = s * 1.15;
      const double y = end.y() * std::sin(angle) / std::sin(1.15);
      const double x = middle.x() + (end.x() - middle.x()) *
                                        std::pow((1 - std::cos(angle)) / (1 - std::cos(1.15)), 1);
      const double z = middle.z() + (end.z() - middle.z()) * s * s;
      arch.push_back({{x, side * y, z}, t, h * (1 - 0.40 * s * s), up});
    }
    TubeStyle style;
    style.squareness = 2.6;
    return tube(arch, style);
  }

  // Loft from a root to a facet face that it ends in. At the root it runs along `sign` z.
  void articularProcess(const Isometry3d& face, double width, double height, const Vector3d& root,
                        double root_side, double root_depth, double sign) {
    constexpr int kPoints = 18;
    const Vector3d across = face.linear().col(0), up = face.linear().col(1);
    const Vector3d out = face.linear().col(2);
    std::vector<Ring> rings;
    // The ring's second axis turns with the course, from along the face to across it at the root.
    const auto add = [&](const Vector3d& centre, double turn, double side, double second) {
      const Vector3d axis = std::cos(turn) * up - sign * std::sin(turn) * out;
      Ring ring;
      for (int i = 0; i < kPoints; i++) {
        const double a = 2 * EIGEN_PI * i / kPoints;
        ring.push_back(centre + side * std::cos(a) * across + second * std::sin(a) * axis);
      }
      rings.push_back(ring);
    };
    const double w = width / 2, h = height / 2;
    const Vector3d neck = 0.45 * root + 0.55 * (face * Vector3d(0, -sign * 0.2 * h, -kFacetDepth));
    add(root - sign * Vector3d(0, 0, 0.5 * root_depth), 1.4, 0.6 * root_side, 0.6 * root_depth);
    add(root, 1.2, root_side, root_depth);
    add(neck, 0.7, 0.5 * (root_side + w), 0.5 * (root_depth + 0.85 * h));
    add(face * Vector3d(0, 0, -0.6 * kFacetDepth), 0.15, 0.95 * w, 0.93 * h);
    add(face * Vector3d(0, 0, -0.5_mm), 0, w, h);
    add(face.translation(), 0, 0.93 * w, 0.93 * h);
    appendPair(mesh_, loft(rings));
  }

  void articularProcesses() {
    const Vector3d end = pedicleEnd();
    // The articular pillar of the neck carries both facets; elsewhere the inferior process hangs
    // from the lamina.
    const Vector3d inferior_back = inferior_ * Vector3d(0, 0, -kFacetDepth);
    Vector3d top = laminaMiddle();
    if (superior_ != nullptr) {
      const Isometry3d face = v_.frame().inverse() * facetFrame(anatomy_, *superior_);
      const Vector3d back = face * Vector3d(0, 0, -kFacetDepth);
      Vector3d root(0.5 * (end.x() + back.x()), 0.5 * (end.y() + back.y()), end.z() - 3.0_mm);
      root.y() = std::max(root.y(), v_.canal_width / 2 + 3.8_mm);
      if (cervical()) root = 0.5 * (back + inferior_back) + pointMm(0, 0, 1);
      const double girth = lumbar() ? 5.5_mm : thoracic() ? 4.0_mm : 4.5_mm;
      articularProcess(face, superior_->width, superior_->height, root, girth, girth, 1);
      top = root;
    } else {  // C2: its lateral masses carry C1
      TubeStyle style;
      style.up = Vector3d::UnitX();
      appendPair(mesh_, tube({{end + pointMm(2, 0, -3), 5.0_mm, 5.0_mm},
                              {end + pointMm(8, 0, 7), 7.0_mm, 8.0_mm}},
                             style));
      top = end;
    }
    Vector3d root = top;
    if (!cervical()) {
      const double t = laminaHalfThickness();
      root = Vector3d(laminaMiddle().x() + (lumbar() ? 1.0_mm : 2.0_mm),
                      0.5 * (inferior_back.y() + 0.75 * end.y()),
                      laminaMiddle().z() + 0.3 * laminaHalfHeight());
      articularProcess(inferior_, inferior_size_.x(), inferior_size_.y(), root,
                       lumbar() ? 6.5_mm : 5.0_mm, 1.3 * t, -1);
    } else {
      articularProcess(inferior_, inferior_size_.x(), inferior_size_.y(), root, 4.5_mm, 4.5_mm, -1);
    }
  }

  Vector3d spinousTip() const {
    return v_.spinous_tip_distance *
           Vector3d(-std::cos(v_.spinous_declination), 0, -std::sin(v_.spinous_declination));
  }

  void spinousProcess() {
    const Vector3d tip = spinousTip();
    const Vector3d root = laminaMiddle() + Vector3d(1.0_mm, 0, lumbar() ? 0 : -1.0_mm);
    const double length = (tip - root).norm();
    const Vector3d along = (tip - root) / length;
    TubeStyle style;
    style.up = Vector3d(along.z(), 0, -along.x());  // across it, in the mid-plane
    if (lumbar()) {
      // A tall plate with a thick, square end.
      style.squareness = 3.2;
      style.cap = 0.5;
      const double h = v_.name == "L5" ? 6.5_mm : 9.5_mm, cap = 0.5 * 3.8_mm;
      append(mesh_, tube({{root, 3.6_mm, h + 1.0_mm},
                          {root + 0.35 * length * along, 2.6_mm, h - 0.5_mm},
                          {root + 0.75 * length * along, 2.9_mm, h},
                          {tip - cap * along, 3.8_mm, h}},
                         style));
    } else if (thoracic()) {
      // Long and slender. Steep ones lie like tiles: thin from front to back, to make way for
      // the tip above.
      style.squareness = 2.2;
      const double steep = std::clamp((v_.spinous_declination - 0.45) / 0.3, 0.0, 1.0);
      const double tip_up = 2.8_mm - 1.2_mm * steep, cap = 0.7 * tip_up;
      append(mesh_, tube({{root, 4.2_mm, 6.0_mm - 3.8_mm * steep},
                          {root + 0.35 * length * along, 3.0_mm, 4.5_mm - 2.7_mm * steep},
                          {root + 0.7 * length * along, 2.4_mm, 3.2_mm - 1.5_mm * steep},
                          {tip - cap * along, 2.9_mm, tip_up}},
                         style));
    } else {
      const bool bifid = v_.name != "C7";
      const double cap = 0.7 * (bifid ? 2.4_mm : 3.6_mm);
      std::vector<Section> shaft = {{root, 3.4_mm, 5.0_mm},
                                    {root + 0.5 * length * along, 2.4_mm, 3.4_mm}};
      if (!bifid) {
        shaft.push_back({tip - cap * along, 3.6_mm, 4.0_mm});
        append(mesh_, tube(shaft, style));
        return;
      }
      const Vector3d fork = tip - std::min(8.0_mm, 0.4 * length) * along;
      shaft.push_back({fork, 3.0_mm, 3.0_mm});
      append(mesh_, tube(shaft, style));
      // Two horns; each tip lies beside the table's tip.
      append_tube(
          {{fork, 2.4_mm, 2.6_mm}, {tip - cap * along + Vector3d(0, 4.0_mm, 0), 2.4_mm, 2.6_mm}},
          style);
    }
  }

  void lumbarTransverse() {
    const Vector3d end = pedicleEnd();
    const double span = v_.transverse_process_span / 2;
    const bool l5 = v_.name == "L5";
    const double thick = l5 ? 4.5_mm : 2.6_mm, tall = l5 ? 6.5_mm : 5.0_mm;
    TubeStyle style;
    style.squareness = 2.2;
    style.cap = 1;
    const double tip_thick = 0.75 * thick;
    // A flat blade, out and a little to the rear.
    const Vector3d root(end.x() + 1.0_mm, end.y() - 2.0_mm, end.z() - 2.5_mm);
    const Vector3d tip(root.x() - (l5 ? 4.0_mm : 7.0_mm), span - tip_thick, root.z() + 2.5_mm);
    const auto between = [&](double s) -> Vector3d {
      return root + s * (tip - root) + 4 * s * (1 - s) * pointMm(-1.5, 0, -1);
    };
    append_tube({{root, 1.9 * thick, 1.5 * tall},
                 {between(0.35), 1.15 * thick, 0.95 * tall},
                 {between(0.75), thick, tall},
                 {tip, tip_thick, 0.7 * tall}},
                style);
    // Mammillary process, behind the superior facet.
    const Isometry3d face = v_.frame().inverse() * facetFrame(anatomy_, *superior_);
    const Vector3d p = face * Vector3d(0, -0.15 * superior_->height, -8.0_mm);
    appendPair(mesh_,
               ellipsoid(p + pointMm(-1, 1, -1), pointMm(3.5, 3.5, 5), Matrix3d::Identity(), 14));
  }

  void thoracicTransverse() {
    const Vector3d end = pedicleEnd();
    const double span = v_.transverse_process_span / 2;
    const CostalJoint* joint = findCostotransverse(anatomy_, v_.name);
    TubeStyle style;
    style.cap = 0.8;
    const double r = joint ? 4.6_mm : 3.6_mm;
    // A club whose front carries the rib's tubercle.
    const Vector3d tip =
        joint ? Vector3d(joint->position.x() - r - 1.5_mm, span - r, joint->position.z() + 0.5_mm)
              : Vector3d(end.x() - 9.0_mm, span - r, end.z() - 2.0_mm);
    const Vector3d root(end.x() - 1.0_mm, end.y() - 2.0_mm, end.z() - 1.5_mm);
    const Vector3d along = (tip - root).normalized();
    append_tube({{root, 5.0_mm, 5.0_mm},
                 {0.55 * root + 0.45 * tip, 3.6_mm, 4.6_mm},
                 {tip - 2.0_mm * along, 0.9 * r, 1.1 * r},
                 {tip, r, 1.15 * r}},
                style);
  }

  void cervicalTransverse() {
    const Vector3d end = pedicleEnd();
    const double span = v_.transverse_process_span / 2;
    const double width = (v_.upper_endplate_width + v_.lower_endplate_width) / 2;
    TubeStyle style;
    // Two bars around the foramen of the vertebral artery, joined at the tip.
    const double r = 2.4_mm;
    const Vector3d tip(end.x() + 3.0_mm, span - r, -1.0_mm);
    const Matrix3d sideways = AngleAxisd(EIGEN_PI / 8, Vector3d::UnitZ()).toRotationMatrix();
    const Vector3d front(tip.x() + 8.0_mm, span - 4.5_mm, -0.5_mm);
    append_tube({{{front.x() - 2.0_mm, width / 2 - 3.0_mm, 0.5_mm}, r, 2.6_mm},
                 {front, 0.9 * r, r},
                 {0.5 * (front + tip) + Vector3d(0, 1.5_mm, -1.2_mm), 0.9 * r, 0.9 * r},
                 {tip - Vector3d(0, 0.5_mm, 0), 0.9 * r, r}},
                style);
    append_tube({{end, 3.0_mm, 3.2_mm}, {tip, r, r}}, style);
    appendPair(mesh_, ellipsoid(tip, Vector3d(r, r, 1.2 * r), sideways, 14));
  }

  void append_tube(const std::vector<Section>& sections, const TubeStyle& style) {
    appendPair(mesh_, tube(sections, style));
  }

  // Pulls what of the arch lies beyond 70 % of `reach` along a unit direction so that it reaches
  // just that far.
  void stretch(TriMesh& mesh, const Vector3d& direction, double reach) const {
    // The transverse processes of the neck lie beside the body, far from it.
    const double limit = cervical() ? 0 : back_;
    double furthest = 0;
    for (const Vector3d& p : mesh.vertices) {
      if (p.x() < limit) furthest = std::max(furthest, p.dot(direction));
    }
    const double from = 0.7 * reach;
    for (Vector3d& p : mesh.vertices) {
      const double d = p.dot(direction);
      if (p.x() < limit && d > from)
        p += (d - from) * ((reach - from) / (furthest - from) - 1) * direction;
    }
  }

  // Stretches the body's end so that its outline has the endplate's width and depth just inside
  // the rounded edge.
  void fitEndplate(TriMesh& mesh, bool upper) const {
    const double width = upper ? v_.upper_endplate_width : v_.lower_endplate_width;
    const double depth = upper ? v_.upper_endplate_depth : v_.lower_endplate_depth;
    const Isometry3d X = endplate(upper), into = X.inverse();
    const double inwards = upper ? -1 : 1;
    const auto ofBody = [&](const Vector3d& q) {  // not of the arch
      return q.x() > -0.6 * depth && std::abs(q.y()) < 0.65 * width;
    };
    double side = 0, front = 0, back = 0;
    for (const auto& f : mesh.faces) {
      for (int k = 0; k < 3; k++) {
        const Vector3d a = into * mesh.vertices[f[k]], b = into * mesh.vertices[f[(k + 1) % 3]];
        const double da = inwards * a.z() - 1.1 * kRim, db = inwards * b.z() - 1.1 * kRim;
        if ((da < 0) == (db < 0)) continue;
        const Vector3d q = a + da / (da - db) * (b - a);
        if (!ofBody(q)) continue;
        if (q.x() > -0.3 * depth) side = std::max(side, std::abs(q.y()));
        if (std::abs(q.y()) > 0.3 * width) continue;
        front = std::max(front, q.x());
        back = std::max(back, -q.x());
      }
    }
    for (Vector3d& p : mesh.vertices) {
      Vector3d q = into * p;
      const double share = std::clamp(1 - (inwards * q.z() - 2.0_mm) / 5.0_mm, 0.0, 1.0);
      if (!ofBody(q)) continue;
      q.y() *= 1 + share * (width / 2 / side - 1);
      q.x() *= 1 + share * (depth / 2 / (q.x() > 0 ? front : back) - 1);
      p = X * q;
    }
  }

  const Anatomy& anatomy_;
  const Vertebra& v_;
  const double half_height_, back_, canal_end_;  // back_: x of the body's back
  const ArticularFacet* superior_;               // null for C2
  Isometry3d inferior_;                          // as facetFrame, of the inferior facet
  Vector2d inferior_size_;
  TriMesh mesh_;
};

}  // namespace

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

TriMesh facetPad(const Isometry3d& frame, double width, double height, double depth) {
  constexpr int kPoints = 20;
  // Depth behind the face, and girth: a flat face with a rounded edge and back.
  const double stations[][2] = {{0, 0.5},    {0, 0.95},    {0.12, 1},
                                {0.5, 0.97}, {0.85, 0.72}, {1, 0.35}};
  std::vector<Ring> rings;
  for (const auto& s : stations) {
    Ring ring;
    for (int i = 0; i < kPoints; i++) {
      const double a = 2 * EIGEN_PI * i / kPoints;
      ring.push_back(frame * Vector3d(s[1] * width / 2 * std::cos(a),
                                      s[1] * height / 2 * std::sin(a), -s[0] * depth));
    }
    rings.push_back(ring);
  }
  return loft(rings);
}

TriMesh vertebraShells(const Anatomy& anatomy, const std::string& level) {
  const Vertebra& v = anatomy.vertebra(level);
  return transformed(VertebraBuilder(anatomy, v).build(), v.frame());
}

TriMesh vertebraMesh(const Anatomy& anatomy, const std::string& level) {
  const Vertebra& v = anatomy.vertebra(level);
  return transformed(VertebraBuilder(anatomy, v).fused(), v.frame());
}

}  // namespace torso
