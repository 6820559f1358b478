// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/solid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace torso {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Union with a fillet of size k (a polynomial smooth minimum).
double smoothMin(double a, double b, double k) {
  const double h = k > 0 ? std::max(k - std::abs(a - b), 0.0) / k : 0;
  return std::min(a, b) - h * h * k / 4;
}
double smoothMax(double a, double b, double k) { return -smoothMin(-a, -b, k); }

// Distance to the superellipsoid of half axes r, to first order at its surface.
double superellipsoidDistance(const Vector3d& p, const Vector3d& r, double exponent) {
  const Vector3d q = p.cwiseAbs().cwiseQuotient(r);
  double level;  // 1 on the surface
  Vector3d slope;
  if (exponent == 2) {
    level = q.norm();
    slope = q.cwiseQuotient(r) / std::max(level, 1e-9);
  } else {
    // Scaled by the largest, which the powers of the others are small against.
    const double most = std::max(q.maxCoeff(), 1e-9);
    const Vector3d s = (q / most).array().pow(exponent - 1);
    const double sum = s.dot(q) / most;
    level = most * std::pow(sum, 1 / exponent);
    slope = std::pow(sum, 1 / exponent - 1) * s.cwiseQuotient(r);
  }
  if (level < 1e-6) return -r.minCoeff();
  return std::max((level - 1) / slope.norm(), -r.minCoeff());
}

// Catmull-Rom through p1 (t = 0) and p2 (t = 1), the ends straight.
template <class T>
T smooth(const std::vector<T>& p, double t) {
  const int last = static_cast<int>(p.size()) - 1;
  const int i = std::clamp(static_cast<int>(t), 0, last - 1);
  const T p0 = i > 0 ? p[i - 1] : T(2 * p[0] - p[1]);
  const T p3 = i + 2 <= last ? p[i + 2] : T(2 * p[last] - p[last - 1]);
  const double s = t - i;
  return 0.5 * (2 * p[i] + (p[i + 1] - p0) * s + (2 * p0 - 5 * p[i] + 4 * p[i + 1] - p3) * (s * s) +
                (3 * p[i] - 3 * p[i + 1] + p3 - p0) * (s * s * s));
}

struct RodPoint {
  Vector3d centre, up;
  double side, half_up;
};

// Signed distance to a closed polygon.
double polygonDistance(const Vector2d& p, const std::vector<Vector2d>& v) {
  double nearest = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (std::size_t i = 0, j = v.size() - 1; i < v.size(); j = i++) {
    const Vector2d e = v[j] - v[i], w = p - v[i];
    const double t = std::clamp(w.dot(e) / e.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (w - t * e).squaredNorm());
    if ((v[i].y() > p.y()) != (v[j].y() > p.y()) &&
        p.x() < v[i].x() + e.x() * (p.y() - v[i].y()) / e.y()) {
      inside = !inside;
    }
  }
  return (inside ? -1 : 1) * std::sqrt(nearest);
}

AlignedBox3d boxAround(const Vector3d& centre, double radius) {
  return {Vector3d(centre - Vector3d::Constant(radius)),
          Vector3d(centre + Vector3d::Constant(radius))};
}

}  // namespace

Solid mirrored(const Solid& solid) {
  AlignedBox3d box = solid.box;
  box.min().y() = -solid.box.max().y();
  box.max().y() = -solid.box.min().y();
  return {box,
          [f = solid.distance](const Vector3d& p) { return f(Vector3d(p.x(), -p.y(), p.z())); }};
}

Solid ellipsoidSolid(const Vector3d& centre, const Vector3d& half_axes, const Matrix3d& axes,
                     double squareness) {
  const double reach = squareness > 2 ? half_axes.norm() : half_axes.maxCoeff();
  return {boxAround(centre, reach), [=](const Vector3d& p) {
            return superellipsoidDistance(axes.transpose() * (p - centre), half_axes, squareness);
          }};
}

