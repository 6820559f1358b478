// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/disc.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>
#include <set>

namespace torso {
namespace {

using Eigen::Vector3d;

double signedVolume(const DiscMesh& mesh, const std::array<int, 4>& t) {
  const Vector3d& a = mesh.rest_positions[t[0]];
  return (mesh.rest_positions[t[1]] - a)
             .cross(mesh.rest_positions[t[2]] - a)
             .dot(mesh.rest_positions[t[3]] - a) /
         6;
}

// Faces of one tet, seen from outside counter-clockwise.
constexpr int kFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

}  // namespace

std::string checkDiscMesh(const DiscMesh& mesh) {
  const int n = static_cast<int>(mesh.rest_positions.size());
  for (int i = 0; i < n; ++i) {
    if (!mesh.rest_positions[i].allFinite()) {
      return "node " + std::to_string(i) + ": position is not finite";
    }
  }
  if (mesh.tets.empty()) return "the mesh has no tets";

  std::vector<int> part(n);  // union-find over nodes that share a tet
  std::iota(part.begin(), part.end(), 0);
  const auto root = [&](int i) {
    while (part[i] != i) i = part[i] = part[part[i]];
    return i;
  };
  std::vector<bool> used(n, false);
  for (size_t e = 0; e < mesh.tets.size(); ++e) {
    const auto& t = mesh.tets[e];
    const std::string name = "tet " + std::to_string(e);
    for (int i : t) {
      if (i < 0 || i >= n) {
        return name + ": node index " + std::to_string(i) + " is out of range (" +
               std::to_string(n) + " nodes)";
      }
    }
    double edge = 0;
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < a; ++b) {
        edge = std::max(edge, (mesh.rest_positions[t[a]] - mesh.rest_positions[t[b]]).norm());
      }
    }
    const double relative = signedVolume(mesh, t) / (edge * edge * edge);
    if (!(std::abs(relative) > 1e-6)) return name + " is degenerate (no volume)";
    if (relative < 0) return name + " is inverted (negative volume)";
    for (int i : t) {
      used[i] = true;
      part[root(i)] = root(t[0]);
    }
  }
  for (int i = 0; i < n; ++i) {
    if (!used[i]) return "node " + std::to_string(i) + " belongs to no tet";
  }

  if (mesh.cells.size() != mesh.tets.size()) {
    return std::to_string(mesh.cells.size()) + " cell numbers for " +
           std::to_string(mesh.tets.size()) + " tets";
  }
  const int ncell = static_cast<int>(mesh.hoops.size());
  std::vector<bool> filled(ncell, false);
  for (size_t e = 0; e < mesh.cells.size(); ++e) {
    const int c = mesh.cells[e];
    if (c == DiscMesh::kNucleus) continue;
    if (c < 0 || c >= ncell) {
      return "tet " + std::to_string(e) + ": cell " + std::to_string(c) + " is out of range (" +
             std::to_string(ncell) + " hoops)";
    }
    filled[c] = true;
  }
  for (int c = 0; c < ncell; ++c) {
    const std::string name = "cell " + std::to_string(c);
    if (!filled[c]) return name + " has no tets";
    for (int i : mesh.hoops[c]) {
      if (i < 0 || i >= n) {
        return name + ": hoop node " + std::to_string(i) + " is out of range (" +
               std::to_string(n) + " nodes)";
      }
    }
    const Vector3d hoop =
        mesh.rest_positions[mesh.hoops[c][1]] - mesh.rest_positions[mesh.hoops[c][0]];
    if (!(hoop.head<2>().norm() > 1e-6 * hoop.norm() && hoop.norm() > 0)) {
      return name + ": its hoop runs along the disc's axis or has no length";
    }
  }

  std::vector<bool> attached(n, false);
  std::map<int, std::vector<Vector3d>> anchors;  // by part
  for (const auto* nodes : {&mesh.lower_nodes, &mesh.upper_nodes}) {
    const std::string set = nodes == &mesh.lower_nodes ? "lower" : "upper";
    if (nodes->empty()) return "no node is attached to the " + set + " endplate";
    for (int i : *nodes) {
      const std::string name = set + " attached node " + std::to_string(i);
      if (i < 0 || i >= n) return name + " is out of range (" + std::to_string(n) + " nodes)";
      if (attached[i]) return name + " is attached twice";
      attached[i] = true;
      anchors[root(i)].push_back(mesh.rest_positions[i]);
    }
  }
  // A part that fewer than three attached nodes hold, or three in a line, can turn freely.
  const auto held = [](const std::vector<Vector3d>& points) {
    double area = 0, size = 0;
    for (size_t i = 1; i < points.size(); ++i) {
      size = std::max(size, (points[i] - points[0]).norm());
      for (size_t j = 1; j < i; ++j) {
        area = std::max(area, (points[i] - points[0]).cross(points[j] - points[0]).norm());
      }
    }
    return area > 1e-6 * size * size;
  };
  std::set<int> sound;
  for (size_t e = 0; e < mesh.tets.size(); ++e) {
    const int r = root(mesh.tets[e][0]);
    if (sound.count(r)) continue;
    if (!held(anchors[r])) {
      return "tet " + std::to_string(e) +
             " is in a part of the mesh that hangs on no endplate (three attached nodes, not in a "
             "line, must hold each part)";
    }
    sound.insert(r);
  }
  return "";
}

