// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
// Our torso, made to fit the humanoid.

#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <thread>

#include "tools/bone_files.h"
#include "tools/graft_xml.h"
#include "tools/grafter.h"
#include "tools/mjcf.h"
#include "tools/torso_mjcf.h"

namespace torso::tools {
namespace {

using tinyxml2::XMLElement;
using tinyxml2::XMLNode;

}  // namespace

void Grafter::writeTorso() {
  const std::vector<std::string> bodies = mjcfBodies(table_size_, MjcfOptions());
  if (o_.meshes.empty()) {
    bones_.emplace(table_size_, bodies, static_cast<int>(std::thread::hardware_concurrency()));
  } else {
    bones_ = readSkeleton(table_size_, o_.meshes, bodies);
  }
  const Skeleton skeleton = scaled(*bones_, report_.length_scale);
  MjcfOptions mjcf;
  mjcf.skeleton = &skeleton;
  mjcf.prefix = o_.prefix;
  mjcf.mesh_scale = report_.length_scale;
  mjcf.mesh_dir = kGraftAssets;
  mjcf.height = 1;  // any but 0, for the standing height; taken off again in adaptTorso
  writeMjcf(a_, mjcf, torso_);
  torso_root_ = torso_.RootElement();
  adaptTorso();
  adaptContactBits();
}

XMLElement* Grafter::ourBody(const std::string& name) {
  std::function<XMLElement*(XMLElement*)> find = [&](XMLElement* parent) -> XMLElement* {
    for (XMLElement* e = parent->FirstChildElement("body"); e; e = e->NextSiblingElement("body")) {
      if (text(e, "name") == ours(name)) return e;
      if (XMLElement* below = find(e)) return below;
    }
    return nullptr;
  };
  return find(torso_root_->FirstChildElement("worldbody"));
}

// Where it stands, and what its own file's compiler settings meant.
void Grafter::adaptTorso() {
  XMLElement* world = torso_root_->FirstChildElement("worldbody");
  for (XMLElement* body = world->FirstChildElement("body"); body;
       body = body->NextSiblingElement("body")) {
    const std::string name = text(body, "name").substr(o_.prefix.size());
    setPose(body, ourPose(name));
  }
  const bool radian = setting(host_.root, "compiler", "angle") == "radian";
  std::function<void(XMLElement*)> joints = [&](XMLElement* parent) {
    for (XMLElement* e = parent->FirstChildElement(); e; e = e->NextSiblingElement()) {
      joints(e);
      if (e->Value() != std::string("joint") || !e->Attribute("range")) continue;
      e->SetAttribute("limited", "true");
      if (!radian) continue;
      const std::vector<double> range = numbers(e, "range");
      e->SetAttribute("range", mjcfText({range[0], range[1] * M_PI / 180}).c_str());
    }
  };
  joints(world);
  for (XMLElement* c = torso_root_->FirstChildElement("default")->FirstChildElement("default"); c;
       c = c->NextSiblingElement("default")) {
    for (XMLElement* e = c->FirstChildElement("tendon"); e; e = e->NextSiblingElement("tendon")) {
      e->SetAttribute("limited", "true");
    }
  }
  XMLElement* actuators = torso_root_->FirstChildElement("actuator");
  for (XMLElement* e = actuators->FirstChildElement(); e; e = e->NextSiblingElement()) {
    e->SetAttribute("ctrllimited", "true");
    e->SetAttribute("forcelimited", "true");
  }
  // Arms in the humanoid's order.
  if (parts_.upper_arm[1] < parts_.upper_arm[0]) {
    XMLElement* left = ourBody("left_clavicle");
    XMLElement* right = ourBody("right_clavicle");
    XMLNode* cage = left->Parent();
    XMLNode* previous = left->PreviousSibling();
    if (previous) {
      cage->InsertAfterChild(previous, right);
    } else {
      cage->InsertFirstChild(right);
    }
  }
}

// Ours gives way where both have an object of one kind and name.
void Grafter::renameClashes() {
  const std::set<MjcfName> theirs = definedNames(host_.root), own = definedNames(torso_root_);
  std::map<MjcfName, std::string> renamed;
  for (const MjcfName& n : own) {
    if (!theirs.count(n) && !(n.first == "class" && n.second == "main")) continue;
    std::string name = "torso_" + n.second;
    while (theirs.count({n.first, name}) || own.count({n.first, name})) name = "torso_" + name;
    renamed[n] = name;
    note("renamed", n.first, n.second, "the torso's own is now '" + name + "'");
  }
  if (renamed.empty()) return;
  for (XMLElement* s = torso_root_->FirstChildElement(); s; s = s->NextSiblingElement()) {
    visitNames(s, [&](XMLElement* e, const char* a, const std::string& kind, bool) {
      const auto found = renamed.find({kind, e->Attribute(a)});
      if (found != renamed.end()) e->SetAttribute(a, found->second.c_str());
    });
  }
}

}  // namespace torso::tools
