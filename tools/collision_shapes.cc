// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/collision_shapes.h"

#include <cmath>
#include <stdexcept>

#include "model/body.h"
#include "model/body_warp.h"

namespace torso::tools {
namespace {

using Eigen::Vector3d;
using Shapes = std::vector<CollisionShape>;

CollisionShape capsule(const char* kind, const Vector3d& from, const Vector3d& to, double radius) {
  return {kind, from, to, radius};
}

// Shapes on the mid-line, and those on the left with their mirror images.
Shapes withMirror(Shapes shapes, const Shapes& left) {
  for (const CollisionShape& s : left) {
    shapes.push_back(s);
    shapes.push_back({s.kind, mirror(s.from), mirror(s.to), s.radius});
  }
  return shapes;
}

Shapes vertebra(const Vertebra& v) {
  const Eigen::Isometry3d X = v.frame();
  if (v.region == Region::kThoracic) {
    // Only the spinous process can meet the floor; the rib cage covers the rest.
    const double d = v.spinous_declination;
    const Vector3d along(-std::cos(d), 0, -std::sin(d));
    return {capsule("spine", X * (0.5 * v.spinous_tip_distance * along),
                    X * ((v.spinous_tip_distance - 0.004) * along), 0.010)};
  }
  // Flesh at this level: a capsule across the body.
  const bool lumbar = v.region == Region::kLumbar;
  const double radius = lumbar ? 0.085 : 0.052, reach = lumbar ? 0.055 : 0.006;
  const Vector3d centre = v.slice_com + Vector3d(lumbar ? -0.008 : 0.005, 0, 0);
  return {capsule(lumbar ? "trunk" : "spine", X * (centre + Vector3d(0, -reach, 0)),
                  X * (centre + Vector3d(0, reach, 0)), radius)};
}

// Bone-length shapes of one limb segment between two landmarks.
CollisionShape between(const Anatomy& a, const char* from, const char* to, double start, double end,
                       double radius) {
  const Vector3d p = a.landmark(from), q = a.landmark(to);
  return capsule("limb", p + start * (q - p), p + end * (q - p), radius);
}

Shapes leftOrMiddle(const Anatomy& a, const std::string& name) {
  const auto at = [&](const char* landmark) { return a.landmark(landmark); };
  if (name == "pelvis") {
    const Vector3d hip = at("hip_joint_centre");
    const Vector3d wing(-0.02, 0.07, -0.03), seat(-0.03, 0.065, -0.15);
    return withMirror({capsule("trunk", {-0.04, -0.05, -0.05}, {-0.04, 0.05, -0.05}, 0.065)},
                      {capsule("trunk", wing, hip + Vector3d(-0.02, -0.01, 0), 0.07),
                       capsule("trunk", hip + Vector3d(-0.04, -0.015, 0.01), seat, 0.055)});
  }
  if (name == "ribcage") {
    const Vector3d ij = at("suprasternal_notch_IJ"), px = at("xiphoid_PX");
    // Barrel: capsules across the body, as wide as the ribs, from the costal margin to the top.
    Shapes middle = {
        capsule("trunk", ij + Vector3d(-0.02, 0, -0.02), px + Vector3d(-0.02, 0, 0), 0.025)};
    const struct {
      double x, z, half_width, radius;
    } rungs[] = {{0.030, 0.16, 0.055, 0.080},
                 {0.028, 0.22, 0.060, 0.085},
                 {0.020, 0.28, 0.060, 0.085},
                 {0.012, 0.34, 0.050, 0.080},
                 {0.010, 0.39, 0.030, 0.065}};
    for (const auto& r : rungs) {
      middle.push_back(
          capsule("trunk", {r.x, -r.half_width, r.z}, {r.x, r.half_width, r.z}, r.radius));
    }
    return withMirror(middle,
                      {capsule("trunk", {-0.055, 0.06, 0.19}, {-0.055, 0.055, 0.36}, 0.035)});
  }
  if (name == "head") {
    const Vector3d vertex = at("head_vertex"), ear = at("external_auditory_meatus");
    const double z = vertex.z() - 0.080;
    return {capsule("limb", {ear.x() - 0.014, 0, z}, {ear.x() + 0.020, 0, z}, 0.080),
            capsule("limb", {ear.x() + 0.05, 0, ear.z() - 0.015},
                    {ear.x() + 0.06, 0, ear.z() - 0.06}, 0.035)};
  }
  if (name == "clavicle") {
    return {
        capsule("spine", at("sternoclavicular_joint_SC"), at("acromioclavicular_joint_AC"), 0.010)};
  }
  if (name == "scapula") {
    const Vector3d ts = at("scapula_root_of_spine_TS"), ai = at("scapula_inferior_angle_AI"),
                   aa = at("acromion_angle_AA");
    return {capsule("spine", ts, ai, 0.010), capsule("spine", ts, aa, 0.012),
            capsule("spine", aa, at("glenohumeral_centre_GH") + Vector3d(0, -0.01, 0), 0.018)};
  }
  if (name == "upper_arm")
    return {between(a, "glenohumeral_centre_GH", "elbow", 0.05, 0.95, 0.043)};
  if (name == "lower_arm") return {between(a, "elbow", "wrist", 0.08, 0.95, 0.034)};
  if (name == "hand") return {between(a, "wrist", "hand_tip", 0.15, 0.88, 0.022)};
  if (name == "thigh") return {between(a, "hip_joint_centre", "knee", 0.12, 0.95, 0.066)};
  if (name == "shin") return {between(a, "knee", "ankle", 0.03, 0.95, 0.048)};
  if (name == "foot") {  // two capsules along its borders whose undersides are the sole
    const Vector3d heel = at("heel"), toe = at("toe_tip");
    const double radius = 0.024, z = at("sole").z() + radius;
    return {capsule("limb", {heel.x() + radius, heel.y() - 0.010, z},
                    {toe.x() - radius, toe.y() - 0.025, z}, radius),
            capsule("limb", {heel.x() + radius, heel.y() + 0.010, z},
                    {toe.x() - 0.05, toe.y() + 0.018, z}, radius),
            capsule("limb", {heel.x() + 0.03, heel.y(), z + 0.01}, at("ankle"), 0.028)};
  }
  throw std::logic_error("no collision shapes are known of the body '" + name + "'");
}

}  // namespace

Shapes collisionShapes(const Anatomy& anatomy, const std::string& body) {
  const double scale = anatomy.length_scale;
  const Anatomy table_size = anatomy.scaled(1 / scale, 1);  // the size that the constants are for
  const auto [side, name] = splitSide(body);
  Shapes shapes;
  for (const Vertebra& v : table_size.vertebrae) {
    if (v.name == body) shapes = vertebra(v);
  }
  if (shapes.empty()) {
    const BodyWarp* warp = anatomy.warp.get();
    shapes = leftOrMiddle(warp ? warp->tables() : table_size, name);
    const std::string left = side == Side::kMiddle ? name : "left_" + name;
    for (CollisionShape& s : shapes) {
      if (!warp) break;
      s.from = (*warp)(left, s.from);
      s.to = (*warp)(left, s.to);
      if (name == "ribcage") s.radius *= std::sqrt(warp->thoraxGrowth().prod());
    }
  }
  // Head, hands and feet, the clavicle and the spines have little flesh.
  const bool lean = name == "head" || name == "hand" || name == "foot";
  for (CollisionShape& s : shapes) {
    s.from = scale * (side == Side::kRight ? mirror(s.from) : s.from);
    s.to = scale * (side == Side::kRight ? mirror(s.to) : s.to);
    s.radius *= lean || s.kind == "spine" ? scale : anatomy.girth_scale;
  }
  return shapes;
}

}  // namespace torso::tools