Solid rod(const std::vector<Section>& sections, const TubeStyle& style) {
  constexpr int kSteps = 6;
  std::vector<Vector3d> centres, ups;
  for (const Section& s : sections) {
    centres.push_back(s.centre);
    ups.push_back(s.up_direction.isZero() ? style.up : s.up_direction);
  }
  const int spans = static_cast<int>(sections.size()) - 1;
  std::vector<RodPoint> points;
  AlignedBox3d box;
  for (int k = 0; k <= spans * kSteps; k++) {
    const double t = static_cast<double>(k) / kSteps;
    const int i = std::min(static_cast<int>(t), spans - 1);
    // Girths change smoothly without overshooting.
    const double s = t - i, w = s * s * (3 - 2 * s);
    points.push_back({smooth(centres, t), smooth(ups, t),
                      (1 - w) * sections[i].side + w * sections[i + 1].side,
                      (1 - w) * sections[i].up + w * sections[i + 1].up});
    const double girth = std::hypot(points.back().side, points.back().half_up);
    box.extend(boxAround(points.back().centre, girth));
  }
  const double cap = style.cap, squareness = style.squareness;
  return {box, [=](const Vector3d& p) {
            // Nearest place of the centre line.
            double least = std::numeric_limits<double>::infinity(), t = 0;
            std::size_t at = 0;
            for (std::size_t k = 0; k + 1 < points.size(); k++) {
              const Vector3d a = points[k].centre, e = points[k + 1].centre - a;
              const double s = std::clamp((p - a).dot(e) / e.squaredNorm(), 0.0, 1.0);
              const double d = (p - a - s * e).squaredNorm();
              if (d < least) {
                least = d;
                at = k;
                t = s;
              }
            }
            const RodPoint &a = points[at], &b = points[at + 1];
            const Vector3d along = (b.centre - a.centre).normalized();
            const Vector3d across = ((1 - t) * a.up + t * b.up).cross(along).normalized();
            const Vector3d up = along.cross(across);
            const Vector3d off = p - (1 - t) * a.centre - t * b.centre;
            const double side = (1 - t) * a.side + t * b.side;
            const double half_up = (1 - t) * a.half_up + t * b.half_up;
            const double end = cap * std::min(side, half_up);
            return superellipsoidDistance({off.dot(across), off.dot(up), off.dot(along)},
                                          {side, half_up, end}, squareness);
          }};
}

Solid capsule(const Vector3d& a, const Vector3d& b, double radius) {
  return {boxAround(a, radius).merged(boxAround(b, radius)), [=](const Vector3d& p) {
            const Vector3d e = b - a;
            const double t = std::clamp((p - a).dot(e) / e.squaredNorm(), 0.0, 1.0);
            return (p - a - t * e).norm() - radius;
          }};
}

Solid facePlate(const Isometry3d& frame, double width, double height, double depth, double edge) {
  const Isometry3d into = frame.inverse();
  return {boxAround(frame.translation(), std::hypot(std::max(width, height) / 2, depth)),
          [=](const Vector3d& p) {
            const Vector3d q = into * p;
            // A cylinder, by the section of a sphere's worth of ellipsoid.
            const double around =
                superellipsoidDistance({q.x(), q.y(), 0}, {width / 2, height / 2, width}, 2);
            return smoothMax(around, std::abs(q.z() + depth / 2) - depth / 2, edge);
          }};
}

Solid outlinePlate(const Isometry3d& frame, const std::vector<Vector2d>& outline,
                   const std::function<double(const Vector2d&)>& thickness, double edge) {
  const Isometry3d into = frame.inverse();
  AlignedBox3d box;
  for (const Vector2d& v : outline) {
    const Vector3d half(0, thickness(v) / 2, 0);
    box.extend(frame * (Vector3d(v.x(), 0, v.y()) + half));
    box.extend(frame * (Vector3d(v.x(), 0, v.y()) - half));
  }
  return {box, [=](const Vector3d& p) {
            const Vector3d q = into * p;
            const Vector2d place(q.x(), q.z());
            return smoothMax(polygonDistance(place, outline),
                             std::abs(q.y()) - thickness(place) / 2, edge);
          }};
}

void Blend::unite(const Solid& solid, double fillet) {
  steps_.push_back({solid, fillet, false});
  largest_fillet_ = std::max(largest_fillet_, fillet);
  box_.extend(solid.box);
}

void Blend::carve(const Solid& solid, double fillet) {
  steps_.push_back({solid, fillet, true});
  largest_fillet_ = std::max(largest_fillet_, fillet);
}

void Blend::unitePair(const Solid& left, double fillet) {
  unite(left, fillet);
  unite(mirrored(left), fillet);
}

void Blend::carvePair(const Solid& left, double fillet) {
  carve(left, fillet);
  carve(mirrored(left), fillet);
}

double Blend::distance(const Vector3d& p, double far) const {
  double d = std::numeric_limits<double>::infinity();
  for (const Step& s : steps_) {
    // Half the fillet's size is the most that a shape at that distance can do. Away from their
    // surface shapes' distances may be too small, by this factor.
    constexpr double kShort = 0.6;
    const double off = kShort * s.solid.box.exteriorDistance(p);
    if (s.carve) {
      if (off < s.fillet - d) d = smoothMax(d, -s.solid.distance(p), s.fillet);
    } else if (off > far + largest_fillet_) {
      d = std::min(d, off);
    } else if (off < d + s.fillet) {
      d = smoothMin(d, s.solid.distance(p), s.fillet);
    }
  }
  return d;
}

}  // namespace torso
