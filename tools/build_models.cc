// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/build_models.h"

#include "tools/bone_files.h"
#include "tools/torso_mjcf.h"

namespace torso::tools {
namespace {

using Files = std::map<std::string, std::string>;

std::string text(const tinyxml2::XMLDocument& document) {
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return printer.CStr();
}

std::string bodyText(const Anatomy& anatomy, const MjcfOptions& options) {
  tinyxml2::XMLDocument document;
  writeMjcf(anatomy, options, document);
  return text(document);
}

}  // namespace

Files buildModels(const Anatomy& anatomy, int threads,
                  const std::function<void(double)>& progress) {
  MjcfOptions human;
  human.limbs = true;
  human.scene = true;
  const Skeleton skeleton(anatomy, mjcfBodies(anatomy, human), threads, progress);
  human.skeleton = &skeleton;
  Files files;
  for (auto& [name, content] : boneFiles(anatomy, skeleton)) files["assets/" + name] = content;
  tinyxml2::XMLDocument scene, held;
  writeScene(scene);
  files["scene.xml"] = text(scene);
  writeHeldScene(held);
  files["torso_held.xml"] = text(held);
  MjcfOptions torso;
  torso.skeleton = &skeleton;
  files["torso.xml"] = bodyText(anatomy, torso);
  files["human.xml"] = bodyText(anatomy, human);
  human.kind = TorsoKind::kFixed;
  files["human_fixed.xml"] = bodyText(anatomy, human);
  return files;
}

}  // namespace torso::tools