std::string checkDiscMaterial(const DiscMaterial& m) {
  struct Range {
    const char* name;
    double value, low, high;
    bool open_low, open_high;
  };
  for (const Range& r : {
           Range{"Young's modulus of the annulus", m.annulus_modulus, 0, 1e12, true, false},
           Range{"Poisson's ratio of the annulus", m.annulus_poisson, 0, 0.5, false, true},
           Range{"modulus of the fibres", m.fibre_modulus, 0, 1e12, false, false},
           Range{"stiffening of the fibres", m.fibre_stiffening, 0, 1e6, false, false},
           Range{"angle of the fibres", m.fibre_angle, 0, M_PI / 2, false, false},
           Range{"Young's modulus of the nucleus", m.nucleus_modulus, 0, 1e12, true, false},
           Range{"bulk modulus of the nucleus", m.nucleus_bulk_modulus, 0, 1e12, true, false},
       }) {
    const bool low = r.open_low ? r.value > r.low : r.value >= r.low;
    const bool high = r.open_high ? r.value < r.high : r.value <= r.high;
    if (low && high) continue;
    char text[128];
    std::snprintf(text, sizeof text, "%s %g is not in %c%g, %g%c", r.name, r.value,
                  r.open_low ? '(' : '[', r.low, r.high, r.open_high ? ')' : ']');
    return text;
  }
  return "";
}

DiscMaterial homogeneousMaterial(double youngs_modulus, double poissons_ratio) {
  DiscMaterial m = {};
  m.annulus_modulus = youngs_modulus;
  m.annulus_poisson = poissons_ratio;
  // The nucleus' modulus is that of an incompressible material, 3 mu.
  m.nucleus_modulus = 1.5 * youngs_modulus / (1 + poissons_ratio);
  m.nucleus_bulk_modulus = youngs_modulus / (3 * (1 - 2 * poissons_ratio));
  return m;
}

Vector3d upperEndplateAreaVector(const DiscMesh& mesh) {
  const std::set<int> upper(mesh.upper_nodes.begin(), mesh.upper_nodes.end());
  std::map<std::array<int, 3>, int> count;  // tets at each face of three upper nodes
  std::map<std::array<int, 3>, Vector3d> area;
  for (const auto& t : mesh.tets) {
    for (const auto& f : kFaces) {
      std::array<int, 3> face = {t[f[0]], t[f[1]], t[f[2]]};
      if (!upper.count(face[0]) || !upper.count(face[1]) || !upper.count(face[2])) continue;
      const Vector3d& a = mesh.rest_positions[face[0]];
      const Vector3d normal =
          (mesh.rest_positions[face[1]] - a).cross(mesh.rest_positions[face[2]] - a) / 2;
      std::sort(face.begin(), face.end());
      ++count[face];
      area[face] = normal;
    }
  }
  Vector3d sum = Vector3d::Zero();
  for (const auto& [face, normal] : area) {
    if (count[face] == 1) sum += normal;
  }
  return sum;
}

double upperEndplateArea(const DiscMesh& mesh) { return upperEndplateAreaVector(mesh).norm(); }

}  // namespace torso
