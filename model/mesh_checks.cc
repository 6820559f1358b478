// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/mesh_checks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>

#include "model/ray.h"

namespace torso {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

constexpr int kLeafFaces = 4;

// Weights of the corners at the nearest point of a triangle: Ericson, Real-Time Collision
// Detection, section 5.1.5.
Vector3d nearestWeights(const Vector3d& p, const Vector3d& a, const Vector3d& b,
                        const Vector3d& c) {
  const Vector3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp);
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    const double w = (d4 - d3) / (d4 - d3 + d5 - d6);
    return {0, 1 - w, w};
  }
  return Vector3d(va, vb, vc) / (va + vb + vc);
}

// Does the segment p q pass through the triangle? Touching ends and edges do not count.
bool crosses(const Vector3d& p, const Vector3d& q, const Vector3d& a, const Vector3d& b,
             const Vector3d& c) {
  const auto volume = [](const Vector3d& o, const Vector3d& x, const Vector3d& y,
                         const Vector3d& z) { return (x - o).dot((y - o).cross(z - o)); };
  const double above = volume(p, a, b, c), below = volume(q, a, b, c);
  if (!(above * below < 0)) return false;
  const double u = volume(p, q, a, b), v = volume(p, q, b, c), w = volume(p, q, c, a);
  return (u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0);
}

bool crossing(const Triangle& s, const Triangle& t) {
  for (int k = 0; k < 3; k++) {
    if (crosses(s[k], s[(k + 1) % 3], t[0], t[1], t[2])) return true;
    if (crosses(t[k], t[(k + 1) % 3], s[0], s[1], s[2])) return true;
  }
  return false;
}

// Slabs: does the ray meet the box before `limit`?
bool meets(const AlignedBox3d& box, const Vector3d& origin, const Vector3d& inverse, double limit) {
  double from = 0, to = limit;
  for (int k = 0; k < 3; k++) {
    double a = (box.min()[k] - origin[k]) * inverse[k], b = (box.max()[k] - origin[k]) * inverse[k];
    if (a > b) std::swap(a, b);
    if (a > from) from = a;
    if (b < to) to = b;
    if (from > to) return false;
  }
  return true;
}

}  // namespace

MeshFaults findFaults(const TriMesh& mesh) {
  MeshFaults faults;
  const int n = static_cast<int>(mesh.vertices.size());
  std::map<std::pair<int, int>, std::pair<int, int>> edges;  // faces along and against (low, high)
  std::vector<std::map<int, int>> fans(n);  // next neighbour about a vertex, per neighbour
  std::vector<int> fan_faces(n, 0);
  for (const auto& f : mesh.faces) {
    bool bad = false;
    for (int k = 0; k < 3; k++) bad |= f[k] < 0 || f[k] >= n || f[k] == f[(k + 1) % 3];
    if (bad) {
      faults.bad_indices++;
      continue;
    }
    const Vector3d &a = mesh.vertices[f[0]], &b = mesh.vertices[f[1]], &c = mesh.vertices[f[2]];
    if (!((b - a).cross(c - a).norm() > 2e-12)) faults.flat_faces++;
    for (int k = 0; k < 3; k++) {
      const int i = f[k], j = f[(k + 1) % 3];
      auto& faces = edges[std::minmax(i, j)];
      (i < j ? faces.first : faces.second)++;
      fans[i][j] = f[(k + 2) % 3];
      fan_faces[i]++;
    }
  }
  for (const auto& [edge, faces] : edges) {
    const int count = faces.first + faces.second;
    if (count == 1) faults.open_edges++;
    if (count > 2) faults.crowded_edges++;
    if (count == 2 && faces.first != 1) faults.misturned_edges++;
  }
  for (int i = 0; i < n; i++) {
    if (fan_faces[i] == 0) continue;
    const int start = fans[i].begin()->first;
    int length = 0, at = start;
    while (length < fan_faces[i]) {
      const auto it = fans[i].find(at);
      if (it == fans[i].end()) break;  // an open edge, counted above
      at = it->second;
      length++;
      if (at == start) break;
    }
    if (at == start && length < fan_faces[i]) faults.pinched_vertices++;
  }
  return faults;
}

