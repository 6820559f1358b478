// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/build_models.h"

#include <thread>

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

void buildModels(const Anatomy& anatomy, const std::string& folder) {
  makeFolder(folder + "/assets");
  MjcfOptions human;
  human.limbs = true;
  human.scene = true;
  const Skeleton skeleton(anatomy, mjcfBodies(anatomy, human),
                          static_cast<int>(std::thread::hardware_concurrency()));
  human.skeleton = &skeleton;
  for (const std::string& body : skeleton.bodies()) {
    for (const BonePart& part : skeleton.parts(body)) {
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
  MjcfOptions torso;
  torso.skeleton = &skeleton;
  saveBody(anatomy, torso, folder + "/torso.xml");
  saveBody(anatomy, human, folder + "/human.xml");
  human.kind = TorsoKind::kFixed;
  saveBody(anatomy, human, folder + "/human_fixed.xml");
}

}  // namespace torso::tools
