// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/loft.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace torso {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPi = 3.14159265358979323846;

double signedPower(double x, double exponent) {
  return std::copysign(std::pow(std::abs(x), exponent), x);
}

// Catmull-Rom through p1 (t = 0) and p2 (t = 1).
template <class T>
T catmullRom(const T& p0, const T& p1, const T& p2, const T& p3, double t) {
  return 0.5 * (2 * p1 + (p2 - p0) * t + (2 * p0 - 5 * p1 + 4 * p2 - p3) * (t * t) +
                (3 * p1 - 3 * p2 + p3 - p0) * (t * t * t));
}

// The neighbours beyond the ends are reflected ones, which makes the ends straight.
template <class T>
T interpolate(const std::vector<T>& p, double t) {
  const int last = static_cast<int>(p.size()) - 1;
  const int i = std::clamp(static_cast<int>(t), 0, last - 1);
  const T before = i > 0 ? p[i - 1] : T(2 * p[0] - p[1]);
  const T after = i + 2 <= last ? p[i + 2] : T(2 * p[last] - p[last - 1]);
  return catmullRom<T>(before, p[i], p[i + 1], after, t - i);
}

void addQuad(TriMesh& mesh, int a, int b, int c, int d) {
  // Split along the shorter diagonal: fewer slivers, rounder look.
  const auto& v = mesh.vertices;
  if ((v[a] - v[c]).squaredNorm() <= (v[b] - v[d]).squaredNorm()) {
    mesh.faces.push_back({a, b, c});
    mesh.faces.push_back({a, c, d});
  } else {
    mesh.faces.push_back({a, b, d});
    mesh.faces.push_back({b, c, d});
  }
}

// Rings between two poles.
TriMesh between(const Vector3d& first, const std::vector<Ring>& rings, const Vector3d& last) {
  TriMesh mesh;
  const int n = static_cast<int>(rings.front().size());
  for (const Ring& ring : rings) {
    mesh.vertices.insert(mesh.vertices.end(), ring.begin(), ring.end());
  }
  const int pole = static_cast<int>(mesh.vertices.size());
  mesh.vertices.push_back(first);
  mesh.vertices.push_back(last);
  const int m = static_cast<int>(rings.size());
  for (int i = 0; i < n; i++) {
    const int j = (i + 1) % n;
    mesh.faces.push_back({pole, j, i});
    for (int k = 0; k + 1 < m; k++) {
      addQuad(mesh, k * n + i, k * n + j, (k + 1) * n + j, (k + 1) * n + i);
    }
    mesh.faces.push_back({pole + 1, (m - 1) * n + i, (m - 1) * n + j});
  }
  return mesh;
}

// Makes the faces of a shell look outwards, whichever way round its description ran.
TriMesh outward(TriMesh mesh) {
  if (volume(mesh) < 0) {
    for (auto& f : mesh.faces) std::swap(f[1], f[2]);
  }
  return mesh;
}

Vector3d mean(const Ring& ring) {
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& p : ring) sum += p;
  return sum / static_cast<double>(ring.size());
}

}  // namespace

double volume(const TriMesh& mesh) {
  double v = 0;
  for (const auto& f : mesh.faces) {
    v += mesh.vertices[f[0]].dot(mesh.vertices[f[1]].cross(mesh.vertices[f[2]])) / 6;
  }
  return v;
}

Vector3d curveAt(const std::vector<Vector3d>& points, double t) { return interpolate(points, t); }

std::vector<Vector2d> endplateOutline(double width, double depth, int points) {
  constexpr double kFill = 0.82, kFront = 0.6;
  // A half superellipse in front and one of the next exponent behind; their area decides.
  const auto fill = [](double p) {
    return std::pow(std::tgamma(1 + 1 / p), 2) / std::tgamma(1 + 2 / p);
  };
  double low = 1.5, high = 4;
  for (int i = 0; i < 50; i++) {
    const double p = (low + high) / 2;
    (kFront * fill(p) + (1 - kFront) * fill(p + 1) < kFill ? low : high) = p;
  }
  constexpr int kSamples = 2000;
  std::vector<Vector2d> half;
  std::vector<double> length = {0};
  for (int i = 0; i <= kSamples; i++) {
    const double angle = kPi * i / kSamples;
    const bool front = 2 * i <= kSamples;
    const double e = 2 / (front ? low : low + 1);
    half.emplace_back(
        depth * (0.5 - kFront + (front ? kFront : 1 - kFront) * signedPower(std::cos(angle), e)),
        width / 2 * signedPower(std::sin(angle), e));
    if (i > 0) length.push_back(length.back() + (half[i] - half[i - 1]).norm());
  }
  half.back().y() = 0;
  std::vector<Vector2d> outline(points);
  double widest = 0;
  for (int k = 0; 2 * k <= points; k++) {
    const double s = length.back() * 2 * k / points;
    const size_t i = std::lower_bound(length.begin(), length.end(), s) - length.begin();
    outline[k] = half[std::min<size_t>(i, kSamples)];
    widest = std::max(widest, outline[k].y());
  }
  for (int k = 0; 2 * k <= points; k++) {
    outline[k].y() *= width / 2 / widest;  // the polygon shall have the width, too
    if (k > 0) outline[points - k] = {outline[k].x(), -outline[k].y()};
  }
  return outline;
}