MeshTree::MeshTree(TriMesh mesh) : mesh_(std::move(mesh)) {
  const int n = static_cast<int>(mesh_.faces.size());
  if (n == 0) throw std::invalid_argument("mesh: no faces");
  for (const auto& f : mesh_.faces) {
    for (int k : f) {
      if (k < 0 || k >= static_cast<int>(mesh_.vertices.size())) {
        throw std::invalid_argument("mesh: a face has a vertex that does not exist");
      }
    }
  }
  order_.resize(n);
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.reserve(2 * n);
  nodes_.emplace_back();
  split(0, 0, n);
}

void MeshTree::split(int node, int first, int last) {
  AlignedBox3d box, centres;
  const auto centre = [&](int face) {
    const Triangle t = corners(mesh_, face);
    return Vector3d((t[0] + t[1] + t[2]) / 3);
  };
  for (int i = first; i < last; i++) {
    for (const Vector3d& p : corners(mesh_, order_[i])) box.extend(p);
    centres.extend(centre(order_[i]));
  }
  nodes_[node] = {box, first, last - first};
  if (last - first <= kLeafFaces) return;
  int axis;
  centres.sizes().maxCoeff(&axis);
  const int middle = (first + last) / 2;
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                   [&](int a, int b) { return centre(a)[axis] < centre(b)[axis]; });
  const int children = static_cast<int>(nodes_.size());
  nodes_.resize(children + 2);
  nodes_[node].first = children;
  nodes_[node].count = 0;
  split(children, first, middle);
  split(children + 1, middle, last);
}

Vector3d MeshTree::normal(int face) const {
  const Triangle t = corners(mesh_, face);
  return (t[1] - t[0]).cross(t[2] - t[0]).normalized();
}

template <typename Visit>
void MeshTree::alongRay(const Vector3d& origin, const Vector3d& direction, double& limit,
                        const Visit& visit) const {
  const Vector3d inverse = direction.cwiseInverse();
  std::vector<int> stack = {0};
  while (!stack.empty()) {
    const Node& node = nodes_[stack.back()];
    stack.pop_back();
    if (!meets(node.box, origin, inverse, limit)) continue;
    if (node.count == 0) {
      stack.push_back(node.first);
      stack.push_back(node.first + 1);
    }
    for (int i = 0; i < node.count; i++) visit(order_[node.first + i]);
  }
}

MeshTree::Hit MeshTree::castRay(const Vector3d& origin, const Vector3d& direction) const {
  Hit hit;
  alongRay(origin, direction, hit.distance, [&](int face) {
    const double t = passage(corners(mesh_, face), origin, direction, nullptr);
    if (t > 0 && t < hit.distance) hit = {t, face};
  });
  return hit;
}

int MeshTree::windingNumber(const Vector3d& point) const {
  if (!box().contains(point)) return 0;
  // A direction along no edge of a symmetric or axis-parallel mesh.
  const Vector3d direction = Vector3d(0.5377, 0.2813, 0.7948).normalized();
  double limit = std::numeric_limits<double>::infinity();
  int sum = 0;
  alongRay(point, direction, limit, [&](int face) {
    int sign;
    if (passage(corners(mesh_, face), point, direction, &sign) > 0) sum += sign;
  });
  return sum;
}

