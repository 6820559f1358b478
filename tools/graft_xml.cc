// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/graft_xml.h"

#include <sstream>

#include "tools/mjcf.h"

namespace torso::tools {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using tinyxml2::XMLElement;

std::string text(const XMLElement* e, const char* attribute) {
  const char* value = e->Attribute(attribute);
  return value ? value : "";
}

std::string nameOrTag(const XMLElement* e) {
  const std::string name = text(e, "name");
  return name.empty()
             ? std::string("<") + e->Value() + "> in line " + std::to_string(e->GetLineNum())
             : name;
}

// Numbers of an attribute, `missing` if it is not there.
std::vector<double> numbers(const XMLElement* e, const char* attribute,
                            const std::vector<double>& missing) {
  if (!e->Attribute(attribute)) return missing;
  std::istringstream in(e->Attribute(attribute));
  std::vector<double> values;
  for (double x; in >> x;) values.push_back(x);
  return values;
}

Isometry3d isometry(const Quaterniond& rotation, const Vector3d& position) {
  Isometry3d X(rotation.normalized());
  X.translation() = position;
  return X;
}

// Sets pos and quat, whatever else gave the orientation before.
void setPose(XMLElement* e, const Isometry3d& X) {
  for (const char* other : {"axisangle", "xyaxes", "zaxis", "euler", "fromto"}) {
    e->DeleteAttribute(other);
  }
  e->SetAttribute("pos", mjcfText(Vector3d(X.translation())).c_str());
  const Quaterniond q(X.linear());
  if (q.vec().norm() > 1e-9) {
    e->SetAttribute("quat", mjcfText(q.w() < 0 ? Quaterniond(-q.coeffs()) : q).c_str());
  } else {
    e->DeleteAttribute("quat");
  }
}

void forEachSection(XMLElement* root, const char* name,
                    const std::function<void(XMLElement*)>& visit) {
  for (XMLElement* s = root->FirstChildElement(name); s;) {
    XMLElement* next = s->NextSiblingElement(name);
    visit(s);
    s = next;
  }
}

// The first section of that name, made if there is none.
XMLElement* section(XMLElement* root, const char* name) {
  XMLElement* s = root->FirstChildElement(name);
  return s ? s : static_cast<XMLElement*>(Element(root, name));
}

// The value of an attribute over all sections of that name: the last one counts.
std::string setting(XMLElement* root, const char* name, const char* attribute) {
  std::string value;
  forEachSection(root, name, [&](XMLElement* s) {
    if (s->Attribute(attribute)) value = s->Attribute(attribute);
  });
  return value;
}

void setSetting(XMLElement* root, const char* name, const char* attribute,
                const std::string& value) {
  section(root, name);
  forEachSection(root, name, [&](XMLElement* s) { s->DeleteAttribute(attribute); });
  section(root, name)->SetAttribute(attribute, value.c_str());
}

}  // namespace torso::tools
