// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
// The trunk goes, and with it what refers to it.

#include <fmt/format.h>

#include <algorithm>

#include "tools/graft_xml.h"
#include "tools/grafter.h"
#include "tools/mjcf.h"

namespace torso::tools {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using tinyxml2::XMLElement;
using tinyxml2::XMLNode;

}  // namespace

void Grafter::removeTrunk() {
  const mjModel* m = host_.model.get();
  const Matrix3d axes = place_.linear();
  for (const auto& [body, part] : parts_.trunk) {
    note("replaced", "body", host_.bodyName(body),
         fmt::format("{:.3f} kg, by '{}'", m->body_mass[body], ours(replacement(body))));
    if (body == parts_.root && m->body_jntnum[body] == 0) {
      note("changed", "body", host_.bodyName(body),
           "was fixed to the world; '" + ours("pelvis") + "' is free");
    }
    for (int j = m->body_jntadr[body]; j >= 0 && j < m->body_jntadr[body] + m->body_jntnum[body];
         j++) {
      std::string by = "by the joints of the spine";
      if (body == parts_.root) {
        by = "by the free joint '" + ours("pelvis") + "'";
      } else if (m->jnt_type[j] == mjJNT_HINGE) {
        const mjtNum* a = host_.data->xaxis + 3 * j;
        const Vector3d local = (axes.transpose() * Vector3d(a[0], a[1], a[2])).cwiseAbs();
        const char* motion = local.y() > std::max(local.x(), local.z()) ? "flexion"
                             : local.x() > local.z()                    ? "lateral_bending"
                                                                        : "axial_rotation";
        const TrunkPart p = parts_.trunk.at(body);
        const bool high = p == TrunkPart::kNeck || p == TrunkPart::kHead;
        by = p == TrunkPart::kLeftClavicle || p == TrunkPart::kRightClavicle
                 ? "by the servos of the sternoclavicular and acromioclavicular joints"
                 : fmt::format("by the {} of the levels {} of the spine, each with a servo", motion,
                               high ? "C7/T1 ... C2/C3" : "L5/S1 ... T1/T2");
      }
      note("replaced", "joint", nameOf(m, mjOBJ_JOINT, j), by);
    }
    for (int g = m->body_geomadr[body]; g >= 0 && g < m->body_geomadr[body] + m->body_geomnum[body];
         g++) {
      note("removed", "geom", nameOf(m, mjOBJ_GEOM, g), "on body '" + host_.bodyName(body) + "'");
    }
  }
  XMLElement* trunk = host_.bodies[parts_.root];
  XMLElement* aside = Element(host_.root, "worldbody");
  aside->InsertEndChild(trunk);
  visitNames(aside, [&](XMLElement* e, const char* a, const std::string& kind, bool d) {
    if (d) removed_.emplace(kind, e->Attribute(a));
  });
  host_.root->DeleteChild(aside);
}

// True if it removed something that has a name.
bool Grafter::dropReferences(XMLElement* list, const std::string& tag) {
  bool named = false;
  for (XMLElement* e = list->FirstChildElement(); e;) {
    XMLElement* next = e->NextSiblingElement();
    std::string missing;
    XMLElement* holder = Element(host_.root, tag.c_str());
    XMLNode* previous = e->PreviousSibling();
    holder->InsertEndChild(e);
    visitNames(holder, [&](XMLElement* r, const char* a, const std::string& kind, bool defines) {
      const std::string name = r->Attribute(a);
      if (defines || !removed_.count({kind, name})) return;
      const std::string attribute = a;
      if (kind == "body" && (attribute == "target" || tag == "sensor" || tag == "custom")) {
        const std::string by = bodyName(replacement(name));
        r->SetAttribute(a, by.c_str());
        const bool subtree = std::string(e->Value()).rfind("subtree", 0) == 0;
        note("changed", tag == "worldbody" ? e->Value() : tag, nameOrTag(e),
             fmt::format("{} '{}' is now '{}'{}", attribute, name, by,
                         subtree ? ", and so no longer all the body" : ""));
        return;
      }
      missing += fmt::format("{}{} '{}'", missing.empty() ? "" : ", ", kind, name);
    });
    if (previous) {
      list->InsertAfterChild(previous, e);
    } else {
      list->InsertFirstChild(e);
    }
    host_.root->DeleteChild(holder);
    if (!missing.empty()) {
      const std::string kind = definedKind(e, tag);
      std::string detail = "refers to the removed " + missing;
      for (GraftChange& c : report_.changes) {
        if (tag == "actuator" && c.kind == "joint" && c.action == "replaced" &&
            c.name == text(e, "joint")) {
          detail += ", replaced " + c.detail;
        }
      }
      note("removed", kind.empty() ? tag : kind, nameOrTag(e), detail);
      if (e->Attribute("name")) named |= removed_.emplace(kind, e->Attribute("name")).second;
      list->DeleteChild(e);
    }
    e = next;
  }
  return named;
}

void Grafter::dropReferences() {
  for (bool again = true; again;) {
    again = false;
    for (const char* tag :
         {"worldbody", "asset", "contact", "equality", "tendon", "actuator", "sensor", "custom"}) {
      forEachSection(host_.root, tag, [&](XMLElement* s) { again |= dropReferences(s, tag); });
    }
  }
}

}  // namespace torso::tools
