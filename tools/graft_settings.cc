// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
// Compiler, option and size, which both have.

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <functional>

#include "tools/graft_xml.h"
#include "tools/grafter.h"
#include "tools/mjcf.h"

namespace torso::tools {
namespace {

using tinyxml2::XMLElement;

}  // namespace

void Grafter::checkSettings() {
  if (setting(host_.root, "compiler", "coordinate") == "global") {
    fail(
        "<compiler coordinate=\"global\"> is not supported; save the model with MuJoCo first, "
        "which writes local coordinates");
  }
  forEachSection(host_.root, "custom", [&](XMLElement* s) {
    for (XMLElement* e = s->FirstChildElement("numeric"); e; e = e->NextSiblingElement("numeric")) {
      if (text(e, "name") == ours("mujoco_torso")) {
        fail("it has a torso of ours already; give a second one a --prefix");
      }
    }
  });
}

// What the compiler does to masses and inertias it would do to ours, too: vertebrae are lighter
// than usual bounds. So the humanoid's bodies get what it had made of them, and it stops.
void Grafter::freezeInertias() {
  XMLElement* root = host_.root;
  std::string set;
  for (const char* attribute : {"boundmass", "boundinertia", "settotalmass", "balanceinertia"}) {
    const std::string value = setting(root, "compiler", attribute);
    if (value.empty() || value == "false" || std::atof(value.c_str()) < 0) continue;
    setSetting(root, "compiler", attribute,
               attribute == std::string("balanceinertia") ? "false"
               : attribute == std::string("settotalmass") ? "-1"
                                                          : "0");
    set += std::string(set.empty() ? "" : ", ") + attribute;
  }
  if (set.empty()) return;
  note("changed", "compiler", set,
       "no longer, for it would change the torso; the humanoid's bodies have what it made of them "
       "as their <inertial>");
  const mjModel* m = host_.model.get();
  for (int b = 1; b < m->nbody; b++) {
    if (parts_.trunk.count(b) || m->body_mass[b] <= 0) continue;
    XMLElement* e = host_.bodies[b];
    if (XMLElement* old = e->FirstChildElement("inertial")) e->DeleteChild(old);
    const mjtNum *p = m->body_ipos + 3 * b, *q = m->body_iquat + 4 * b,
                 *inertia = m->body_inertia + 3 * b;
    XMLElement* inertial = e->GetDocument()->NewElement("inertial");
    e->InsertFirstChild(inertial);
    inertial->SetAttribute("pos", fmt::format("{:.9g} {:.9g} {:.9g}", p[0], p[1], p[2]).c_str());
    inertial->SetAttribute(
        "quat", fmt::format("{:.9g} {:.9g} {:.9g} {:.9g}", q[0], q[1], q[2], q[3]).c_str());
    inertial->SetAttribute("mass", fmt::format("{:.9g}", m->body_mass[b]).c_str());
    inertial->SetAttribute(
        "diaginertia",
        fmt::format("{:.9g} {:.9g} {:.9g}", inertia[0], inertia[1], inertia[2]).c_str());
  }
}

void Grafter::mergeSettings() {
  XMLElement* root = host_.root;
  const auto change = [&](const char* tag, const char* attribute, const std::string& value,
                          const std::string& why = "") {
    const std::string before = setting(root, tag, attribute);
    if (before == value) return;
    setSetting(root, tag, attribute, value);
    note("changed", tag, attribute,
         fmt::format("{} -> {}{}", before.empty() ? "default" : before, value, why));
  };
  XMLElement* option = torso_root_->FirstChildElement("option");
  const double step = numbers(option, "timestep").at(0);
  if (o_.timestep > 0) {
    change("option", "timestep", mjcfText(o_.timestep));
  } else if (host_.model->opt.timestep > step) {
    change("option", "timestep", text(option, "timestep"));
  } else if (host_.model->opt.timestep < 0.9 * step) {
    note("kept", "option", "timestep",
         fmt::format("{:g} s, finer than the torso needs; --timestep {:.3g} would be {:.1f} times "
                     "faster",
                     host_.model->opt.timestep, step, step / host_.model->opt.timestep));
  }
  // Four evaluations of a step gain nothing: the torso's implicit rows are first order in the step.
  if (host_.model->opt.integrator == mjINT_RK4 && !o_.keep_integrator) {
    change("option", "integrator", "Euler",
           ", four times as fast, as the torso is of first order in the step anyway; "
           "--keep-integrator keeps it");
  }
  change("option", "solver", text(option, "solver"));
  change("option", "jacobian", text(option, "jacobian"));
  // The plugin's rows are unknown to noslip; facets are contact pairs.
  if (host_.model->opt.noslip_iterations > 0) change("option", "noslip_iterations", "0");
  if (host_.model->opt.collision == mjCOL_DYNAMIC) change("option", "collision", "all");

  XMLElement* size = torso_root_->FirstChildElement("size");
  for (const auto* a = size->FirstAttribute(); a; a = a->Next()) {
    const std::string name = a->Name();
    const int own = a->IntValue();
    const std::string before = setting(root, "size", a->Name());
    const int theirs = before.empty() ? 0 : std::max(0, std::atoi(before.c_str()));
    if (name == "nuserdata") {
      XMLElement* custom = torso_root_->FirstChildElement("custom");
      for (XMLElement* e = custom->FirstChildElement("numeric"); e;
           e = e->NextSiblingElement("numeric")) {
        if (text(e, "name") != ours("mujoco_torso")) continue;
        const double format = std::atof(e->Attribute("data"));
        e->SetAttribute("data", mjcfText({format, 0, static_cast<double>(theirs)}).c_str());
      }
    }
    const bool sum = name == "njmax" || name == "nconmax" || name == "nuserdata";
    change("size", a->Name(), std::to_string(sum ? own + theirs : std::max(own, theirs)));
  }
  if (setting(root, "compiler", "inertiafromgeom") == "true") {
    change("compiler", "inertiafromgeom", "auto");
    std::function<void(XMLElement*)> clean = [&](XMLElement* parent) {
      for (XMLElement* e = parent->FirstChildElement("body"); e;
           e = e->NextSiblingElement("body")) {
        clean(e);
        // Ours have no geom with a mass, theirs never used it.
        XMLElement* inertial = e->FirstChildElement("inertial");
        if (!inertial) continue;
        e->DeleteChild(inertial);
        note("removed", "inertial", text(e, "name"), "inertiafromgeom had overridden it");
      }
    };
    forEachSection(root, "worldbody", clean);
    for (int k = 0; k < 4; k++) clean(limbs_[k]);
  }
  freezeInertias();
}

}  // namespace torso::tools
