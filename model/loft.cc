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

}  // namespace torso