TriMesh tube(const std::vector<Section>& sections, const TubeStyle& style) {
  std::vector<Vector3d> centres, ups;
  std::vector<double> side, up;
  for (const Section& s : sections) {
    centres.push_back(s.centre);
    side.push_back(s.side);
    up.push_back(s.up);
    ups.push_back(s.up_direction.isZero() ? style.up.normalized() : s.up_direction.normalized());
  }
  const int spans = static_cast<int>(sections.size()) - 1;

  std::vector<Ring> rings;
  // One ring across the tube at t, `ahead` along the tangent, shrunk by `scale`.
  const auto addRing = [&](double t, double ahead, double scale) {
    const double eps = 1e-3, t0 = std::max(0.0, t - eps), t1 = std::min<double>(spans, t + eps);
    const Vector3d tangent = (interpolate(centres, t1) - interpolate(centres, t0)).normalized();
    const Vector3d across = interpolate(ups, t).cross(tangent).normalized();
    const Vector3d upward = tangent.cross(across);
    // Linear, not smooth: a half axis must not overshoot below zero.
    const int i = std::clamp(static_cast<int>(t), 0, spans - 1);
    const double s = t - i, a = (1 - s) * side[i] + s * side[i + 1],
                 b = (1 - s) * up[i] + s * up[i + 1];
    const Vector3d centre = interpolate(centres, t) + ahead * tangent;
    if (scale == 0) return centre;
    Ring ring;
    for (int k = 0; k < style.sides; k++) {
      const double angle = 2 * kPi * (k + 0.5) / style.sides, e = 2 / style.squareness;
      ring.push_back(centre + scale * (a * signedPower(std::cos(angle), e) * across +
                                       b * signedPower(std::sin(angle), e) * upward));
    }
    rings.push_back(ring);
    return centre;
  };

  const double cap0 = style.cap * std::min(side.front(), up.front());
  const double cap1 = style.cap * std::min(side.back(), up.back());
  const Vector3d first = addRing(0, -cap0, 0);
  addRing(0, -cap0 * 0.75, 0.62);
  for (int k = 0; k <= spans * style.steps; k++) addRing(double(k) / style.steps, 0, 1);
  addRing(spans, cap1 * 0.75, 0.62);
  const Vector3d last = addRing(spans, cap1, 0);
  return outward(between(first, rings, last));
}

TriMesh loft(const std::vector<Ring>& rings) {
  return outward(between(mean(rings.front()), rings, mean(rings.back())));
}

TriMesh ellipsoid(const Vector3d& centre, const Vector3d& half_axes, const Matrix3d& axes,
                  int sides, double squareness) {
  const int n = std::max(3, sides / 2);
  const double e = 2 / squareness;
  std::vector<Ring> rings;
  for (int k = 1; k < n; k++) {
    const double latitude = -kPi / 2 + kPi * k / n;
    Ring ring;
    for (int i = 0; i < sides; i++) {
      const double longitude = 2 * kPi * (i + 0.5) / sides;
      const double c = signedPower(std::cos(latitude), e);
      const Vector3d local(c * signedPower(std::cos(longitude), e),
                           c * signedPower(std::sin(longitude), e),
                           signedPower(std::sin(latitude), e));
      ring.push_back(centre + axes * local.cwiseProduct(half_axes));
    }
    rings.push_back(ring);
  }
  const Vector3d pole = half_axes.z() * axes.col(2);
  return outward(between(centre - pole, rings, centre + pole));
}

