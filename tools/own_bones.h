// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "model/facet.h"
#include "model/ligament.h"
#include "model/tri_mesh.h"

namespace torso::tools {

// A person's own bones in place of generated ones.
struct OwnBones {
  std::map<std::string, TriMesh> meshes;   // by body (model/body.h), in the standing body
  std::vector<Facet> facets;               // all of them, as makeFacets
  std::vector<LigamentSegment> ligaments;  // all of them, as makeLigaments
};

}  // namespace torso::tools
