// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/task_scene.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <filesystem>

#include "tools/error.h"
#include "tools/graft_host.h"
#include "tools/graft_xml.h"

namespace torso::tools {

namespace fs = std::filesystem;
using tinyxml2::XMLElement;

std::string sceneMjcf(const std::string& model, const std::string& scene,
                      const std::string& folder) {
  Host host(model);
  for (const char* directory : {"meshdir", "texturedir"}) {
    const fs::path there =
        fs::weakly_canonical(fs::path(host.folder) / setting(host.root, "compiler", directory));
    setSetting(host.root, "compiler", directory,
               there.lexically_relative(fs::weakly_canonical(folder)).string());
  }
  tinyxml2::XMLDocument added;
  if (added.LoadFile(scene.c_str()) != tinyxml2::XML_SUCCESS || !added.RootElement()) {
    throw Error(fmt::format("{}: not an XML file: {}", scene, added.ErrorStr()));
  }
  if (added.RootElement()->Value() != std::string("mujoco")) {
    throw Error(scene + ": not MJCF, its root element is not <mujoco>");
  }
  for (const XMLElement* e = added.RootElement()->FirstChildElement(); e;
       e = e->NextSiblingElement()) {
    host.root->InsertEndChild(e->DeepClone(&host.document));
  }
  tinyxml2::XMLPrinter printer;
  host.document.Print(&printer);
  return printer.CStr();
}

}  // namespace torso::tools
