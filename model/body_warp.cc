// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/body_warp.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "model/body.h"
#include "model/pitch.h"

namespace torso {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

// 1 up to `from`, 0 beyond `to`, smooth between.
double fade(double x, double from, double to) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return 1 - t * t * (3 - 2 * t);
}

// Front, back and left of an endplate.
using Rim = std::array<Vector3d, 3>;
Rim rim(const Isometry3d& frame, double width, double depth) {
  return {frame * Vector3d(depth / 2, 0, 0), frame * Vector3d(-depth / 2, 0, 0),
          frame * Vector3d(0, width / 2, 0)};
}

Rim sacralRim(const Anatomy& a) {
  // The disc has the mean size of its two endplates.
  const DiscShape& disc = a.discs.front().shape;
  const Vertebra& l5 = a.vertebrae.front();
  return rim(a.boneFrame("S1"), 2 * disc.width - l5.lower_endplate_width,
             2 * disc.depth - l5.lower_endplate_depth);
}

Rim axisRim(const Anatomy& a) {
  Isometry3d X = a.c2.frame();
  X.translate(Vector3d(0, 0, -(a.c2.body_height_anterior + a.c2.body_height_posterior) / 4));
  X.rotate(pitchMatrix(a.c2.lower_endplate_pitch - a.c2.pitch));
  return rim(X, a.c2.lower_endplate_width, a.c2.lower_endplate_depth);
}

// What the anchors add at a point: their residuals, weighted by inverse square distance (Shepard's
// interpolation), fading out at `reach`.
template <typename Anchors>
Vector3d pull(const Anchors& anchors, const Vector3d& p, double reach) {
  double nearest = reach, weights = 0;
  Vector3d sum = Vector3d::Zero();
  for (const auto& anchor : anchors) {
    const double distance = (p - anchor.from).norm();
    if (distance < 1e-9) return anchor.residual;
    nearest = std::min(nearest, distance);
    const double weight = 1 / (distance * distance);
    weights += weight;
    sum += weight * anchor.residual;
  }
  return weights > 0 ? Vector3d(fade(nearest, 0, reach) / weights * sum) : sum;
}

}  // namespace

template <typename Map>
void BodyWarp::addAnchor(std::vector<Anchor>& anchors, const Map& map, const Vector3d& from,
                         const Vector3d& to) {
  const Vector3d residual = to - map(from);
  anchors.push_back({from, residual});
  if (from.y() != 0) anchors.push_back({mirror(from), mirror(residual)});
}

BodyWarp::BodyWarp(const Anatomy& tables, const Anatomy& person, const Growth& growth)
    : tables_(tables),
      growth_(growth),
      pelvis_turn_(pitchMatrix(person.sacral_slope - tables.sacral_slope)),
      thorax_growth_(growth.thorax_depth, growth.thorax_width, 1),
      thorax_from_(Vector3d::Zero()),
      thorax_to_(Vector3d::Zero()),
      c2_from_(tables.c2.position),
      c2_to_(person.c2.position) {
  double turn = 0;
  int count = 0;
  for (const Vertebra& v : tables.vertebrae) {
    if (v.region != Region::kThoracic) continue;
    const Vertebra& mine = person.vertebra(v.name);
    spine_.push_back({v.position, mine.position, mine.pitch - v.pitch});
    if (v.name == "T11" || v.name == "T12") continue;  // whose ribs float
    thorax_from_ += v.position;
    thorax_to_ += mine.position;
    turn += mine.pitch - v.pitch;
    count++;
  }
  thorax_from_ /= count;
  thorax_to_ /= count;
  thorax_turn_ = pitchMatrix(turn / count);

  const auto to_pelvis = [&](const Vector3d& p) { return pelvis(p); };
  const Rim s1 = sacralRim(tables), my_s1 = sacralRim(person);
  for (int i = 0; i < 3; i++) addAnchor(pelvis_anchors_, to_pelvis, s1[i], my_s1[i]);
  for (std::size_t i = 0; i < tables.facets.size(); i++) {
    if (tables.facets[i].level != "S1") continue;
    addAnchor(pelvis_anchors_, to_pelvis, tables.boneFrame("S1") * tables.facets[i].position,
              person.boneFrame("S1") * person.facets[i].position);
  }
  for (std::size_t i = 0; i < tables.costal_joints.size(); i++) {
    const CostalJoint& joint = tables.costal_joints[i];
    addAnchor(
        rib_anchors_, [&](const Vector3d& p) { return ribs(p); },
        tables.boneFrame(joint.level) * joint.position,
        person.boneFrame(joint.level) * person.costal_joints[i].position);
  }
  const Rim c2 = axisRim(tables), my_c2 = axisRim(person);
  for (int i = 0; i < 3; i++) {
    addAnchor(
        head_anchors_, [&](const Vector3d& p) { return head(p); }, c2[i], my_c2[i]);
  }
}

