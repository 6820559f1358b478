// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/retrofit_model.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <functional>
#include <set>
#include <vector>

#include "model/body.h"
#include "tools/error.h"
#include "tools/files.h"
#include "tools/graft_xml.h"
#include "tools/mjcf.h"

namespace torso::tools {
namespace {

using tinyxml2::XMLElement;

// Share of mass and inertia that is left, see torsoOnHolds: at a step of 5 ms the inertia of a
// vertebra is then 1 to 10 Nm/rad and that of the rib cage 4 kN/m, less than what holds them.
constexpr double kMassShare = 0.01;

constexpr double kStep = 0.005;  // [s]

constexpr double kLeftOut = 1e-3;  // of the stiffness of a disc that is left out

// All elements below e; the visitor returns false to have the element deleted.
void sweep(XMLElement* e, const std::function<bool(XMLElement*)>& keep) {
  for (XMLElement *child = e->FirstChildElement(), *next; child; child = next) {
    next = child->NextSiblingElement();
    if (keep(child)) {
      sweep(child, keep);
    } else {
      e->DeleteChild(child);
    }
  }
}

XMLElement* findBody(XMLElement* root, const std::string& name) {
  XMLElement* found = nullptr;
  sweep(root, [&](XMLElement* e) {
    if (e->Name() == std::string("body") && text(e, "name") == name) found = e;
    return true;
  });
  return found;
}

// What is only there to be seen, or to touch a floor.
void strip(XMLElement* root, bool servos) {
  std::set<std::string> facet_geoms;
  sweep(root, [&](XMLElement* e) {
    if (e->Name() == std::string("pair")) {
      facet_geoms.insert(text(e, "geom1"));
      facet_geoms.insert(text(e, "geom2"));
    }
    return true;
  });
  static const std::set<std::string> kUnseen = {"include",  "skin",   "mesh",   "sensor",
                                                "keyframe", "camera", "exclude"};
  sweep(root, [&](XMLElement* e) {
    const std::string tag = e->Name();
    if (kUnseen.count(tag) || (tag == "actuator" && !servos)) return false;
    if (tag == "element" && text(e, "objtype") == "skin") return false;
    const bool in_default = e->Parent()->ToElement()->Name() == std::string("default");
    return tag != "geom" || in_default || facet_geoms.count(text(e, "name")) > 0;
  });
}

// Leads a body by a mocap body at its place, with the plugin's implicit spring.
void addHold(XMLElement* root, const std::string& body, const double pose[7], double stiffness,
             double rotation_stiffness) {
  const std::string name = "hold:" + body;
  Element(section(root, "worldbody"), "body")
      .set("name", name)
      .set("mocap", "true")
      .set("pos", {pose[0], pose[1], pose[2]})
      .set("quat", {pose[3], pose[4], pose[5], pose[6]});
  Element(section(root, "equality"), "weld")
      .set("name", name)
      .set("body1", body)
      .set("body2", name)
      .set("anchor", "0 0 0")
      .set("torquescale", 0.3);
  XMLElement* custom = section(root, "custom");
  Element(custom, "numeric")
      .set("name", "bushing:" + name)
      .set("data", {stiffness, 0, rotation_stiffness, 0});
  Element tuple(custom, "tuple");
  tuple.set("name", "bushing:" + name);
  Element(tuple, "element").set("objtype", "equality").set("objname", name).set("prm", 0);
  Element(tuple, "element")
      .set("objtype", "numeric")
      .set("objname", "bushing:" + name)
      .set("prm", 0);
}

void scale(XMLElement* e, const char* attribute, double factor) {
  std::string scaled;
  for (double x : numbers(e, attribute)) scaled += fmt::format("{:.9g} ", x * factor);
  if (!scaled.empty()) e->SetAttribute(attribute, scaled.c_str());
}

// Of a joint that Rhythm leads, null for others.
const double* rhythmStiffness(const std::string& joint) {
  const std::string name = splitSide(joint).second;
  if (name == "head") return &kRhythmStiffness.head;
  if (name == "sternoclavicular") return &kRhythmStiffness.sternoclavicular;
  if (name == "acromioclavicular") return &kRhythmStiffness.acromioclavicular;
  return nullptr;
}

void makeLight(XMLElement* root, const SpineParts& parts) {
  sweep(root, [&parts](XMLElement* e) {
    const std::string tag = e->Name();
    if (tag == "inertial") {
      for (const char* what : {"mass", "fullinertia", "diaginertia"}) scale(e, what, kMassShare);
    } else if (tag == "joint" && text(e, "type") == "ball") {
      // MuJoCo's joint springs are explicit. In a step from rest this inertia does what the
      // linearly implicit part of the spring would. (Joint dampers would not: MuJoCo takes them
      // into account only after it has solved for the constraints.)
      double stiffness = numbers(e, "stiffness", {0}).at(0);
      if (const double* led = rhythmStiffness(text(e, "name"))) {
        stiffness = *led;
        e->SetAttribute("stiffness", "0");
      }
      e->SetAttribute("damping", "0");
      e->SetAttribute("armature", mjcfNumber(kStep * kStep * stiffness).c_str());
    } else if (tag == "numeric") {
      // As in plugin/instance.h: entries 0, 2, 5 and 6 of a disc are its moduli, the last one is
      // its retardation time; a bushing has stiffness and damping of translation, and of rotation.
      std::vector<double> data = numbers(e, "data");
      if (text(e, "name").rfind("disc:", 0) == 0 && data.size() == 8) {
        data.back() = 0;
        for (const int modulus : {0, 2, 5, 6}) data[modulus] *= parts.discs ? 1 : kLeftOut;
      }
      if (text(e, "name").rfind("bushing:", 0) == 0 && data.size() == 4) data[1] = data[3] = 0;
      e->SetAttribute("data", fmt::format("{}", fmt::join(data, " ")).c_str());
    }
    return true;
  });
}

// Of the servos only those of the levels, for SpineRhythm.
void keepLevelServos(XMLElement* root) {
  sweep(section(root, "actuator"), [](XMLElement* e) {
    if (text(e, "refsite").empty()) return false;
    const double kp = kLevelServoShare * numbers(e, "gainprm").at(0);
    e->SetAttribute("gainprm", mjcfNumber(kp).c_str());
    e->SetAttribute("biasprm", fmt::format("0 {} 0 0", mjcfNumber(-kp)).c_str());
    e->DeleteAttribute("forcerange");
    e->SetAttribute("ctrllimited", "false");
    return true;
  });
}

void parse(tinyxml2::XMLDocument& document, const std::string& text, const std::string& path) {
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS ||
      !document.RootElement()) {
    throw Error(fmt::format("{}: not an MJCF file", path));
  }
}

ModelPtr compile(const tinyxml2::XMLDocument& document, const std::string& name) {
  tinyxml2::XMLPrinter printer(nullptr, true);
  document.Print(&printer);
  return compileModel(printer.CStr(), name);
}

}  // namespace

