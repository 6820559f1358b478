// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

namespace torso {

// Triangle surface; faces are counter-clockwise seen from outside.
struct TriMesh {
  std::vector<Eigen::Vector3d> vertices;  // [m]
  std::vector<std::array<int, 3>> faces;
};

void append(TriMesh& mesh, const TriMesh& part);
TriMesh mirrored(const TriMesh& mesh);                               // y -> -y
TriMesh transformed(const TriMesh& mesh, const Eigen::Affine3d& X);  // x -> X x
std::vector<TriMesh> connectedParts(const TriMesh& mesh);
// The bytes of a binary STL file.
std::string toStl(const TriMesh& mesh);
// The mesh of such a file, identical vertices joined. Throws std::invalid_argument if the bytes are
// none.
TriMesh fromStl(const std::string& bytes);

}  // namespace torso
