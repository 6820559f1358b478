// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/build_models.h"

#include <algorithm>
#include <mutex>
#include <vector>

#include "model/body.h"
#include "model/parallel.h"
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

// Bones of a body and, if it is a left one, of its mirror image.
Files boneFiles(const Anatomy& anatomy, const std::string& body) {
  Files files;
  const auto add = [&](const std::string& of, Tissue tissue, const TriMesh& mesh) {
    files["assets/" + boneMeshName(of, tissue) + ".stl"] =
        toStl(transformed(mesh, bodyFrame(anatomy, of).inverse()));
  };
  const auto [side, name] = splitSide(body);
  for (const BonePart& part : boneMesh(anatomy, body)) {
    add(body, part.tissue, part.mesh);
    if (side == Side::kLeft) add("right_" + name, part.tissue, mirrored(part.mesh));
  }
  return files;
}

}  // namespace

Files buildModels(const Anatomy& anatomy, int threads,
                  const std::function<void(double)>& progress) {
  MjcfOptions human;
  human.limbs = true;
  human.scene = true;
  std::vector<std::string> bodies;
  for (const std::string& body : mjcfBodies(anatomy, human)) {
    if (splitSide(body).first != Side::kRight) bodies.push_back(body);
  }
  // The largest first, so that none is left over at the end.
  const auto isLarge = [](const std::string& body) {
    return body == "pelvis" || body == "head" || body == "ribcage";
  };
  std::stable_partition(bodies.begin(), bodies.end(), isLarge);

  Files files;
  std::mutex mutex;
  int done = 0;
  const int n = static_cast<int>(bodies.size());
  forEach(n, threads, [&](int i) {
    Files bones = boneFiles(anatomy, bodies[i]);
    const std::lock_guard<std::mutex> lock(mutex);
    files.merge(bones);
    done++;
    if (progress) progress(done / double(n));
  });

  tinyxml2::XMLDocument scene, held;
  writeScene(scene);
  files["scene.xml"] = text(scene);
  writeHeldScene(held);
  files["torso_held.xml"] = text(held);
  files["torso.xml"] = bodyText(anatomy, MjcfOptions());
  files["human.xml"] = bodyText(anatomy, human);
  human.kind = TorsoKind::kFixed;
  files["human_fixed.xml"] = bodyText(anatomy, human);
  return files;
}

}  // namespace torso::tools
