// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
// Actuators that move several levels of the spine at once: those of the humanoid's trunk joints,
// and the groups that GraftOptions::groups asks for.
//
// MJCF has no actuator of one control and several joints: fixed tendons do not take ball and free
// joints. So a group is a servo on the rotation between the two bones at its ends, as a spine
// tester has it: its moment is the same in every level between, which share the motion by their
// stiffness. The levels' own servos stay, with a tenth of their stiffness and all of their damping,
// for a column of discs alone would buckle under the body's weight (six lumbar ones at about
// 360 N).

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "tools/graft_xml.h"
#include "tools/grafter.h"
#include "tools/mjcf.h"

namespace torso::tools {
namespace {

using Eigen::Vector3d;
using tinyxml2::XMLElement;

// By the axis of the standing body about which they turn: x, y, z.
constexpr const char* kMotions[3] = {"lateral_bending", "flexion", "axial_rotation"};

// Stiffness that the servo of a level in a group keeps, and that of the group's servo, both to that
// of the levels' own servos (in series). The larger, the less do discs and ligaments, which the
// gain leaves out, keep the group from its target.
constexpr double kLevelShare = 0.1, kGroupShare = 2;

// Part of the thoracic range of motion that a group uses: the rib cage, of one piece here, leaves
// it to the levels from T6/T7 down.
constexpr double kThoracicRange = 0.5;

int discIndex(const Anatomy& a, const std::string& name) {
  const auto named = [&](const Disc& disc) { return disc.name == name; };
  return static_cast<int>(std::find_if(a.discs.begin(), a.discs.end(), named) - a.discs.begin());
}

const Servo& servo(const Anatomy& a, const std::string& joint, const std::string& motion) {
  for (const Servo& s : a.servos) {
    if (s.joint == joint && s.motion == motion) return s;
  }
  throw Error("servos.csv: no row '" + joint + "', '" + motion + "'");
}

// What moves one level about one axis: the disc's servo, or for C2/C3 that of the head's joint.
struct Level {
  std::string actuator;  // without prefix
  double min, max;       // [rad]
  double kp, force_limit;
};

Level level(const Anatomy& a, int disc, int axis) {
  const Disc& d = a.discs[disc];
  const char* motion = kMotions[axis];
  if (d.upper == a.c2.name) {
    const Servo& s = servo(a, "head", motion);
    return {std::string("head_") + motion, s.min, s.max, s.kp, s.force_limit};
  }
  const char* region = d.region == Region::kLumbar     ? "lumbar"
                       : d.region == Region::kThoracic ? "thoracic"
                                                       : "cervical";
  const Servo& s = servo(a, region, motion);
  const RangeOfMotion& rom = a.range_of_motion.at(d.name);
  const double share = d.region == Region::kThoracic && d.lower != "L1" ? kThoracicRange : 1;
  const double max = rom[axis == 0 ? kLateralBending : axis == 1 ? kFlexion : kAxialRotation].mean;
  return {d.name + "_" + motion, share * (axis == 1 ? -rom[kExtension].mean : -max), share * max,
          s.kp, s.force_limit};
}

}  // namespace

// A name that neither the humanoid nor our torso has.
std::string Grafter::freeName(const std::string& kind, std::string name) const {
  const std::set<MjcfName> theirs = definedNames(host_.root), own = definedNames(torso_root_);
  while (theirs.count({kind, name}) || own.count({kind, name})) name = "torso_" + name;
  return name;
}

// A site on a bone whose axes are those of the standing trunk. It is on a body of its own, for
// MuJoCo 2.2.2 multiplies the quaternions of a site and its body in the wrong order where a refsite
// is given: with a site that is turned in its body, the length would change as the whole turns.
std::string Grafter::standingSite(const std::string& bone) {
  std::string& name = standing_sites_[bone];
  if (!name.empty()) return name;
  // Vertebrae have one for their own servos.
  XMLElement* own = ourBody(bone + "_axes");
  if (own) return name = text(own->FirstChildElement("site"), "name");
  name = freeName("site", ours(bone + "_axes"));
  Element body(ourBody(bone), "body");
  body.set("name", freeName("body", ours(bone + "_axes")));
  setPose(body, isometry(Eigen::Quaterniond(ourPose(bone).linear().transpose() * place_.linear()),
                         Vector3d::Zero()));
  Element(body, "inertial").set("pos", {0, 0, 0}).set("mass", 0).set("diaginertia", {0, 0, 0});
  Element(body, "site").set("name", name).set("group", 4).set("size", 0.002);
  return name;
}

// Makes `e` the servo of these levels, and takes stiffness from theirs. target = slope * ctrl +
// offset [rad] in our sense.
void Grafter::makeGroup(XMLElement* e, const SpineGroup& group, double slope, double offset) {
  double compliance = 0, force_limit = INFINITY;
  for (int disc = group.first; disc <= group.last; disc++) {
    const Level l = level(a_, disc, group.axis);
    compliance += 1 / l.kp;
    force_limit = std::min(force_limit, l.force_limit);
    XMLElement* actuators = torso_root_->FirstChildElement("actuator");
    for (XMLElement* own = actuators->FirstChildElement(); own; own = own->NextSiblingElement()) {
      if (text(own, "name") != ours(l.actuator)) continue;
      std::vector<double> bias = numbers(own, "biasprm");
      own->SetAttribute("gainprm", mjcfText(kLevelShare * l.kp).c_str());
      own->SetAttribute("biasprm",
                        mjcfText({bias[0], kLevelShare * bias[1], bias[2], bias[3]}).c_str());
    }
    driven_[group.axis][disc] = group.name;
  }
  const double kp = 1 / compliance;
  Vector3d gear = Vector3d::Zero();
  gear[group.axis] = 1;
  const std::string lower = a_.discs[group.first].lower, upper = a_.discs[group.last].upper;
  // The gain makes up for the levels' own stiffness, which holds them at their own target of 0.
  e->SetAttribute("site", standingSite(bodyOfLevel(a_, upper)).c_str());
  e->SetAttribute("refsite", standingSite(bodyOfLevel(a_, lower)).c_str());
  e->SetAttribute("gear", mjcfText({0, 0, 0, gear.x(), gear.y(), gear.z()}).c_str());
  e->SetAttribute("forcelimited", "true");
  e->SetAttribute("forcerange", mjcfText({-force_limit, force_limit}).c_str());
  e->SetAttribute("gaintype", "fixed");
  e->SetAttribute("gainprm", mjcfText((kGroupShare + kLevelShare) * kp * slope).c_str());
  e->SetAttribute("biastype", "affine");
  e->SetAttribute(
      "biasprm",
      mjcfText({(kGroupShare + kLevelShare) * kp * offset, -kGroupShare * kp, 0}).c_str());
}

std::array<double, 2> Grafter::groupRange(const SpineGroup& group) const {
  std::array<double, 2> range = {0, 0};
  for (int disc = group.first; disc <= group.last; disc++) {
    const Level l = level(a_, disc, group.axis);
    range[0] += l.min;
    range[1] += l.max;
  }
  return range;
}

// Levels that a humanoid's trunk joint stands for. Joints of one axis share the levels evenly, in
// the order of their heights; a single joint below the shoulders gets the lumbar ones.
std::map<int, SpineGroup> Grafter::trunkJointGroups(const std::vector<int>& joints) const {
  const mjModel* m = host_.model.get();
  const auto& d = host_.data;
  const int thoracic = discIndex(a_, "T12/L1"), cervical = discIndex(a_, "C7/T1");
  const int last = static_cast<int>(a_.discs.size()) - 1;
  std::map<int, SpineGroup> groups;
  for (int high = 0; high < 2; high++) {
    for (int axis = 0; axis < 3; axis++) {
      std::vector<int> alike;
      for (int j : joints) {
        const TrunkPart part = parts_.trunk.at(m->jnt_bodyid[j]);
        if ((part == TrunkPart::kNeck || part == TrunkPart::kHead) != (high == 1)) continue;
        int k = 0;
        localAxis(j).cwiseAbs().maxCoeff(&k);
        if (k == axis) alike.push_back(j);
      }
      if (alike.empty()) continue;
      const int begin = high ? cervical : 0;
      const int end = high ? last : alike.size() == 1 ? thoracic : cervical - 1;
      const auto height = [&](int j) {
        const mjtNum* x = d->xanchor + 3 * j;
        return (place_.inverse() * Vector3d(x[0], x[1], x[2])).z();
      };
      std::stable_sort(alike.begin(), alike.end(),
                       [&](int i, int k) { return height(i) < height(k) - 1e-6; });
      const int n = static_cast<int>(alike.size()), levels = end - begin + 1;
      for (int i = 0; i < n; i++) {
        const int first = begin + i * levels / n, next = begin + (i + 1) * levels / n;
        if (next > first) groups[alike[i]] = {"", axis, first, next - 1};
      }
    }
  }
  return groups;
}

// Axis of a joint of the host at qpos0, in the axes of the standing trunk.
Vector3d Grafter::localAxis(int joint) const {
  const mjtNum* x = host_.data->xaxis + 3 * joint;
  return place_.linear().transpose() * Vector3d(x[0], x[1], x[2]);
}

// Actuators of the trunk's hinges become servos of the levels in their place, with name, ctrlrange
// and sense. What cannot be one is left to dropReferences.
void Grafter::takeTrunkActuators() {
  const mjModel* m = host_.model.get();
  std::vector<XMLElement*> elements;
  forEachSection(host_.root, "actuator", [&](XMLElement* s) {
    for (XMLElement* e = s->FirstChildElement(); e; e = e->NextSiblingElement()) {
      elements.push_back(e);
    }
  });
  if (static_cast<int>(elements.size()) != m->nu) return;
  std::map<int, int> actuator_of;  // joint: actuator
  std::vector<int> joints;
  for (int u = 0; u < m->nu; u++) {
    if (m->actuator_dyntype[u] != mjDYN_NONE) stateful_.insert(elements[u]);
    const int j = m->actuator_trnid[2 * u];
    if (m->actuator_trntype[u] != mjTRN_JOINT && m->actuator_trntype[u] != mjTRN_JOINTINPARENT) {
      continue;
    }
    const auto found = parts_.trunk.find(m->jnt_bodyid[j]);
    if (found == parts_.trunk.end() || found->first == parts_.root) continue;
    if (found->second == TrunkPart::kLeftClavicle || found->second == TrunkPart::kRightClavicle) {
      continue;
    }
    const bool affine = m->actuator_biastype[u] == mjBIAS_AFFINE;
    if (m->jnt_type[j] != mjJNT_HINGE || m->actuator_dyntype[u] != mjDYN_NONE ||
        m->actuator_gaintype[u] != mjGAIN_FIXED ||
        !(affine || m->actuator_biastype[u] == mjBIAS_NONE)) {
      continue;
    }
    // A damper or velocity servo has no angle to go to.
    const double gear = m->actuator_gear[6 * u], gain = m->actuator_gainprm[mjNGAIN * u];
    const double spring = affine ? -m->actuator_biasprm[mjNBIAS * u + 1] : 0;
    const double damper = affine ? m->actuator_biasprm[mjNBIAS * u + 2] : 0;
    if (gear == 0 || gain == 0 || spring < 0 || (spring == 0 && damper != 0)) continue;
    if (!actuator_of.emplace(j, u).second) continue;
    joints.push_back(j);
  }
  for (auto& [j, group] : trunkJointGroups(joints)) {
    const int u = actuator_of.at(j);
    XMLElement* e = elements[u];
    // Positive: the upper bone turns as ours does.
    double sense = localAxis(j)[group.axis] < 0 ? -1 : 1;
    if (host_.isBelow(parts_.thigh[0], m->jnt_bodyid[j])) sense = -sense;
    const double gear = m->actuator_gear[6 * u], gain = m->actuator_gainprm[mjNGAIN * u];
    const double* bias = m->actuator_biasprm + mjNBIAS * u;
    const bool position = m->actuator_biastype[u] == mjBIAS_AFFINE && bias[1] < 0;
    double slope = sense * (position ? -gain / bias[1] / gear : gain * gear > 0 ? 1 : -1);
    double offset = position ? sense * -bias[0] / bias[1] / gear : 0;
    const bool limited = m->actuator_ctrllimited[u];
    const double control[2] = {limited ? m->actuator_ctrlrange[2 * u] : -1,
                               limited ? m->actuator_ctrlrange[2 * u + 1] : 1};
    // A torque has no angle: its ends become those of the range, both within it. An angle stays
    // what it was, if it is within.
    const std::array<double, 2> range = groupRange(group);
    double factor = INFINITY;
    for (double c : control) {
      const double target = slope * c + offset;
      if (std::abs(target) > 1e-9) {
        factor = std::min(factor, (target > 0 ? range[1] : range[0]) / target);
      }
    }
    if (!std::isfinite(factor)) continue;
    if (position) factor = std::min(factor, 1.0);
    slope *= factor;
    offset *= factor;

    const std::string kept[] = {"name", "group", "user"};
    std::vector<std::string> attributes;
    for (const auto* a = e->FirstAttribute(); a; a = a->Next()) attributes.push_back(a->Name());
    for (const std::string& a : attributes) {
      if (std::find(std::begin(kept), std::end(kept), a) == std::end(kept)) {
        e->DeleteAttribute(a.c_str());
      }
    }
    const std::string was = e->Value();
    e->SetName("general");
    e->SetAttribute("ctrllimited", limited ? "true" : "false");
    e->SetAttribute("ctrlrange", mjcfText({control[0], control[1]}).c_str());
    group.name = nameOrTag(e);
    makeGroup(e, group, slope, offset);
    const auto degrees = [&](double c) { return (slope * c + offset) * 180 / M_PI; };
    note("changed", "actuator", group.name,
         fmt::format("was a {} of the removed joint '{}', is a servo of {} ... {}: {} of {:.1f} to "
                     "{:.1f} deg at ctrl {:g} to {:g}",
                     was, nameOf(m, mjOBJ_JOINT, j), a_.discs[group.first].name,
                     a_.discs[group.last].name, kMotions[group.axis], degrees(control[0]),
                     degrees(control[1]), control[0], control[1]));
  }
}

void Grafter::addGroups() {
  if (!o_.groups) return;
  const int thoracic = discIndex(a_, "T11/T12"), cervical = discIndex(a_, "C7/T1");
  const int last = static_cast<int>(a_.discs.size()) - 1;
  const std::tuple<const char*, int, int> regions[] = {{"lumbar", 0, thoracic - 1},
                                                       {"thoracic", thoracic, cervical - 1},
                                                       {"cervical", cervical, last}};
  XMLElement* actuators = torso_root_->FirstChildElement("actuator");
  tinyxml2::XMLNode* previous = nullptr;
  for (const auto& [region, first, end] : regions) {
    for (int axis : {1, 0, 2}) {
      const SpineGroup group = {ours(std::string(region) + "_" + kMotions[axis]), axis, first, end};
      std::string taken;
      for (int disc = first; disc <= end; disc++) {
        if (taken.empty()) taken = driven_[axis][disc];
      }
      const std::string levels = fmt::format("{} ... {}", a_.discs[first].name, a_.discs[end].name);
      if (!taken.empty()) {
        note("unneeded", "actuator", group.name,
             fmt::format("of {}: the humanoid's '{}' moves levels of it", levels, taken));
        continue;
      }
      XMLElement* e = torso_.NewElement("general");
      previous =
          previous ? actuators->InsertAfterChild(previous, e) : actuators->InsertFirstChild(e);
      const std::array<double, 2> range = groupRange(group);
      e->SetAttribute("name", group.name.c_str());
      e->SetAttribute("ctrllimited", "true");
      e->SetAttribute("ctrlrange", mjcfText({range[0], range[1]}).c_str());
      makeGroup(e, group, 1, 0);
      note("added", "actuator", group.name, "servo of the levels " + levels);
    }
  }
}

}  // namespace torso::tools