MeshTree::Nearest MeshTree::nearest(const Vector3d& point) const {
  Nearest best{point, std::numeric_limits<double>::infinity(), -1, Vector3d::Zero()};
  std::vector<int> stack = {0};
  while (!stack.empty()) {
    const Node& node = nodes_[stack.back()];
    stack.pop_back();
    if (node.box.exteriorDistance(point) >= best.distance) continue;
    if (node.count == 0) {
      const bool second = nodes_[node.first].box.squaredExteriorDistance(point) >
                          nodes_[node.first + 1].box.squaredExteriorDistance(point);
      stack.push_back(node.first + !second);  // the nearer one is looked at first
      stack.push_back(node.first + second);
    }
    for (int i = 0; i < node.count; i++) {
      const int face = order_[node.first + i];
      const Triangle t = corners(mesh_, face);
      const Vector3d w = nearestWeights(point, t[0], t[1], t[2]);
      const Vector3d q = w[0] * t[0] + w[1] * t[1] + w[2] * t[2];
      const double distance = (q - point).norm();
      if (distance < best.distance) best = {q, distance, face, w};
    }
  }
  return best;
}

double MeshTree::signedDistance(const Vector3d& point) const {
  const double distance = nearest(point).distance;
  return windingNumber(point) > 0 ? -distance : distance;
}

template <typename Visit>
void MeshTree::overlapping(const MeshTree& other, const Visit& visit) const {
  std::vector<std::pair<int, int>> stack = {{0, 0}};
  while (!stack.empty()) {
    const auto [i, j] = stack.back();
    stack.pop_back();
    const Node &a = nodes_[i], &b = other.nodes_[j];
    if (!a.box.intersects(b.box)) continue;
    if (a.count > 0 && b.count > 0) {
      for (int k = 0; k < a.count; k++) {
        for (int l = 0; l < b.count; l++) visit(order_[a.first + k], other.order_[b.first + l]);
      }
    } else if (b.count > 0 || (a.count == 0 && a.box.volume() > b.box.volume())) {
      stack.push_back({a.first, j});
      stack.push_back({a.first + 1, j});
    } else {
      stack.push_back({i, b.first});
      stack.push_back({i, b.first + 1});
    }
  }
}

std::vector<std::pair<int, int>> MeshTree::selfIntersections() const {
  std::vector<std::pair<int, int>> pairs;
  overlapping(*this, [&](int i, int j) {
    if (i >= j) return;
    const auto &f = mesh_.faces[i], &g = mesh_.faces[j];
    int shared = 0, a = 0, b = 0;  // a, b: the shared vertex' place in f and g
    for (int k = 0; k < 3; k++) {
      for (int l = 0; l < 3; l++) {
        if (f[k] == g[l]) {
          shared++;
          a = k;
          b = l;
        }
      }
    }
    const Triangle s = corners(mesh_, i), t = corners(mesh_, j);
    bool bad;
    if (shared == 0) {
      bad = crossing(s, t);
    } else if (shared == 1) {  // only the edges that do not end there
      bad = crosses(s[(a + 1) % 3], s[(a + 2) % 3], t[0], t[1], t[2]) ||
            crosses(t[(b + 1) % 3], t[(b + 2) % 3], s[0], s[1], s[2]);
    } else {  // folded flat onto each other
      bad = normal(i).dot(normal(j)) < -1 + 1e-6;
    }
    if (bad) pairs.push_back({i, j});
  });
  return pairs;
}

std::vector<std::pair<int, int>> MeshTree::intersections(const MeshTree& other) const {
  std::vector<std::pair<int, int>> pairs;
  overlapping(other, [&](int i, int j) {
    if (crossing(corners(mesh_, i), corners(other.mesh_, j))) pairs.push_back({i, j});
  });
  return pairs;
}

double penetration(const MeshTree& a, const MeshTree& b, double touch) {
  if (!a.box().intersects(b.box())) return 0;
  double deepest = 0;
  const auto probe = [&](const MeshTree& from, const MeshTree& into) {
    for (const Vector3d& v : from.mesh().vertices) {
      if (into.box().contains(v)) deepest = std::max(deepest, -into.signedDistance(v));
    }
  };
  probe(a, b);
  probe(b, a);
  if (deepest == 0 && !a.intersections(b).empty()) deepest = touch;
  return deepest;
}

}  // namespace torso
