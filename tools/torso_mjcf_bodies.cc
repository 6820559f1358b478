// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Bodies with their joints, masses and geoms, and the sites on them.

#include <tuple>

#include "tools/collision_shapes.h"
#include "tools/torso_mjcf_writer.h"

namespace torso::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using tinyxml2::XMLElement;

// The capsule of a joint with slack, as a limit with impedance d, which resists by d^2 / (1 - d) /
// 0.034^2 / 0.98^2 times the angle beyond the slack and the joint's mean inertia: 5 Nm/rad for the
// arm of the tables while d is 0.5, and as a stop where it nears 0.98.
constexpr const char* kCapsuleSolref = "0.034 1";
std::string capsuleSolimp(const BallJoint& joint) {
  return mjcfText({0.5, 0.98, joint.limit - joint.slack, 0.9, 10});
}

}  // namespace

void MjcfWriter::writeInertial(XMLElement* element, const std::string& body) {
  // Everything that is moulded into this body.
  Inertial sum;
  std::vector<Inertial> parts;
  for (const std::string& part : mjcfBodies(a_, o_)) {
    if (host(part) != body) continue;
    parts.push_back(bodyInertial(a_, part));
    const Inertial& p = parts.back();
    sum.com = (sum.mass * sum.com + p.mass * p.com) / (sum.mass + p.mass);
    sum.mass += p.mass;
  }
  for (const Inertial& p : parts) {
    const Vector3d r = p.com - sum.com;
    sum.inertia +=
        p.inertia + p.mass * (r.squaredNorm() * Matrix3d::Identity() - r * r.transpose());
  }
  const Matrix3d R = frame(body).linear();
  const Matrix3d I = R.transpose() * sum.inertia * R;
  Element(element, "inertial")
      .set("pos", local(body, sum.com))
      .set("mass", sum.mass)
      .set("fullinertia", {I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)});
}

void MjcfWriter::writeBones(XMLElement* element, const std::string& body) {
  for (const Tissue tissue : o_.bones ? tissues(body) : std::vector<Tissue>()) {
    const std::string name = boneMeshName(body, tissue);
    Element geom(element, "geom");
    geom.set("name", named(name)).set("class", named("bone")).set("mesh", named(name));
    if (tissue == Tissue::kCartilage) geom.set("material", named("cartilage"));
    const Isometry3d offset = frame(body).inverse() * bodyFrame(a_, body);
    if (!offset.isApprox(Isometry3d::Identity())) {
      geom.set("pos", Vector3d(offset.translation())).set("quat", Quaterniond(offset.linear()));
    }
  }
  int count = 0;
  for (const CollisionShape& shape : collisionShapes(a_, body)) {
    const std::string name = body + "_collision" + std::to_string(count++);
    Element geom(element, "geom");
    geom.set("name", named(name)).set("class", named(shape.kind));
    geom.set("type", "capsule").set("size", shape.radius);
    geom.set("fromto", mjcfText(local(body, shape.from)) + " " + mjcfText(local(body, shape.to)));
  }
}

XMLElement* MjcfWriter::writeBody(XMLElement* parent, const std::string& parent_name,
                                  const std::string& body) {
  Element element(parent, "body");
  element.set("name", named(body));
  bodies_[body] = element;
  const Isometry3d X = frame(body);
  if (parent_name.empty()) {
    element.set("pos", Vector3d(X.translation() + Vector3d(0, 0, o_.height)));
    element.set("quat", Quaterniond(X.linear()));
    if (body != o_.anchored) Element(element, "freejoint").set("name", named(body));
  } else {
    const Isometry3d P = frame(parent_name).inverse() * X;
    element.set("pos", Vector3d(P.translation())).set("quat", Quaterniond(P.linear()));
    const auto [side, name] = splitSide(body);
    for (const BallJoint& joint : a_.joints) {
      if (joint.child != name) continue;
      const std::string prefix = body.substr(0, body.size() - name.size());
      Element ball(element, "joint");
      ball.set("name", named(prefix + joint.name))
          .set("type", "ball")
          .set("stiffness", joint.stiffness)
          .set("damping", joint.damping)
          .set("armature", joint.armature);
      const Vector3d centre =
          local(body, side == Side::kRight ? mirror(joint.position) : joint.position);
      if (!centre.isZero(1e-9)) ball.set("pos", centre);
      // In degrees, MJCF's default, so that the file can be included in others.
      if (joint.limit > 0) {
        const bool capsule = joint.slack < joint.limit;
        ball.set("range", {0, joint.slack * 180 / M_PI})
            .set("solreflimit", capsule ? kCapsuleSolref : kLimitSolref)
            .set("solimplimit", capsule ? capsuleSolimp(joint) : kLimitSolimp);
      }
    }
  }
  writeInertial(element, body);
  for (const std::string& part : mjcfBodies(a_, o_)) {
    if (host(part) == body) writeBones(element, part);
  }
  for (const std::string& child : hosts()) {
    const auto [side, name] = splitSide(child);
    for (const BallJoint& joint : a_.joints) {
      if (joint.child != name) continue;
      if (host(pairedName(a_, side, joint.parent)) == body) writeBody(element, body, child);
    }
  }
  return element;
}

