// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/build_models.h"

#include <filesystem>
#include <utility>

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

// The person's own bones, and the others made.
Skeleton skeletonOf(const Anatomy& anatomy, const std::vector<std::string>& bodies, int threads,
                    const std::function<void(double)>& progress, const OwnBones* own) {
  std::vector<std::string> made;
  for (const std::string& body : bodies) {
    if (!own || !own->meshes.count(body)) made.push_back(body);
  }
  Skeleton generated(anatomy, made, threads, progress);
  if (!own) return generated;
  std::map<std::string, std::vector<BonePart>> parts;
  for (const std::string& body : made) parts[body] = generated.parts(body);
  for (const auto& [body, mesh] : own->meshes) parts[body] = {{Tissue::kBone, mesh}};
  return Skeleton(std::move(parts));
}

}  // namespace

std::string humanFile(TorsoKind kind) {
  return kind == TorsoKind::kDetailed ? "human.xml"
         : kind == TorsoKind::kFixed  ? "human_fixed.xml"
                                      : "human_simple.xml";
}

std::string humanBeside(const std::string& human, TorsoKind kind) {
  std::filesystem::path path(human);
  const std::string suffix = std::filesystem::path(humanFile(kind)).stem().string().substr(5);
  path.replace_filename(path.stem().string() + suffix + path.extension().string());
  return std::filesystem::exists(path) ? path.string() : "";
}

Files buildModels(const Anatomy& anatomy, int threads, const std::function<void(double)>& progress,
                  const OwnBones* own, bool muscles, const std::set<TorsoKind>& kinds) {
  MjcfOptions torso, human;
  torso.muscles = human.muscles = muscles;
  human.limbs = true;
  human.scene = true;
  const Skeleton skeleton = skeletonOf(anatomy, mjcfBodies(anatomy, human), threads, progress, own);
  torso.skeleton = human.skeleton = &skeleton;
  torso.own = human.own = own;
  Files files;
  for (auto& [name, content] : boneFiles(anatomy, skeleton)) files["assets/" + name] = content;
  tinyxml2::XMLDocument scene, held;
  writeScene(scene);
  files["scene.xml"] = text(scene);
  writeHeldScene(held);
  if (kinds.count(TorsoKind::kDetailed)) {
    files["torso.xml"] = mjcfText(anatomy, torso);
    files["torso_held.xml"] = text(held);
  }
  for (const TorsoKind kind : kinds) {
    human.kind = kind;
    files[humanFile(kind)] = mjcfText(anatomy, human);
  }
  return files;
}

}  // namespace torso::tools
