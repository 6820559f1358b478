// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
// What our torso meets.

#include <algorithm>
#include <set>

#include "tools/graft_xml.h"
#include "tools/grafter.h"
#include "tools/mjcf.h"

namespace torso::tools {
namespace {

using tinyxml2::XMLElement;

}  // namespace

// Ours meets what the humanoid's trunk met. As in the torso's own file, spine and trunk have no
// contype; trunk and head also have one bit for the head to meet the trunk.
void Grafter::adaptContactBits() {
  const mjModel* m = host_.model.get();
  int world_bits = 0, used = 0;
  std::set<int> unmet;
  for (int g = 0; g < m->ngeom; g++) {
    used |= m->geom_contype[g] | m->geom_conaffinity[g];
    if (parts_.trunk.count(m->geom_bodyid[g])) continue;
    for (const auto& [body, part] : parts_.trunk) {
      for (int t = m->body_geomadr[body];
           t >= 0 && t < m->body_geomadr[body] + m->body_geomnum[body]; t++) {
        if (m->geom_contype[g] & m->geom_conaffinity[t]) {
          world_bits |= m->geom_contype[g];
        } else if (m->geom_contype[t] & m->geom_conaffinity[g]) {
          unmet.insert(g);
        }
      }
    }
  }
  int own_bit = 2;
  while (own_bit & used) own_bit *= 2;
  for (int g : unmet) {
    if (m->geom_contype[g] & world_bits) continue;
    note("changed", "geom", nameOf(m, mjOBJ_GEOM, g),
         "no longer meets the torso: its contype is not among those that the torso answers to");
  }
  for (XMLElement* c = torso_root_->FirstChildElement("default")->FirstChildElement("default"); c;
       c = c->NextSiblingElement("default")) {
    const std::string name = text(c, "class").substr(o_.prefix.size());
    XMLElement* geom = c->FirstChildElement("geom");
    if (name == "spine" || name == "trunk" || name == "limb") {
      geom->SetAttribute("contype", name == "limb" ? own_bit : 0);
      geom->SetAttribute("conaffinity", name == "spine" ? world_bits : world_bits | own_bit);
    }
  }
}

void Grafter::exclude(const std::string& one, const std::string& two, const char* why) {
  if (!excluded_.insert(std::minmax(one, two)).second) return;
  XMLElement* contact = section(host_.root, "contact");
  Element(contact, "exclude").set("body1", one).set("body2", two);
  note("added", "exclude", one + ", " + two, why);
}

// Name of a body of the result, which gets one if it has none.
std::string Grafter::namedBody(const mjModel* m, int body) {
  const char* has = mj_id2name(m, mjOBJ_BODY, body);
  if (has && *has) return has;
  std::vector<XMLElement*> bodies = {nullptr};
  forEachSection(host_.root, "worldbody", [&](XMLElement* s) { listBodies(s, bodies); });
  XMLElement* e = bodies.at(static_cast<std::size_t>(body));
  if (text(e, "name").empty()) {
    std::string name = "body" + std::to_string(body);
    while (mj_name2id(m, mjOBJ_BODY, name.c_str()) >= 0) name += "_";
    e->SetAttribute("name", name.c_str());
    note("changed", "body", name, "had no name, which an <exclude> needs");
  }
  return text(e, "name");
}

void Grafter::excludeOverlaps(const mjModel* m) {
  const DataPtr d = makeData(m);
  mj_fwdPosition(m, d.get());
  for (int i = 0; i < d->ncon; i++) {
    const int g1 = d->contact[i].geom1, g2 = d->contact[i].geom2;
    const int b1 = m->geom_bodyid[g1], b2 = m->geom_bodyid[g2];
    const bool by_bits = (m->geom_contype[g1] & m->geom_conaffinity[g2]) ||
                         (m->geom_contype[g2] & m->geom_conaffinity[g1]);
    if (!by_bits || b1 == 0 || b2 == 0) continue;  // a contact pair, or with the surroundings
    const std::string one = namedBody(m, b1), two = namedBody(m, b2);
    const auto theirs = [&](const std::string& name) {
      return mj_name2id(host_.model.get(), mjOBJ_BODY, name.c_str()) > 0 &&
             !removed_.count({"body", name});
    };
    if (theirs(one) && theirs(two)) continue;
    exclude(one, two, "they touch in the pose qpos0");
  }
}

}  // namespace torso::tools
