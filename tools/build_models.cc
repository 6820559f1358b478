// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/build_models.h"

#include <filesystem>
#include <stdexcept>

#include "model/body.h"
#include "tools/torso_mjcf.h"

namespace torso::tools {
namespace {

namespace fs = std::filesystem;

template <typename Write>
void writeWhole(const fs::path& path, Write write) {
  const fs::path part = path.string() + ".part";
  write(part.string());
  fs::rename(part, path);
}

void save(tinyxml2::XMLDocument& document, const fs::path& path) {
  writeWhole(path, [&](const std::string& file) {
    if (document.SaveFile(file.c_str()) != tinyxml2::XML_SUCCESS) {
      throw std::runtime_error(path.string() + ": cannot write (is the folder writable?)");
    }
  });
}

void saveBody(const Anatomy& anatomy, const MjcfOptions& options, const fs::path& path) {
  tinyxml2::XMLDocument document;
  writeMjcf(anatomy, options, document);
  save(document, path);
}

}  // namespace

void buildModels(const Anatomy& anatomy, const std::string& folder) {
  const fs::path out(folder), assets = out / "assets";
  std::error_code failed;
  fs::create_directories(assets, failed);
  if (failed) throw std::runtime_error(assets.string() + ": cannot make this folder");

  MjcfOptions human;
  human.limbs = true;
  human.scene = true;
  for (const std::string& body : mjcfBodies(anatomy, human)) {
    for (const BonePart& part : boneMesh(anatomy, body)) {
      const TriMesh local = transformed(part.mesh, bodyFrame(anatomy, body).inverse());
      writeWhole(assets / (boneMeshName(body, part.tissue) + ".stl"),
                 [&](const std::string& file) { writeStl(local, file); });
    }
  }
  tinyxml2::XMLDocument scene;
  writeScene(scene);
  save(scene, out / "scene.xml");
  saveBody(anatomy, MjcfOptions(), out / "torso.xml");
  saveBody(anatomy, human, out / "human.xml");
  human.kind = TorsoKind::kFixed;
  saveBody(anatomy, human, out / "human_fixed.xml");
}

}  // namespace torso::tools