Vector3d BodyWarp::pelvis(const Vector3d& p) const {
  // The pubic arch widens downwards from the hip joints to the ischial tuberosities.
  constexpr double kArch = 0.07;
  const double hip = tables_.landmark("hip_joint_centre").z();
  const double upper = fade(hip - p.z(), 0, kArch);
  const double width = upper * growth_.pelvis_width + (1 - upper) * growth_.ischial_width;
  return pelvis_turn_ * Vector3d(p.x(), p.y() * width, p.z());
}

Vector3d BodyWarp::thorax(const Vector3d& p) const {
  return thorax_to_ + thorax_turn_ * thorax_growth_.cwiseProduct(p - thorax_from_);
}

Vector3d BodyWarp::ribs(const Vector3d& p) const {
  // Motion of the spine at this height, between the two vertebrae.
  const auto above = std::find_if(spine_.begin() + 1, spine_.end() - 1,
                                  [&](const Level& level) { return level.from.z() > p.z(); });
  const Level &a = *(above - 1), &b = *above;
  const double s = std::clamp((p.z() - a.from.z()) / (b.from.z() - a.from.z()), 0.0, 1.0);
  const auto with = [&](const Level& level) -> Vector3d {
    return level.to + pitchMatrix(level.turn) * thorax_growth_.cwiseProduct(p - level.from);
  };
  // From the tubercles to the front and the sides the motion goes over to the whole thorax's.
  constexpr double kTubercle = 0.045, kFront = 0.090;  // distances from the spine
  const double spine_x = (1 - s) * a.from.x() + s * b.from.x();
  const double near = fade(std::hypot(p.x() - spine_x, p.y()), kTubercle, kFront);
  return near * ((1 - s) * with(a) + s * with(b)) + (1 - near) * thorax(p);
}

Vector3d BodyWarp::head(const Vector3d& p) const {
  // C2 has its own measures; the skull begins above it.
  const double axis = fade(p.z() - c2_from_.z(), 0.010, 0.045);
  const double size = axis + (1 - axis) * growth_.head;
  return c2_to_ + size * (p - c2_from_);
}

Vector3d BodyWarp::operator()(const std::string& body, const Vector3d& point) const {
  const auto [side, name] = splitSide(body);
  if (side == Side::kRight) return mirror((*this)("left_" + name, mirror(point)));
  if (name == "pelvis") {
    return pelvis(point) + pull(pelvis_anchors_, point, 0.035);
  }
  if (name == "ribcage") return ribs(point) + pull(rib_anchors_, point, 0.030);
  if (name == "head") return head(point) + pull(head_anchors_, point, 0.020);
  if (name == "clavicle" || name == "scapula") return thorax(point);
  if (name == "upper_arm" || name == "lower_arm" || name == "hand") {
    const Vector3d& shoulder = tables_.landmark("glenohumeral_centre_GH");
    return point + (thorax(shoulder) - shoulder);
  }
  if (name == "thigh" || name == "shin" || name == "foot") {
    const Vector3d& hip = tables_.landmark("hip_joint_centre");
    return point + (pelvis(hip) - hip);
  }
  throw std::runtime_error("anatomy: no way is known to move points of '" + body + "'");
}

}  // namespace torso