void MjcfWriter::writeBodies() {
  Element world(root_, "worldbody");
  for (const std::string& body : hosts()) {
    const bool hangs = std::any_of(a_.joints.begin(), a_.joints.end(), [&](const BallJoint& joint) {
      return joint.child == splitSide(body).second;
    });
    if (!hangs) writeBody(world, "", body);
  }
  if (!has("pelvis")) return;
  Element(bodies_["pelvis"], "camera")
      .set("name", named("front"))
      .set("mode", "trackcom")
      .set("pos", {2.6, 0, 0.35})
      .set("xyaxes", {0, 1, 0, -0.1, 0, 1});
  Element(bodies_["pelvis"], "camera")
      .set("name", named("side"))
      .set("mode", "trackcom")
      .set("pos", {0, -2.6, 0.35})
      .set("xyaxes", {1, 0, 0, 0, 0.1, 1});
  Element(bodies_["pelvis"], "camera")
      .set("name", named("back"))
      .set("mode", "trackcom")
      .set("pos", {-2.2, 0.9, 0.6})
      .set("xyaxes", {-0.38, -0.93, 0, 0.15, -0.06, 1});
}

// A massless body, fixed to its bone, for the geoms of facets: they meet nothing but each other,
// and here the broad phase of collision detection never looks at them.
XMLElement* MjcfWriter::facetBody(const std::string& body) {
  XMLElement*& element = facet_bodies_[body];
  if (!element) {
    element = Element(bodies_[body], "body").set("name", named(body + "_facets"));
    Element(element, "inertial").set("pos", {0, 0, 0}).set("mass", 0).set("diaginertia", {0, 0, 0});
  }
  return element;
}

// A site with the axes of the standing body, for servos between bones. It is on a body of its own:
// where a refsite is given MuJoCo 2.2.2 multiplies the quaternions of a site and its body in the
// wrong order, so that a site that is turned in its body would read another angle as the whole
// turns.
std::string MjcfWriter::axesSite(const std::string& body) {
  const std::string name = named(body + "_axes");
  if (!axes_.insert(body).second) return name;
  Element element(bodies_[body], "body");
  element.set("name", name).set("quat", localRotation(body, Matrix3d::Identity()));
  Element(element, "inertial").set("pos", {0, 0, 0}).set("mass", 0).set("diaginertia", {0, 0, 0});
  Element(element, "site").set("name", name).set("class", named("disc_frame"));
  return name;
}

void MjcfWriter::writeSites() {
  for (const Disc& disc : levels_) {
    for (const auto& [level, suffix] : {std::pair{disc.lower, "_lower"}, {disc.upper, "_upper"}}) {
      const std::string body = bodyOfLevel(a_, level);
      Element(bodies_[body], "site")
          .set("name", named(disc.name + suffix))
          .set("class", named("disc_frame"))
          .set("pos", local(body, disc.frame.translation()))
          .set("quat", localRotation(body, disc.frame.linear()));
    }
  }
  for (const Facet& facet : facets_) {
    const Isometry3d X = frame(facet.ellipsoid_body).inverse() * facet.ellipsoid;
    Element(facetBody(facet.ellipsoid_body), "geom")
        .set("name", named(facet.name + "_ellipsoid"))
        .set("class", named("facet_ellipsoid"))
        .set("size", facet.radii)
        .set("pos", Vector3d(X.translation()))
        .set("quat", Quaterniond(X.linear()));
    for (int i = 0; i < 4; i++) {
      Element(facetBody(facet.points_body), "geom")
          .set("name", named(facet.name + "_point" + std::to_string(i)))
          .set("class", named("facet_point"))
          .set("pos", local(facet.points_body, facet.points[i]));
    }
  }
  for (const LigamentSegment& s : ligaments_) {
    for (const auto& [level, point, suffix] :
         {std::tuple{s.lower, s.lower_point, "_lower"}, {s.upper, s.upper_point, "_upper"}}) {
      const std::string body = bodyOfLevel(a_, level);
      Element(bodies_[body], "site")
          .set("name", named(s.name + suffix))
          .set("class", named("ligament"))
          .set("pos", local(body, point));
    }
  }
  for (const MuscleLine& line : muscles_) {
    for (std::size_t k = 0; k < line.points.size(); k++) {
      const MusclePoint& p = line.points[k];
      Element(bodies_[p.body], "site")
          .set("name", named(line.name + "_" + std::to_string(k)))
          .set("class", named("muscle"))
          .set("pos", local(p.body, p.position));
    }
  }
}

}  // namespace torso::tools