BodyMjcf::BodyMjcf(const std::string& path) : BodyMjcf(readFile(path), path) {}

BodyMjcf::BodyMjcf(const std::string& mjcf, const std::string& name) : name_(name) {
  tinyxml2::XMLDocument document;
  parse(document, mjcf, name);
  XMLElement* root = document.RootElement();
  std::vector<std::string> needed = {"pelvis", "ribcage"};
  needed.insert(needed.end(), kHeldBones.begin(), kHeldBones.end());
  for (const std::string& body : needed) {
    if (!findBody(root, body)) {
      throw Error(fmt::format(
          "{}: no body '{}'; give a whole body as torso build writes it (human.xml)", name, body));
    }
  }
  strip(root, true);
  tinyxml2::XMLPrinter printer(nullptr, true);
  document.Print(&printer);
  text_ = printer.CStr();
}

ModelPtr BodyMjcf::human() const {
  tinyxml2::XMLDocument document;
  parse(document, text_, name_);
  return compile(document, "human");
}

std::vector<double> BodyMjcf::restPosesOf(const std::vector<std::string>& bodies) const {
  tinyxml2::XMLDocument document;
  parse(document, text_, name_);
  XMLElement* root = document.RootElement();
  // Nothing of these has a say in it, and compiling them takes time.
  for (const char* name : {"actuator", "contact", "tendon", "equality", "custom"}) {
    while (XMLElement* section = root->FirstChildElement(name)) root->DeleteChild(section);
  }
  const ModelPtr m = compile(document, "body");
  const DataPtr d = makeData(m.get());
  mj_kinematics(m.get(), d.get());
  std::vector<double> poses;
  for (const std::string& body : bodies) {
    const int id = mj_name2id(m.get(), mjOBJ_BODY, body.c_str());
    poses.insert(poses.end(), d->xpos + 3 * id, d->xpos + 3 * id + 3);
    poses.insert(poses.end(), d->xquat + 4 * id, d->xquat + 4 * id + 4);
  }
  return poses;
}

ModelPtr BodyMjcf::torsoOnHolds(const SpineParts& parts) const {
  tinyxml2::XMLDocument document;
  parse(document, text_, name_);
  XMLElement* root = document.RootElement();
  strip(root, true);
  keepLevelServos(root);
  const std::vector<std::string> held(kHeldBones.begin(), kHeldBones.end());
  const std::vector<double> poses = restPosesOf(held);
  XMLElement* pelvis = findBody(root, "pelvis");
  pelvis->DeleteChild(pelvis->FirstChildElement("freejoint"));
  static const std::set<std::string> kGone = {"thigh", "lower_arm"};
  sweep(root, [](XMLElement* e) {
    return e->Name() != std::string("body") || !kGone.count(splitSide(text(e, "name")).second);
  });
  makeLight(root, parts);
  for (std::size_t i = 0; i < held.size(); i++) {
    addHold(root, held[i], poses.data() + 7 * i, kHoldStiffness, kHoldRotationStiffness);
  }
  ModelPtr m = compile(document, "torso_on_holds");
  m->opt.timestep = kStep;
  m->opt.disableflags |= mjDSBL_GRAVITY | mjDSBL_SENSOR;
  // SpineRhythm turns bones against each other, which without discs nothing keeps in line.
  if (!parts.discs) m->opt.disableflags |= mjDSBL_ACTUATION;
  for (int i = 0; i < m->ntendon && !parts.ligaments; i++) m->tendon_limited[i] = 0;
  torsoOf(m.get(), name_);
  return m;
}

ModelPtr BodyMjcf::pelvisOnHold() const {
  tinyxml2::XMLDocument document;
  parse(document, text_, name_);
  XMLElement* root = document.RootElement();
  const std::vector<double> pose = restPosesOf({"pelvis"});
  // As good as rigid.
  addHold(root, "pelvis", pose.data(), 1e6, 1e5);
  ModelPtr m = compile(document, "pelvis_on_hold");
  torsoOf(m.get(), name_);
  return m;
}

}  // namespace torso::tools
