// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/build_models.h"

#include "model/body.h"
#include "tools/files.h"
#include "tools/torso_mjcf.h"

namespace torso::tools {
namespace {

void save(const tinyxml2::XMLDocument& document, const std::string& path) {
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  writeFile(path, printer.CStr());
}

void saveBody(const Anatomy& anatomy, const MjcfOptions& options, const std::string& path) {
  tinyxml2::XMLDocument document;
  writeMjcf(anatomy, options, document);
  save(document, path);
}

}  // namespace

void buildModels(const Anatomy& anatomy, const std::string& folder, const OwnBones* own) {
  makeFolder(folder + "/assets");
  MjcfOptions torso, human;
  torso.own = human.own = own;
  human.limbs = true;
  human.scene = true;
  for (const std::string& body : mjcfBodies(anatomy, human)) {
    std::vector<BonePart> parts;
    if (own && own->meshes.count(body)) {
      parts = {{Tissue::kBone, own->meshes.at(body)}};
    } else {
      parts = boneMesh(anatomy, body);
    }
    for (const BonePart& part : parts) {
      const TriMesh local = transformed(part.mesh, bodyFrame(anatomy, body).inverse());
      writeFile(folder + "/assets/" + boneMeshName(body, part.tissue) + ".stl", toStl(local));
    }
  }
  tinyxml2::XMLDocument scene;
  writeScene(scene);
  save(scene, folder + "/scene.xml");
  tinyxml2::XMLDocument held;
  writeHeldScene(held);
  save(held, folder + "/torso_held.xml");
  saveBody(anatomy, torso, folder + "/torso.xml");
  saveBody(anatomy, human, folder + "/human.xml");
  human.kind = TorsoKind::kFixed;
  saveBody(anatomy, human, folder + "/human_fixed.xml");
}

}  // namespace torso::tools
