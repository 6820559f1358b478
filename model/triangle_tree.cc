// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace torso {
namespace {

using Eigen::Vector3d;

// Weights of the nearest point of a triangle (Ericson, Real-Time Collision Detection, 5.1.5).
Vector3d nearestWeights(const Vector3d& p, const Vector3d& a, const Vector3d& b,
                        const Vector3d& c) {
  const Vector3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp),
               d6 = ac.dot(cp);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - w, w};
  }
  return Vector3d(va, vb, vc) / (va + vb + vc);
}

double angle(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

TriangleTree::TriangleTree(const TriMesh& mesh) : mesh_(mesh), order_(mesh.faces.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  build(0, static_cast<int>(order_.size()));
  vertex_normal_.assign(mesh.vertices.size(), Vector3d::Zero());
  std::map<std::pair<int, int>, Vector3d> edges;
  const auto edge = [](const std::array<int, 3>& f, int k) {
    return std::minmax(f[(k + 1) % 3], f[(k + 2) % 3]);
  };
  for (const auto& f : mesh.faces) {
    const Vector3d v[3] = {mesh.vertices[f[0]], mesh.vertices[f[1]], mesh.vertices[f[2]]};
    const Vector3d normal = (v[1] - v[0]).cross(v[2] - v[0]).normalized();
    for (int k = 0; k < 3; k++) {
      vertex_normal_[f[k]] += angle(v[(k + 1) % 3] - v[k], v[(k + 2) % 3] - v[k]) * normal;
      edges.emplace(edge(f, k), Vector3d::Zero()).first->second += normal;
    }
  }
  for (const auto& f : mesh.faces) {
    edge_normal_.push_back({edges[edge(f, 0)], edges[edge(f, 1)], edges[edge(f, 2)]});
  }
}

int TriangleTree::build(int begin, int end) {
  const int index = static_cast<int>(nodes_.size());
  nodes_.push_back({Eigen::AlignedBox3d(), begin, end, -1, -1});
  for (int i = begin; i < end; i++) {
    for (int v : mesh_.faces[order_[i]]) nodes_[index].box.extend(mesh_.vertices[v]);
  }
  if (end - begin <= 4) return index;
  int axis;
  nodes_[index].box.sizes().maxCoeff(&axis);
  const auto centre = [&](int face) {
    const auto& f = mesh_.faces[face];
    return mesh_.vertices[f[0]][axis] + mesh_.vertices[f[1]][axis] + mesh_.vertices[f[2]][axis];
  };
  const int middle = (begin + end) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](int a, int b) { return centre(a) < centre(b); });
  const int left = build(begin, middle), right = build(middle, end);
  nodes_[index].left = left;
  nodes_[index].right = right;
  return index;
}

void TriangleTree::search(int node, const Vector3d& p, Nearest& best) const {
  const Node& n = nodes_[node];
  if (n.left < 0) {
    for (int i = n.begin; i < n.end; i++) {
      const auto& f = mesh_.faces[order_[i]];
      const Vector3d &a = mesh_.vertices[f[0]], &b = mesh_.vertices[f[1]],
                     &c = mesh_.vertices[f[2]];
      const Vector3d w = nearestWeights(p, a, b, c);
      const double d = (p - w[0] * a - w[1] * b - w[2] * c).norm();
      if (d < best.distance) best = {order_[i], w, d};
    }
    return;
  }
  int near = n.left, far = n.right;
  double near_distance = nodes_[near].box.exteriorDistance(p),
         far_distance = nodes_[far].box.exteriorDistance(p);
  if (far_distance < near_distance) {
    std::swap(near, far);
    std::swap(near_distance, far_distance);
  }
  if (near_distance < best.distance) search(near, p, best);
  if (far_distance < best.distance) search(far, p, best);
}

TriangleTree::Nearest TriangleTree::nearest(const Vector3d& p) const {
  Nearest best{0, Vector3d(1, 0, 0), std::numeric_limits<double>::infinity()};
  search(0, p, best);
  return best;
}

double TriangleTree::signedDistance(const Vector3d& p) const {
  const Nearest near = nearest(p);
  const auto& f = mesh_.faces[near.face];
  Vector3d point = Vector3d::Zero();
  int zeros = 0, zero = 0, corner = 0;
  for (int k = 0; k < 3; k++) {
    point += near.weights[k] * mesh_.vertices[f[k]];
    if (near.weights[k] < 1e-12) {
      zeros++;
      zero = k;
    } else {
      corner = k;
    }
  }
  const Vector3d &a = mesh_.vertices[f[0]], &b = mesh_.vertices[f[1]], &c = mesh_.vertices[f[2]];
  const Vector3d normal = zeros == 2   ? vertex_normal_[f[corner]]
                          : zeros == 1 ? edge_normal_[near.face][zero]
                                       : Vector3d((b - a).cross(c - a));
  return (p - point).dot(normal) < 0 ? -near.distance : near.distance;
}

}  // namespace torso
