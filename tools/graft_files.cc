// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
// Files: paths relative to the output, bone meshes, and the writing.

#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

#include "model/body.h"
#include "model/bone_mesh.h"
#include "tools/files.h"
#include "tools/graft_xml.h"
#include "tools/grafter.h"
#include "tools/mjcf.h"
#include "tools/torso_mjcf.h"

namespace torso::tools {
namespace {

namespace fs = std::filesystem;
using tinyxml2::XMLDocument;
using tinyxml2::XMLElement;

}  // namespace

// File names relative to the folder that the MJCF will be in.
void Grafter::placeFiles(XMLElement* root, const std::string& folder) const {
  const fs::path target = fs::weakly_canonical(folder);  // relative paths stop at links
  const bool strip = setting(root, "compiler", "strippath") == "true";
  const auto directory = [&](const char* attribute) {
    const fs::path there = fs::path(host_.folder) / setting(root, "compiler", attribute);
    return fs::weakly_canonical(there);
  };
  const fs::path meshes = directory("meshdir"), textures = directory("texturedir");
  bool mesh_files = false, texture_files = false;
  forEachSection(root, "asset", [&](XMLElement* asset) {
    for (XMLElement* e = asset->FirstChildElement(); e; e = e->NextSiblingElement()) {
      const std::string tag = e->Value();
      for (const char* attribute :
           {"file", "fileright", "fileleft", "fileup", "filedown", "filefront", "fileback"}) {
        const std::string file = text(e, attribute);
        if (file.empty() || file.rfind(std::string(kGraftAssets) + "/", 0) == 0) continue;
        if (strip) e->SetAttribute(attribute, fs::path(file).filename().c_str());
        (tag == "texture" ? texture_files : mesh_files) = true;
      }
    }
  });
  fs::path mesh_folder = target;
  if (strip) setSetting(root, "compiler", "strippath", "false");
  if (mesh_files || !setting(root, "compiler", "meshdir").empty()) {
    mesh_folder = meshes;
    const std::string relative = meshes.lexically_relative(target).string();
    if (relative != ".") setSetting(root, "compiler", "meshdir", relative);
  }
  if (texture_files) {
    const std::string relative = textures.lexically_relative(target).string();
    if (relative != ".") setSetting(root, "compiler", "texturedir", relative);
  }
  const std::string assets = (target / kGraftAssets).lexically_relative(mesh_folder).string();
  forEachSection(root, "asset", [&](XMLElement* asset) {
    for (XMLElement* e = asset->FirstChildElement("mesh"); e; e = e->NextSiblingElement("mesh")) {
      const std::string file = text(e, "file");
      if (file.rfind(std::string(kGraftAssets) + "/", 0) != 0) continue;
      e->SetAttribute("file", (fs::path(assets) / fs::path(file).filename()).c_str());
    }
  });
}

// Writes document and meshes, the document last.
void Grafter::write(const std::string& path, const Files& meshes) const {
  XMLDocument placed;
  host_.document.DeepCopy(&placed);
  const fs::path folder = fs::absolute(path).parent_path();
  placeFiles(placed.RootElement(), folder.string());
  if (!fs::is_directory(folder)) throw Error(path + ": cannot write: no such folder");
  if (fs::is_directory(path)) throw Error(path + ": cannot write: this is a folder");
  const fs::path assets = folder / kGraftAssets;
  std::vector<fs::path> made;  // taken away again if one cannot be written
  try {
    if (!fs::exists(assets)) made.push_back(assets);
    makeFolder(assets.string());
    for (const auto& [name, content] : meshes) {
      if (!fs::exists(assets / name)) made.push_back(assets / name);
      writeFile((assets / name).string(), content);
    }
    tinyxml2::XMLPrinter printer;
    placed.Print(&printer);
    writeFile(path, printer.CStr());
  } catch (const Error&) {
    std::error_code error;
    while (!made.empty()) {
      fs::remove(made.back(), error);
      made.pop_back();
    }
    throw;
  }
}

}  // namespace torso::tools
