// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
// Default classes: the humanoid's own must not reach into our torso.

#include <set>

#include "tools/graft_xml.h"
#include "tools/grafter.h"
#include "tools/mjcf.h"

namespace torso::tools {
namespace {

using tinyxml2::XMLElement;
using tinyxml2::XMLNode;

// Kinds of objects that have a class attribute.
const std::set<std::string> kClassed = {"geom",     "site", "camera",   "light",  "mesh",
                                        "material", "pair", "equality", "tendon", "actuator"};

}  // namespace

// Our elements would inherit what the host sets in its main default class. So that becomes a class
// of its own, named in every element of the host that used it, and the main class is MuJoCo's.
void Grafter::isolateDefaults() {
  bool used = false;
  std::set<std::string> main_names = {"main"};
  std::set<std::string> classes;
  forEachSection(host_.root, "default", [&](XMLElement* s) {
    if (s->Attribute("class")) main_names.insert(s->Attribute("class"));
    for (XMLElement* e = s->FirstChildElement(); e; e = e->NextSiblingElement()) {
      used |= e->Value() != std::string("default");
    }
    visitNames(s, [&](XMLElement* e, const char* a, const std::string&, bool) {
      classes.insert(e->Attribute(a));
    });
  });
  if (!used) return;
  std::string name = "humanoid";
  while (classes.count(name)) name += "_main";
  XMLElement* top = host_.document.NewElement("default");
  XMLElement* host_main = Element(top, "default").set("class", name);
  XMLElement* first = host_.root->FirstChildElement("default");
  host_.root->InsertAfterChild(first, top);
  forEachSection(host_.root, "default", [&](XMLElement* s) {
    if (s == top) return;
    while (XMLNode* child = s->FirstChild()) host_main->InsertEndChild(child);
    host_.root->DeleteChild(s);
  });
  for (XMLElement* s = host_.root->FirstChildElement(); s; s = s->NextSiblingElement()) {
    if (s == top) continue;
    visitNames(s, [&](XMLElement* e, const char* a, const std::string& kind, bool) {
      if (kind == "class" && main_names.count(e->Attribute(a))) e->SetAttribute(a, name.c_str());
    });
    const std::string tag = s->Value();
    for (XMLElement* e = s->FirstChildElement(); e; e = e->NextSiblingElement()) {
      const std::string kind = definedKind(e, tag);
      const bool is_body = kind == "body";
      const char* attribute = is_body ? "childclass" : "class";
      if ((is_body || kClassed.count(kind)) && !e->Attribute(attribute)) {
        e->SetAttribute(attribute, name.c_str());
      }
    }
  }
  note("changed", "default", name,
       "the humanoid's main default class is now this class, named where it applied, so that it "
       "does not reach into the torso");
}

std::string Grafter::effectiveClass(const XMLElement* e) const {
  for (const XMLNode* n = e; n && n->ToElement(); n = n->Parent()) {
    const char* name = n->ToElement()->Attribute("childclass");
    if (name) return name;
  }
  return "";
}

}  // namespace torso::tools
