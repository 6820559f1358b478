// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/mesh_section.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "model/ray.h"

namespace torso {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace

std::vector<Outline> section(const TriMesh& mesh, int axis, double value) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  using Edge = std::pair<int, int>;
  const auto above = [&](int i) { return mesh.vertices[i][axis] >= value; };
  const auto crossing = [&](int a, int b) -> Edge { return {std::min(a, b), std::max(a, b)}; };
  std::map<Edge, Edge> next;  // from crossed edge to crossed edge, solid on the left
  for (const auto& f : mesh.faces) {
    Edge up, down;
    int crossed = 0;
    for (int k = 0; k < 3; k++) {
      const int a = f[k], b = f[(k + 1) % 3];
      if (above(a) == above(b)) continue;
      crossed++;
      (above(a) ? down : up) = crossing(a, b);
    }
    if (crossed == 2) next[down] = up;
  }
  std::vector<Outline> outlines;
  while (!next.empty()) {
    Outline outline;
    Edge at = next.begin()->first;
    for (auto it = next.find(at); it != next.end(); it = next.find(at)) {
      const Vector3d &a = mesh.vertices[at.first], &b = mesh.vertices[at.second];
      const double t = (value - a[axis]) / (b[axis] - a[axis]);
      const Vector3d p = a + t * (b - a);
      outline.emplace_back(p[u], p[v]);
      at = it->second;
      next.erase(it);
    }
    if (outline.size() > 2) outlines.push_back(outline);
  }
  return outlines;
}

double signedArea(const Outline& outline) {
  double area = 0;
  for (std::size_t i = 0; i < outline.size(); i++) {
    area += cross(outline[i], outline[(i + 1) % outline.size()]) / 2;
  }
  return area;
}

Vector2d centroid(const Outline& outline) {
  Vector2d sum = Vector2d::Zero();
  const Vector2d o = outline.front();
  double area = 0;
  for (std::size_t i = 0; i < outline.size(); i++) {
    const Vector2d a = outline[i] - o, b = outline[(i + 1) % outline.size()] - o;
    const double part = cross(a, b) / 2;
    area += part;
    sum += part * (a + b) / 3;
  }
  return o + (area != 0 ? Vector2d(sum / area) : Vector2d::Zero());
}

bool contains(const Outline& outline, const Vector2d& p) {
  bool inside = false;
  for (std::size_t i = 0; i < outline.size(); i++) {
    const Vector2d &a = outline[i], &b = outline[(i + 1) % outline.size()];
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    if (p.x() < a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y())) inside = !inside;
  }
  return inside;
}

double rayLength(const TriMesh& mesh, const Vector3d& origin, const Vector3d& direction) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t face = 0; face < mesh.faces.size(); face++) {
    const double t = passage(corners(mesh, static_cast<int>(face)), origin, direction, nullptr);
    if (t > 0) least = std::min(least, t);
  }
  return least;
}

std::vector<SurfacePoint> surfacePoints(const TriMesh& mesh, double spacing) {
  std::vector<SurfacePoint> points;
  for (const auto& f : mesh.faces) {
    const Vector3d &a = mesh.vertices[f[0]], &b = mesh.vertices[f[1]], &c = mesh.vertices[f[2]];
    const Vector3d normal = (b - a).cross(c - a);
    const double area = normal.norm() / 2;
    if (area == 0) continue;
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const int n = std::max(1, static_cast<int>(std::ceil(longest / spacing)));
    // The middles of n x n equal triangles.
    for (int i = 0; i < n; i++) {
      for (int j = 0; j < 2 * (n - i) - 1; j++) {
        const double third = j % 2 ? 2.0 / 3 : 1.0 / 3;
        const double s = (i + third) / n, t = (j / 2 + third) / n;
        points.push_back({a + s * (b - a) + t * (c - a), normal / (2 * area), area / (n * n)});
      }
    }
  }
  return points;
}

std::size_t nearestIndex(const std::vector<Vector3d>& points, const Vector3d& p) {
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points.size(); i++) {
    const double d = (points[i] - p).squaredNorm();
    if (d < least) {
      least = d;
      best = i;
    }
  }
  return best;
}

}  // namespace torso
