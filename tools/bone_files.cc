// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/bone_files.h"

#include <fstream>
#include <sstream>

#include "model/body.h"
#include "tools/error.h"
#include "tools/torso_mjcf.h"

namespace torso::tools {

std::map<std::string, std::string> boneFiles(const Anatomy& anatomy, const Skeleton& skeleton) {
  std::map<std::string, std::string> files;
  for (const std::string& body : skeleton.bodies()) {
    for (const BonePart& part : skeleton.parts(body)) {
      files[boneMeshName(body, part.tissue) + ".stl"] =
          toStl(transformed(part.mesh, bodyFrame(anatomy, body).inverse()));
    }
  }
  return files;
}

std::vector<std::string> spineBodies(const Anatomy& anatomy) {
  std::vector<std::string> bodies = {"pelvis", "head"};
  for (const Vertebra& v : anatomy.vertebrae) bodies.push_back(v.name);
  return bodies;
}

Skeleton readSkeleton(const Anatomy& anatomy, const std::string& folder,
                      const std::vector<std::string>& bodies) {
  std::map<std::string, std::vector<BonePart>> parts;
  for (const std::string& body : bodies) {
    for (const Tissue tissue : boneTissues(anatomy, body)) {
      const std::string path = folder + "/" + boneMeshName(body, tissue) + ".stl";
      std::ifstream file(path, std::ios::binary);
      std::ostringstream content;
      content << file.rdbuf();
      if (!file) throw Error(path + ": cannot read this bone mesh; run `torso build`");
      try {
        TriMesh mesh = fromStl(content.str());
        for (Eigen::Vector3d& v : mesh.vertices) v *= anatomy.length_scale;
        parts[body].push_back({tissue, transformed(mesh, bodyFrame(anatomy, body))});
      } catch (const std::invalid_argument& e) {
        throw Error(path + ": " + e.what() + "; run `torso build`");
      }
    }
  }
  return Skeleton(std::move(parts));
}

}  // namespace torso::tools
