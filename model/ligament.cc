// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/ligament.h"

#include <cmath>
#include <stdexcept>
#include <tuple>

#include "model/body.h"
#include "model/ligament_site.h"

namespace torso {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

// Front or back wall of the body at y, on the elliptic outline.
double wallX(double depth, double width, double y) {
  return depth / 2 * std::sqrt(1 - 4 * y * y / (width * width));
}

struct Bone {
  const Anatomy& anatomy;
  std::string level;

  bool sacrum() const { return level == "S1"; }
  const Vertebra& v() const { return anatomy.vertebra(level); }

  double width(bool upper) const {
    if (sacrum()) return anatomy.discs.front().shape.width;
    return upper ? v().upper_endplate_width : v().lower_endplate_width;
  }
  double depth(bool upper) const {
    if (sacrum()) return anatomy.discs.front().shape.depth;
    return upper ? v().upper_endplate_depth : v().lower_endplate_depth;
  }
  // Height of the upper or lower endplate at x, along the bone's z.
  double rimZ(bool upper, double x) const {
    if (sacrum()) return 0;
    const double half = (v().body_height_anterior + v().body_height_posterior) / 4;
    const double tilt = (upper ? v().upper_endplate_pitch : v().lower_endplate_pitch) - v().pitch;
    return (upper ? half : -half) - x * std::tan(tilt);
  }
  double canalBack() const {
    return sacrum() ? -depth(true) / 2 - 0.015 : -depth(true) / 2 - v().canal_depth;
  }
  double canalWidth() const { return sacrum() ? 0.031 : v().canal_width; }
  double bodyHeight() const {
    return sacrum() ? 0.025 : (v().body_height_anterior + v().body_height_posterior) / 2;
  }
  Vector3d spinousTip() const {
    if (sacrum()) return {-0.045, 0, -0.030};  // median sacral crest at S1
    const double d = v().spinous_declination;
    return v().spinous_tip_distance * Vector3d(-std::cos(d), 0, -std::sin(d));
  }
  // Half the height of the spinous process at its middle: a lumbar process is a plate, others are
  // rods. Assumed.
  double spinousHalfHeight() const {
    if (sacrum()) return 0.004;
    return v().region == Region::kLumbar     ? 0.3 * bodyHeight()
           : v().region == Region::kThoracic ? 0.2 * bodyHeight()
                                             : 0.25 * bodyHeight();
  }
  Vector3d transverseTip() const {
    if (sacrum()) return {-0.012, 0.5 * 0.9 * 0.112, -0.004};  // upper edge of the ala
    double x = -depth(true) / 2 - 0.004, z = 0.08 * bodyHeight();
    if (v().region == Region::kCervical) {
      x = -0.15 * depth(true);
      z = 0;
    }
    for (const CostalJoint& joint : anatomy.costal_joints) {
      if (joint.level == level && joint.costotransverse) {
        x = joint.position.x() - 0.004;
        z = joint.position.z();
      }
    }
    return {x, v().transverse_process_span / 2, z};
  }
};

// Attachment of a ligament on the upper (towards the head) or lower side of a bone, left or middle.
Vector3d site(const Bone& bone, const std::string& ligament, bool upper) {
  const double w = bone.width(upper), d = bone.depth(upper);
  const auto starts = [&](const char* prefix) { return ligament.rfind(prefix, 0) == 0; };
  const auto onRim = [&](double x, double y) { return Vector3d(x, y, bone.rimZ(upper, x)); };
  if (starts("ALL_mid")) return onRim(d / 2, 0);
  if (starts("ALL_lat")) return onRim(wallX(d, w, 0.30 * w), 0.30 * w);
  if (starts("PLL_mid")) return onRim(-d / 2, 0);
  if (starts("PLL_lat")) return onRim(-0.47 * d, 0.25 * w);
  if (starts("LF_")) {
    const bool lateral = starts("LF_lat");
    const double y = (lateral ? 0.40 : 0.15) * bone.canalWidth();
    const double x = bone.canalBack() + (lateral ? 0.2 * (-d / 2 - bone.canalBack()) : 0);
    // The sacral endplate slopes down behind, its lamina with it; at L5/S1 the wedge of the disc
    // has used up its height by there.
    const double top = bone.sacrum() ? -0.30 : 0.10;
    return {x, y, (upper ? top : -0.50) * bone.bodyHeight()};
  }
  if (starts("ISL") || starts("SSL")) {
    const Vector3d tip = bone.spinousTip();
    const Vector3d root(bone.canalBack(), 0, -0.2 * bone.bodyHeight());
    if (starts("SSL")) return tip;
    return 0.5 * (root + tip) +
           Vector3d(0, 0, upper ? bone.spinousHalfHeight() : -bone.spinousHalfHeight());
  }
  if (starts("ITL_tip")) return bone.transverseTip();
  if (starts("ITL_base")) {
    const Vector3d tip = bone.transverseTip();
    return {tip.x() + 0.003, 0.62 * tip.y(), tip.z()};
  }
  throw std::runtime_error("anatomy: nothing is known about the sites of ligament '" + ligament +
                           "'");
}

// Capsule: from the lower end of the superior facet below to the upper end of the inferior facet
// above, at the lateral (dorsal) or medial (ventral) rim; in the standing body.
std::pair<Vector3d, Vector3d> capsule(const Anatomy& a, const Disc& disc, bool dorsal) {
  for (const ArticularFacet& face : a.facets) {
    if (face.level != disc.lower) continue;
    const Isometry3d X = a.boneFrame(face.level);
    const Vector3d n = face.normal;
    Vector3d height = Vector3d::UnitZ() - n.z() * n;
    height.normalize();
    Vector3d out = height.cross(n);  // along the face, away from the mid-line or backwards
    if (out.dot(Vector3d(-0.7, 0.7, 0)) < 0) out = -out;
    const Vector3d rim = face.position + (dorsal ? 0.5 : -0.5) * face.width * out;
    return {X * (rim - 0.4 * face.height * height),
            X * (rim + 0.5 * face.height * height + 2e-3 * n)};
  }
  throw std::runtime_error("anatomy: facets.csv has no row for " + disc.lower);
}

}  // namespace

