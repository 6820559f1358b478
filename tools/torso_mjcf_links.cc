// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// What acts between bodies: contacts, tendons, equalities and actuators.

#include <fmt/core.h>

#include "tools/collision_shapes.h"
#include "tools/simple_trunk.h"
#include "tools/torso_mjcf_writer.h"

namespace torso::tools {
namespace {

using Eigen::Vector3d;
using tinyxml2::XMLElement;

// Facet pairs: the margin passes them through the bounding-sphere filter at any excursion. The gap
// is so much larger that stock MuJoCo, to which a point on an ellipsoid is a penetration in any
// direction, never acts on them; the plugin reports distances below it (facet_collider.h).
constexpr double kFacetMargin = 0.1, kFacetGap = 0.3;

}  // namespace

// A body that is excluded as the neighbour of a limb may be moulded of other parts too. Those meet
// the limb, as in the detailed torso, by pairs of geoms.
void MjcfWriter::writeTrunkPairs(tinyxml2::XMLElement* contact, const std::string& limb,
                                 const std::set<std::string>& excluded) const {
  for (const std::string& part : mjcfBodies(a_, o_)) {
    if (!excluded.count(host(part)) || neighbours(limb, part)) continue;
    int count = 0;
    for (const CollisionShape& shape : collisionShapes(a_, part)) {
      const std::string name = fmt::format("{}_collision{}", part, count++);
      if (shape.kind != "trunk") continue;
      Element(contact, "pair")
          .set("geom1", named(limb + "_collision0"))
          .set("geom2", named(name))
          .set("condim", 3)
          .set("friction", {kFriction[0], kFriction[0], kFriction[1], kFriction[2], kFriction[2]})
          .set("solref", kContactSolref)
          .set("solimp", kContactSolimp);
    }
  }
}

// The torso's parts beside a limb's own joint, which it overlaps.
bool MjcfWriter::neighbours(const std::string& limb, const std::string& part) const {
  const auto [side, name] = splitSide(limb);
  static const std::map<std::string, std::set<std::string>> kNeighbours = {
      {"upper_arm", {"scapula", "clavicle", "ribcage"}}, {"thigh", {"pelvis", "L5", "L4"}}};
  const auto found = kNeighbours.find(name);
  const auto [part_side, part_name] = splitSide(part);
  return found != kNeighbours.end() && found->second.count(part_name) > 0 &&
         (part_side == side || part_side == Side::kMiddle);
}

void MjcfWriter::writeContacts() {
  Element contact(root_, "contact");
  // Neighbours that are not parent and child in the tree.
  const auto exclude = [&](const std::string& one, const std::string& two) {
    if (!bodies_.count(one) || !bodies_.count(two)) return;
    Element(contact, "exclude").set("body1", named(one)).set("body2", named(two));
  };
  for (const char* side : {"left_", "right_"}) {
    for (const char* limb : {"upper_arm", "thigh"}) {
      const std::string body = std::string(side) + limb;
      std::set<std::string> met;
      for (const std::string& part : mjcfBodies(a_, o_)) {
        const bool parent = part == "pelvis" || splitSide(part).second == "scapula";
        if (!parent && neighbours(body, part)) met.insert(host(part));
      }
      for (const std::string& part : met) exclude(body, part);
      if (!detailed() && bodies_.count(body)) writeTrunkPairs(contact, body, met);
    }
  }
  exclude("head", "ribcage");
  // The bits keep trunk and spine from meeting themselves, and the geoms of facets from meeting
  // anything. To say so body by body spares MuJoCo the look at each pair of their geoms, a fiftieth
  // of a step.
  std::set<std::string> limbs;
  for (const std::string& part : mjcfBodies(a_, o_)) {
    for (const CollisionShape& shape : collisionShapes(a_, part)) {
      if (shape.kind == "limb") limbs.insert(host(part));
    }
  }
  std::vector<std::string> trunk;
  for (const auto& [body, element] : bodies_) {
    if (limbs.count(body)) continue;
    for (const std::string& other : trunk) exclude(other, body);
    trunk.push_back(body);
  }
  for (const auto& [body, element] : facet_bodies_) {
    Element(contact, "exclude").set("body1", "world").set("body2", named(body + "_facets"));
  }
  for (const Facet& facet : facets_) {
    for (int i = 0; i < 4; i++) {
      Element(contact, "pair")
          .set("geom1", named(facet.name + "_point" + std::to_string(i)))
          .set("geom2", named(facet.name + "_ellipsoid"))
          .set("condim", 1)
          .set("margin", kFacetMargin)
          .set("gap", kFacetGap)
          .set("solref", kLimitSolref)
          .set("solimp", kLimitSolimp);
    }
  }
}

void MjcfWriter::writeTendons() {
  Element tendons(root_, "tendon");
  for (const LigamentSegment& s : ligaments_) {
    Element spatial(tendons, "spatial");
    spatial.set("name", named(s.name))
        .set("class", named("ligament"))
        // A lower limit that is never met: with 0 MuJoCo would draw slack ligaments as hanging
        // strings of so many pieces that the viewer has no room for the body.
        .set("range", {-s.max_length, s.max_length});
    Element(spatial, "site").set("site", named(s.name + "_lower"));
    Element(spatial, "site").set("site", named(s.name + "_upper"));
  }
  for (const MuscleLine& line : muscles_) {
    Element spatial(tendons, "spatial");
    spatial.set("name", named(line.name)).set("class", named("muscle"));
    for (std::size_t k = 0; k < line.points.size(); k++) {
      Element(spatial, "site").set("site", named(line.name + "_" + std::to_string(k)));
    }
  }
}

void MjcfWriter::writeEqualities() {
  Element equality(root_, "equality");
  const auto weld = [&](const std::string& name, const std::string& upper, const std::string& lower,
                        const Vector3d& anchor) {
    // The anchor is a point of body2. torquescale turns the rotational rows' metres into radians at
    // about the distance of a disc's rim, so that stock MuJoCo bends as readily as it shears.
    Element(equality, "weld")
        .set("name", named(name))
        .set("body1", named(upper))
        .set("body2", named(lower))
        .set("anchor", local(lower, anchor))
        .set("torquescale", 0.3)
        .set("solref", "0.004 1")
        .set("solimp", "0.95 0.95 0.001");
  };
  for (const Disc& disc : levels_) {
    weld(disc.name, bodyOfLevel(a_, disc.upper), bodyOfLevel(a_, disc.lower),
         disc.frame.translation());
  }
  for (const std::string level : kSternalLevels) {
    if (!has("ribcage") || !has(level)) continue;
    weld("ribcage_" + level, "ribcage", level, a_.vertebra(level).position);
  }
}

// The velocity gain of a spinal servo stands in bias parameter 3, which MuJoCo does not use: the
// plugin adds it to the implicit rows of the disc's weld. As an explicit force, or as the
// derivative that the implicit integrator would take of it beside the constraints, it would upset
// the light vertebrae.
void MjcfWriter::writeActuators() {
  Element actuators(root_, "actuator");
  const auto common = [&](Element& e, const std::string& name, const Servo& s, double lo,
                          double hi) {
    e.set("name", named(name))
        .set("ctrlrange", {lo, hi})
        .set("forcerange", {-s.force_limit, s.force_limit})
        .set("gaintype", "fixed")
        .set("gainprm", s.kp)
        .set("biastype", "affine")
        .set("biasprm", {0, -s.kp, 0, -s.kv});
  };
  if (detailed()) {
    for (const Disc& disc : levels_) {
      if (disc.upper == a_.c2.name) continue;  // the head's ball joint has servos of its own
      const RangeOfMotion& rom = a_.range_of_motion.at(disc.name);
      const Region region = a_.vertebra(disc.upper).region;
      for (const Servo& s : a_.servos) {
        if (s.joint != regionName(region)) continue;
        const bool flexion = s.motion == "flexion";
        const double hi = rom[flexion                         ? kFlexion
                              : s.motion == "lateral_bending" ? kLateralBending
                                                              : kAxialRotation]
                              .mean;
        Element e(actuators, "general");
        common(e, disc.name + "_" + s.motion, s, flexion ? -rom[kExtension].mean : -hi, hi);
        const Vector3d axis = disc.frame.linear() * s.axis;
        e.set("site", axesSite(bodyOfLevel(a_, disc.upper)))
            .set("refsite", axesSite(bodyOfLevel(a_, disc.lower)))
            .set("gear", {0, 0, 0, axis.x(), axis.y(), axis.z()});
      }
    }
  }
  for (const auto& [body, element] : bodies_) {
    const auto [side, name] = splitSide(body);
    const std::string prefix = body.substr(0, body.size() - name.size());
    for (const BallJoint& joint : a_.joints) {
      if (joint.child != name) continue;
      for (const Servo& s : a_.servos) {
        if (s.joint != joint.name) continue;
        const Vector3d axis = side == Side::kRight ? mirrorAxis(s.axis) : s.axis;
        Element e(actuators, "general");
        common(e, prefix + joint.name + "_" + s.motion, s, s.min, s.max);
        e.set("joint", named(prefix + joint.name)).set("gear", axis);
      }
    }
  }
}

// Control 1 is the largest stress of the muscle; a positive force of MuJoCo's would lengthen it.
void MjcfWriter::writeMuscleActuators() {
  XMLElement* actuators = root_->FirstChildElement("actuator");
  for (const MuscleLine& line : muscles_) {
    Element(actuators, "general")
        .set("name", named(line.name))
        .set("group", kMuscleGroup)
        .set("tendon", named(line.name))
        .set("ctrlrange", {0, 1})
        .set("gainprm", -line.section * kLargestMuscleStress);
  }
}

}  // namespace torso::tools
