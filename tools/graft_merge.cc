// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
// Humanoid and torso in one document.

#include <fmt/format.h>

#include <filesystem>

#include "tools/graft_xml.h"
#include "tools/grafter.h"
#include "tools/mjcf.h"

namespace torso::tools {
namespace {

namespace fs = std::filesystem;
using tinyxml2::XMLElement;
using tinyxml2::XMLNode;

}  // namespace

// MuJoCo wants actuators without activation, as ours, before those with.
XMLElement* Grafter::firstStatefulActuator() const {
  XMLElement* first = nullptr;
  forEachSection(host_.root, "actuator", [&](XMLElement* s) {
    for (XMLElement* e = s->FirstChildElement(); e && !first; e = e->NextSiblingElement()) {
      if (stateful_.count(e)) first = e;
    }
  });
  return first;
}

void Grafter::merge() {
  XMLElement* root = host_.root;
  for (XMLElement* s = torso_root_->FirstChildElement(); s; s = s->NextSiblingElement()) {
    const std::string tag = s->Value();
    if (tag == "compiler" || tag == "option" || tag == "size") continue;
    if (tag == "worldbody") {
      XMLNode* last = before_;
      for (XMLElement* e = s->FirstChildElement(); e; e = e->NextSiblingElement()) {
        XMLNode* clone = e->DeepClone(&host_.document);
        last = last ? world_->InsertAfterChild(last, clone) : world_->InsertFirstChild(clone);
      }
      continue;
    }
    XMLElement* into = section(root, tag.c_str());
    XMLNode* last = into->LastChild();
    if (XMLElement* stateful = tag == "actuator" ? firstStatefulActuator() : nullptr) {
      into = stateful->Parent()->ToElement();
      last = stateful->PreviousSibling();
    }
    for (XMLElement* e = s->FirstChildElement(); e; e = e->NextSiblingElement()) {
      XMLNode* clone = e->DeepClone(&host_.document);
      last = last ? into->InsertAfterChild(last, clone) : into->InsertFirstChild(clone);
    }
  }
  XMLNode* comment = host_.document.NewComment(
      fmt::format(" Made by `torso graft` from {}: the torso of mujoco-torso in the place of its "
                  "trunk. ",
                  fs::path(o_.input).filename().string())
          .c_str());
  XMLNode* first = host_.document.FirstChild();
  if (first->ToDeclaration()) {
    host_.document.InsertAfterChild(first, comment);
  } else {
    host_.document.InsertFirstChild(comment);
  }
}

}  // namespace torso::tools
