// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Triangle surfaces from files of other programs.

#include <string>
#include <vector>

#include "model/tri_mesh.h"

namespace torso::tools {

struct NamedMesh {
  std::string file;  // path as given to readMeshFile
  std::string name;  // of the object in the file; "" if it has none
  TriMesh mesh;      // in the file's own units and axes; vertices as the file lists them
};

// True for a file name that ends like one of the formats that readMeshFile knows.
bool isMeshFile(const std::string& path);

// The objects of a file: VTP (VTK PolyData in XML with ASCII arrays, as OpenSim ships it), and what
// assimp reads: OBJ, STL, PLY, glTF, ... Polygons become triangles; an object's place in the file's
// scene is applied. Throws Error "<path>: ..." for a file that cannot be read, is cut short, has no
// triangles, or has a coordinate that is no finite number.
std::vector<NamedMesh> readMeshFile(const std::string& path);

}  // namespace torso::tools
