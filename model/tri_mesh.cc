// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/tri_mesh.h"

#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>

namespace torso {

void append(TriMesh& mesh, const TriMesh& part) {
  const int offset = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const auto& f : part.faces) {
    mesh.faces.push_back({f[0] + offset, f[1] + offset, f[2] + offset});
  }
}

TriMesh mirrored(const TriMesh& mesh) {
  TriMesh out = mesh;
  for (auto& v : out.vertices) v.y() = -v.y();
  for (auto& f : out.faces) std::swap(f[1], f[2]);
  return out;
}

TriMesh transformed(const TriMesh& mesh, const Eigen::Affine3d& X) {
  TriMesh out = mesh;
  for (auto& v : out.vertices) v = X * v;
  return out;
}

std::vector<TriMesh> connectedParts(const TriMesh& mesh) {
  std::vector<int> root(mesh.vertices.size());
  for (std::size_t i = 0; i < root.size(); i++) root[i] = static_cast<int>(i);
  const auto find = [&](int i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  for (const auto& f : mesh.faces) {
    root[find(f[0])] = find(f[1]);
    root[find(f[1])] = find(f[2]);
  }
  std::map<int, TriMesh> parts;
  std::vector<int> renamed(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); i++) {
    TriMesh& part = parts[find(static_cast<int>(i))];
    renamed[i] = static_cast<int>(part.vertices.size());
    part.vertices.push_back(mesh.vertices[i]);
  }
  for (const auto& f : mesh.faces) {
    parts[find(f[0])].faces.push_back({renamed[f[0]], renamed[f[1]], renamed[f[2]]});
  }
  std::vector<TriMesh> out;
  for (auto& [r, part] : parts) out.push_back(std::move(part));
  return out;
}

std::string toStl(const TriMesh& mesh) {
  // 80 bytes of header, the number of triangles, then per triangle a normal and three vertices as
  // little-endian floats and two unused bytes.
  std::string bytes(80, '\0');
  std::memcpy(bytes.data(), "mujoco-torso", 12);
  const auto count = static_cast<std::uint32_t>(mesh.faces.size());
  bytes.append(reinterpret_cast<const char*>(&count), 4);
  for (const auto& f : mesh.faces) {
    const Eigen::Vector3d &a = mesh.vertices[f[0]], &b = mesh.vertices[f[1]],
                          &c = mesh.vertices[f[2]];
    const Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
    for (const Eigen::Vector3d& v : {normal, a, b, c}) {
      const Eigen::Vector3f value = v.cast<float>();
      bytes.append(reinterpret_cast<const char*>(value.data()), 12);
    }
    bytes.append(2, '\0');
  }
  return bytes;
}

TriMesh fromStl(const std::string& bytes) {
  constexpr std::size_t kHeader = 84, kTriangle = 50;
  std::uint32_t count = 0;
  if (bytes.size() >= kHeader) std::memcpy(&count, bytes.data() + 80, 4);
  if (bytes.size() < kHeader || bytes.size() != kHeader + kTriangle * count) {
    throw std::invalid_argument("not a binary STL file, or cut short");
  }
  TriMesh mesh;
  std::map<std::array<float, 3>, int> known;
  for (std::uint32_t i = 0; i < count; i++) {
    const char* triangle = bytes.data() + kHeader + kTriangle * i + 12;
    std::array<int, 3> face;
    for (int k = 0; k < 3; k++) {
      std::array<float, 3> v;
      std::memcpy(v.data(), triangle + 12 * k, 12);
      const auto [at, added] = known.try_emplace(v, static_cast<int>(mesh.vertices.size()));
      if (added) mesh.vertices.emplace_back(v[0], v[1], v[2]);
      face[k] = at->second;
    }
    mesh.faces.push_back(face);
  }
  return mesh;
}

}  // namespace torso
