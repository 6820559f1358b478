// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <tinyxml2.h>

#include "tools/bone_files.h"
#include "tools/performer.h"
#include "tools/torso_mjcf.h"

namespace torso::tools {

std::string performerMjcf(const Anatomy& tables, const Performer& performer,
                          const std::string& meshes, const std::string& mesh_dir) {
  // Discs, ligaments and facets lie on the trunk's bones only.
  const Skeleton bones = scaled(readSkeleton(tables, meshes, mjcfBodies(tables, MjcfOptions())),
                                performer.torso_scale);
  MjcfOptions options;
  options.limbs = true;
  options.skeleton = &bones;
  options.mesh_scale = performer.torso_scale;
  options.limb_scale = performer.limb_scale;
  options.mesh_dir = mesh_dir;
  return mjcfText(performer.anatomy, options);
}

}  // namespace torso::tools
