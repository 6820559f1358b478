// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
// What stays of the humanoid and hangs on our bodies: limbs, and cameras, lights and sites of the
// trunk.

#include <fmt/format.h>

#include <algorithm>

#include "model/body.h"
#include "tools/graft_xml.h"
#include "tools/grafter.h"
#include "tools/mjcf.h"

namespace torso::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using tinyxml2::XMLElement;

constexpr const char* kSides[2] = {"left_", "right_"};

}  // namespace

void Grafter::takeLimbs() {
  world_ = nullptr;
  XMLElement* trunk = host_.bodies[parts_.root];
  world_ = trunk->Parent()->ToElement();
  before_ = trunk->PreviousSibling();
  kept_ = Element(host_.root, "worldbody");
  const std::array<int, 4> ids = {parts_.thigh[0], parts_.thigh[1], parts_.upper_arm[0],
                                  parts_.upper_arm[1]};
  // In the order of the file.
  std::array<int, 4> order = {0, 1, 2, 3};
  std::sort(order.begin(), order.end(), [&](int a, int b) { return ids[a] < ids[b]; });
  for (int k : order) {
    XMLElement* limb = host_.bodies[ids[k]];
    const std::string c = effectiveClass(limb);
    if (!c.empty()) limb->SetAttribute("childclass", c.c_str());
    if (text(limb, "name").empty()) fail("an upper arm or thigh has no name");
    kept_->InsertEndChild(limb);
    limbs_[k] = limb;
  }
}

// Cameras, lights and sites of the trunk, to be carried by ours at the same place.
void Grafter::takeCarried() {
  const mjModel* m = host_.model.get();
  for (const auto& [body, part] : parts_.trunk) {
    XMLElement* element = host_.bodies[body];
    const std::string c = effectiveClass(element);
    const std::string onto = replacement(body);
    const Isometry3d shift = ourPose(onto).inverse() * host_.pose(body);
    const auto take = [&](const char* tag, int count, const int* owner, const auto& place) {
      int id = 0;
      for (XMLElement* e = element->FirstChildElement(tag); e;) {
        XMLElement* next = e->NextSiblingElement(tag);
        while (id < count && owner[id] != body) id++;
        place(e, id++);
        if (!c.empty() && !e->Attribute("class")) e->SetAttribute("class", c.c_str());
        kept_->InsertEndChild(e);
        carried_.emplace_back(e, onto);
        note("moved", tag, nameOrTag(e),
             fmt::format("from body '{}' to '{}'", host_.bodyName(body), ours(onto)));
        e = next;
      }
    };
    const auto pose = [&](const mjtNum* pos, const mjtNum* quat, int id) {
      return Isometry3d(
          shift * isometry({quat[4 * id], quat[4 * id + 1], quat[4 * id + 2], quat[4 * id + 3]},
                           {pos[3 * id], pos[3 * id + 1], pos[3 * id + 2]}));
    };
    take("camera", m->ncam, m->cam_bodyid,
         [&](XMLElement* e, int id) { setPose(e, pose(m->cam_pos, m->cam_quat, id)); });
    take("light", m->nlight, m->light_bodyid, [&](XMLElement* e, int id) {
      const mjtNum *p = m->light_pos + 3 * id, *d = m->light_dir + 3 * id;
      e->SetAttribute("pos", mjcfText(shift * Vector3d(p[0], p[1], p[2])).c_str());
      e->SetAttribute("dir",
                      mjcfText(Vector3d(shift.linear() * Vector3d(d[0], d[1], d[2]))).c_str());
    });
    take("site", m->nsite, m->site_bodyid, [&](XMLElement* e, int id) {
      if (e->Attribute("fromto")) {
        const mjtNum* size = m->site_size + 3 * id;
        e->SetAttribute("size", mjcfText({size[0], size[1], size[2]}).c_str());
      }
      setPose(e, pose(m->site_pos, m->site_quat, id));
    });
  }
}

void Grafter::hangLimbs() {
  // Elements of our bodies, before renaming: by name.
  std::array<XMLElement*, 4> onto{};
  for (int k = 0; k < 2; k++) {
    onto[k] = ourBody("pelvis");
    onto[2 + k] = ourBody(std::string(kSides[k]) + "scapula");
  }
  std::vector<XMLElement*> carriers;
  for (const auto& [element, body] : carried_) carriers.push_back(ourBody(body));
  renameClashes();

  std::vector<std::pair<int, int>> order;  // by place in the file
  for (int k = 0; k < 2; k++) {
    order.emplace_back(parts_.thigh[k], k);
    order.emplace_back(parts_.upper_arm[k], 2 + k);
  }
  std::sort(order.begin(), order.end());
  for (const auto& [id, k] : order) {
    Isometry3d world = host_.pose(id);
    std::string parent = "pelvis";
    if (k >= 2) {
      parent = std::string(kSides[k - 2]) + "scapula";
      const Vector3d left = a_.landmark("glenohumeral_centre_GH");
      const Vector3d socket = place_ * (k == 2 ? left : torso::mirror(left));
      world.translation() += socket - parts_.shoulder[k - 2];
    }
    XMLElement* limb = onto[k]->InsertEndChild(limbs_[k]->DeepClone(&torso_))->ToElement();
    setPose(limb, ourPose(parent).inverse() * world);
    note("moved", "body", text(limb, "name"),
         fmt::format(
             "with all that hangs on it, now on '{}'{}", text(onto[k], "name"),
             k < 2
                 ? ", its place unchanged"
                 : fmt::format(", {:.0f} mm from where it was",
                               1e3 * (world.translation() - host_.pose(id).translation()).norm())));
  }
  for (std::size_t i = 0; i < carried_.size(); i++) {
    carriers[i]->InsertEndChild(carried_[i].first->DeepClone(&torso_));
  }
  host_.root->DeleteChild(kept_);
  kept_ = nullptr;
}

}  // namespace torso::tools
