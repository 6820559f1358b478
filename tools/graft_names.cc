// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/graft_names.h"

#include <map>

namespace torso::tools {
namespace {

using tinyxml2::XMLElement;

// Attributes that refer to an object of one kind, whatever their element. An asset or a default
// named in an attribute of its own tag ("mesh" of a geom) is here too.
const std::map<std::string, std::string>& referringAttributes() {
  static const std::map<std::string, std::string> attributes = {
      {"body", "body"},           {"body1", "body"},        {"body2", "body"},
      {"target", "body"},         {"joint", "joint"},       {"joint1", "joint"},
      {"joint2", "joint"},        {"geom", "geom"},         {"geom1", "geom"},
      {"jointinparent", "joint"}, {"geom2", "geom"},        {"site", "site"},
      {"refsite", "site"},        {"cranksite", "site"},    {"slidersite", "site"},
      {"sidesite", "site"},       {"tendon", "tendon"},     {"tendon1", "tendon"},
      {"tendon2", "tendon"},      {"actuator", "actuator"}, {"mesh", "mesh"},
      {"texture", "texture"},     {"material", "material"}, {"hfield", "hfield"},
      {"class", "class"},         {"childclass", "class"}};
  return attributes;
}

// Kind that an objtype or reftype names: "xbody" is a body too.
std::string objectKind(const XMLElement* element, const char* type_attribute) {
  const char* type = element->Attribute(type_attribute);
  if (!type) return "";
  return std::string(type) == "xbody" ? "body" : type;
}

void visit(XMLElement* element, const std::string& section, const NameVisitor& visitor) {
  const std::string kind = definedKind(element, section);
  const bool is_default = section == "default" && element->Value() == std::string("default");
  if (!kind.empty() && element->Attribute("name")) visitor(element, "name", kind, true);
  // The visitor may change values but not the list of attributes.
  for (const auto* a = element->FirstAttribute(); a; a = a->Next()) {
    const std::string name = a->Name();
    const auto found = referringAttributes().find(name);
    if (found != referringAttributes().end()) {
      visitor(element, a->Name(), found->second, is_default && name == "class");
    } else if (name == "objname") {
      visitor(element, "objname", objectKind(element, "objtype"), false);
    } else if (name == "refname") {
      visitor(element, "refname", objectKind(element, "reftype"), false);
    }
  }
  for (XMLElement* e = element->FirstChildElement(); e; e = e->NextSiblingElement()) {
    visit(e, section, visitor);
  }
}

}  // namespace

std::string definedKind(const XMLElement* element, const std::string& section) {
  const std::string tag = element->Value();
  const XMLElement* parent = element->Parent() ? element->Parent()->ToElement() : nullptr;
  const bool top = parent && parent->Value() == section;
  if (section == "worldbody") {
    if (tag == "freejoint") return "joint";
    for (const char* kind : {"body", "joint", "geom", "site", "camera", "light"}) {
      if (tag == kind) return kind;
    }
    return "";
  }
  if (!top) return "";
  if (section == "tendon" || section == "actuator" || section == "sensor" ||
      section == "equality") {
    return section;
  }
  if (section == "asset" || section == "custom" || section == "contact" || section == "keyframe") {
    return tag;
  }
  return "";
}

void visitNames(XMLElement* section, const NameVisitor& visitor) {
  const std::string tag = section->Value();
  for (XMLElement* e = section->FirstChildElement(); e; e = e->NextSiblingElement()) {
    visit(e, tag, visitor);
  }
  // The top-level default is a class itself.
  if (tag == "default" && section->Attribute("class")) visitor(section, "class", "class", true);
}

std::set<MjcfName> definedNames(XMLElement* root) {
  std::set<MjcfName> names;
  for (XMLElement* s = root->FirstChildElement(); s; s = s->NextSiblingElement()) {
    visitNames(s, [&](XMLElement* e, const char* attribute, const std::string& kind, bool defines) {
      if (defines) names.emplace(kind, e->Attribute(attribute));
    });
  }
  return names;
}

}  // namespace torso::tools