std::vector<LigamentSegment> makeLigaments(const Anatomy& anatomy) {
  const double scale = anatomy.length_scale;
  const Anatomy a = anatomy.scaled(1 / scale, 1);  // the size that the constants are for
  std::vector<LigamentSegment> segments;
  for (const Disc& disc : a.discs) {
    if (disc.upper == a.c2.name) continue;
    const Bone lower{a, disc.lower}, upper{a, disc.upper};
    for (const Ligament& ligament : a.ligaments) {
      LigamentSegment s;
      s.name = ligament.name + "_" + disc.name;
      s.ligament = ligament.name;
      s.lower = disc.lower;
      s.upper = disc.upper;
      if (ligament.group == "CL") {
        std::tie(s.lower_point, s.upper_point) =
            capsule(a, disc, ligament.name.rfind("CL_dorsal", 0) == 0);
      } else {
        s.lower_point = a.boneFrame(disc.lower) * site(lower, ligament.name, true);
        s.upper_point = a.boneFrame(disc.upper) * site(upper, ligament.name, false);
      }
      if (ligament.side == Side::kRight) {
        s.lower_point = mirror(s.lower_point);
        s.upper_point = mirror(s.upper_point);
      }
      s.lower_point *= scale;
      s.upper_point *= scale;
      s.max_length =
          ligament.max_length_ratio.at(disc.name) * (s.upper_point - s.lower_point).norm();
      segments.push_back(s);
    }
  }
  return segments;
}

std::vector<LigamentSegment> makeLigaments(const Anatomy& anatomy, const Skeleton& skeleton) {
  std::vector<LigamentSegment> segments = makeLigaments(anatomy);
  for (LigamentSegment& s : segments) {
    if (!skeleton.has(bodyOfLevel(anatomy, s.lower)) ||
        !skeleton.has(bodyOfLevel(anatomy, s.upper))) {
      continue;
    }
    const double ratio = s.max_length / (s.upper_point - s.lower_point).norm();
    s.lower_point = ligamentSite(anatomy, s.lower, s.ligament, true, s.lower_point,
                                 skeleton.bone(bodyOfLevel(anatomy, s.lower)));
    s.upper_point = ligamentSite(anatomy, s.upper, s.ligament, false, s.upper_point,
                                 skeleton.bone(bodyOfLevel(anatomy, s.upper)));
    s.max_length = ratio * (s.upper_point - s.lower_point).norm();
  }
  return segments;
}

}  // namespace torso