TriMesh star(const Vector3d& centre, const std::function<double(const Vector3d&)>& radius,
             const std::vector<double>& longitudes, const std::vector<double>& latitudes) {
  const auto at = [&](const Vector3d& direction) -> Vector3d {
    return centre + radius(direction) * direction;
  };
  std::vector<Ring> rings;
  for (double latitude : latitudes) {
    Ring ring;
    for (double longitude : longitudes) {
      ring.push_back(at({std::cos(latitude) * std::cos(longitude),
                         std::cos(latitude) * std::sin(longitude), std::sin(latitude)}));
    }
    rings.push_back(ring);
  }
  return outward(between(at(-Vector3d::UnitZ()), rings, at(Vector3d::UnitZ())));
}

TriMesh plate(const std::vector<std::vector<Vector3d>>& grid,
              const std::vector<std::vector<double>>& thickness) {
  const int rows = static_cast<int>(grid.size()), cols = static_cast<int>(grid[0].size());
  const auto normal = [&](int i, int j) {
    const Vector3d u = grid[std::min(i + 1, rows - 1)][j] - grid[std::max(i - 1, 0)][j];
    const Vector3d v = grid[i][std::min(j + 1, cols - 1)] - grid[i][std::max(j - 1, 0)];
    return Vector3d(u.cross(v).normalized());
  };
  TriMesh mesh;
  for (double face : {1.0, -1.0}) {
    for (int i = 0; i < rows; i++) {
      for (int j = 0; j < cols; j++) {
        mesh.vertices.push_back(grid[i][j] + 0.5 * face * thickness[i][j] * normal(i, j));
      }
    }
  }
  const int sheet = rows * cols;
  for (int i = 0; i + 1 < rows; i++) {
    for (int j = 0; j + 1 < cols; j++) {
      const int a = i * cols + j, b = a + 1, c = a + cols + 1, d = a + cols;
      addQuad(mesh, a, d, c, b);
      addQuad(mesh, sheet + a, sheet + b, sheet + c, sheet + d);
    }
  }
  // Around the border, once: a middle line pushed out makes the edge round.
  std::vector<std::pair<int, int>> border;
  for (int j = 0; j < cols - 1; j++) border.push_back({0, j});
  for (int i = 0; i < rows - 1; i++) border.push_back({i, cols - 1});
  for (int j = cols - 1; j > 0; j--) border.push_back({rows - 1, j});
  for (int i = rows - 1; i > 0; i--) border.push_back({i, 0});
  const int n = static_cast<int>(border.size()), middle = static_cast<int>(mesh.vertices.size());
  for (int k = 0; k < n; k++) {
    const auto [i, j] = border[k];
    const auto [i0, j0] = border[(k + n - 1) % n];
    const auto [i1, j1] = border[(k + 1) % n];
    const Vector3d along = (grid[i1][j1] - grid[i0][j0]).normalized();
    const Vector3d out = along.cross(normal(i, j));
    mesh.vertices.push_back(grid[i][j] - 0.4 * thickness[i][j] * out);
  }
  for (int k = 0; k < n; k++) {
    const int k1 = (k + 1) % n;
    const int a = border[k].first * cols + border[k].second;
    const int b = border[k1].first * cols + border[k1].second;
    addQuad(mesh, a, b, middle + k1, middle + k);
    addQuad(mesh, middle + k, middle + k1, sheet + b, sheet + a);
  }
  return outward(mesh);
}

TriMesh revolve(const std::vector<Vector2d>& profile, const Vector3d& origin, const Vector3d& axis,
                int sides) {
  const Vector3d z = axis.normalized(), x = z.unitOrthogonal(), y = z.cross(x);
  TriMesh mesh;
  const int n = static_cast<int>(profile.size());
  for (int i = 0; i < sides; i++) {
    const double angle = 2 * kPi * i / sides;
    const Vector3d r = std::cos(angle) * x + std::sin(angle) * y;
    for (const Vector2d& p : profile) mesh.vertices.push_back(origin + p.x() * r + p.y() * z);
  }
  for (int i = 0; i < sides; i++) {
    const int i1 = (i + 1) % sides;
    for (int k = 0; k < n; k++) {
      const int k1 = (k + 1) % n;
      addQuad(mesh, i * n + k, i1 * n + k, i1 * n + k1, i * n + k1);
    }
  }
  return outward(mesh);
}

}  // namespace torso
