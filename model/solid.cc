// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/solid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "model/blend.h"
#include "model/mesh_checks.h"

namespace torso {
namespace {

using Eigen::Affine3d;
using Eigen::AlignedBox3d;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Distance to the superellipsoid of half axes r, to first order at its surface.
double superellipsoidDistance(const Vector3d& p, const Vector3d& r, double exponent) {
  const Vector3d q = p.cwiseAbs().cwiseQuotient(r);
  double level;  // 1 on the surface
  Vector3d slope;
  if (exponent == 2) {
    level = q.norm();
    slope = q.cwiseQuotient(r) / std::max(level, 1e-9);
  } else {
    // Scaled by the largest, which the powers of the others are small against. In single precision,
    // as most of the time is spent here.
    const auto power = [](double x, double e) {
      if (x == 1 || x < 1e-6) return x == 1 ? 1.0f : 0.0f;  // the largest; beside a bar's middle
      return std::pow(static_cast<float>(x), static_cast<float>(e));
    };
    const double most = std::max(q.maxCoeff(), 1e-9), e = exponent - 1;
    const Vector3d s(power(q.x() / most, e), power(q.y() / most, e), power(q.z() / most, e));
    const double sum = s.dot(q) / most, root = power(sum, 1 / exponent);
    level = most * root;
    slope = root / sum * s.cwiseQuotient(r);
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

AlignedBox3d boxAround(const Vector3d& centre, double radius) {
  return {Vector3d(centre - Vector3d::Constant(radius)),
          Vector3d(centre + Vector3d::Constant(radius))};
}

// Points along a bar of elliptic sections, `steps` of them from one section to the next.
struct BarPoint {
  Vector3d centre, up;
  double side, half_up;
};
std::vector<BarPoint> barPoints(const std::vector<Section>& sections, const Vector3d& up, int steps,
                                bool smooth_girths) {
  std::vector<Vector3d> centres, ups;
  std::vector<double> sides, half_ups;
  for (const Section& s : sections) {
    centres.push_back(s.centre);
    ups.push_back(s.up_direction.isZero() ? up : s.up_direction);
    sides.push_back(s.side);
    half_ups.push_back(s.up);
  }
  const int spans = static_cast<int>(sections.size()) - 1;
  std::vector<BarPoint> points;
  for (int k = 0; k <= spans * steps; k++) {
    const double t = static_cast<double>(k) / steps;
    const auto girth = [&](const std::vector<double>& g) {
      if (smooth_girths) return smooth(g, t);
      const int i = std::min(static_cast<int>(t), spans - 1);
      const double s = t - i, w = s * s * (3 - 2 * s);  // never overshoots
      return (1 - w) * g[i] + w * g[i + 1];
    };
    points.push_back({smooth(centres, t), smooth(ups, t), girth(sides), girth(half_ups)});
  }
  return points;
}

AlignedBox3d boxAround(const std::vector<BarPoint>& bar) {
  AlignedBox3d box;
  for (const BarPoint& p : bar) box.extend(boxAround(p.centre, std::hypot(p.side, p.half_up)));
  return box;
}

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

AlignedBox3d widened(const AlignedBox3d& box, double by) {
  return {Vector3d(box.min() - Vector3d::Constant(by)),
          Vector3d(box.max() + Vector3d::Constant(by))};
}

}  // namespace

Solid mirrored(const Solid& solid) {
  AlignedBox3d box = solid.box;
  box.min().y() = -solid.box.max().y();
  box.max().y() = -solid.box.min().y();
  return {box,
          [f = solid.distance](const Vector3d& p) { return f(Vector3d(p.x(), -p.y(), p.z())); }};
}

Solid moved(const Solid& solid, const Affine3d& X) {
  const double scale = X.linear().col(0).norm();
  return {solid.box.transformed(X), [f = solid.distance, back = X.inverse(),
                                     scale](const Vector3d& p) { return scale * f(back * p); }};
}

Solid grown(const Solid& solid, double by) {
  return {widened(solid.box, by),
          [f = solid.distance, by](const Vector3d& p) { return f(p) - by; }};
}

std::vector<Solid> keptApart(const std::vector<Solid>& solids, double gap) {
  std::vector<Solid> out;
  for (std::size_t i = 0; i < solids.size(); i++) {
    std::vector<Solid> others;
    for (std::size_t j = 0; j < solids.size(); j++) {
      if (j != i && widened(solids[i].box, gap).intersects(solids[j].box)) {
        others.push_back(solids[j]);
      }
    }
    const auto distance = [own = solids[i].distance, others, gap](const Vector3d& p) {
      const double mine = own(p);
      double d = mine;
      for (const Solid& other : others) {
        if (mine + gap - other.box.exteriorDistance(p) < 2 * d) continue;  // too far away to matter
        d = std::max(d, (mine + gap - other.distance(p)) / 2);
      }
      return d;
    };
    out.push_back({solids[i].box, distance});
  }
  return out;
}

Solid ellipsoidSolid(const Vector3d& centre, const Vector3d& half_axes, const Matrix3d& axes,
                     double squareness) {
  const double reach = squareness > 2 ? half_axes.norm() : half_axes.maxCoeff();
  return {boxAround(centre, reach), [=](const Vector3d& p) {
            return superellipsoidDistance(axes.transpose() * (p - centre), half_axes, squareness);
          }};
}

Solid ballSolid(const Vector3d& centre, double radius) {
  return {boxAround(centre, radius),
          [=](const Vector3d& p) { return (p - centre).norm() - radius; }};
}

Solid torus(const Vector3d& centre, const Vector3d& axis, double radius, double thickness) {
  return {boxAround(centre, radius + thickness), [=](const Vector3d& p) {
            const double w = (p - centre).dot(axis), r = (p - centre - w * axis).norm();
            return std::hypot(r - radius, w) - thickness;
          }};
}

Solid cylinder(const Vector3d& centre, const Vector3d& axis, double radius, double half_length,
               double edge) {
  return {boxAround(centre, std::hypot(radius, half_length)), [=](const Vector3d& p) {
            const double w = (p - centre).dot(axis), r = (p - centre - w * axis).norm();
            const double dr = r - (radius - edge), dw = std::abs(w) - (half_length - edge);
            return std::hypot(std::max(dr, 0.0), std::max(dw, 0.0)) +
                   std::min(std::max(dr, dw), 0.0) - edge;
          }};
}

Solid halfSpace(const Vector3d& point, const Vector3d& normal) {
  constexpr double kAll = 1e9;
  return {boxAround(Vector3d::Zero(), kAll),
          [=](const Vector3d& p) { return (p - point).dot(normal); }};
}

Solid rod(const std::vector<Section>& sections, const TubeStyle& style) {
  const std::vector<BarPoint> points = barPoints(sections, style.up, 6, false);
  return {boxAround(points),
          [=, cap = style.cap, squareness = style.squareness](const Vector3d& p) {
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
            const BarPoint &a = points[at], &b = points[at + 1];
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

Solid stoutRod(const std::vector<Section>& sections, const Vector3d& up, double squareness,
               double cap) {
  const std::vector<BarPoint> points = barPoints(sections, up, 4, true);
  struct Piece {
    Vector3d start, along;
    Matrix3d into;  // rows: across, up, along
    double length2, side, more_side, half_up, more_up;
  };
  std::vector<Piece> pieces;
  for (std::size_t k = 0; k + 1 < points.size(); k++) {
    const BarPoint &a = points[k], &b = points[k + 1];
    Piece s;
    s.start = a.centre;
    s.along = b.centre - a.centre;
    s.length2 = s.along.squaredNorm();
    const Vector3d z = s.along.normalized(), x = (a.up + b.up).cross(z).normalized();
    s.into << x.transpose(), z.cross(x).transpose(), z.transpose();
    s.side = a.side, s.more_side = b.side - a.side;
    s.half_up = a.half_up, s.more_up = b.half_up - a.half_up;
    pieces.push_back(s);
  }
  return {boxAround(points), [=](const Vector3d& p) {
            double nearest = std::numeric_limits<double>::infinity();
            for (const Piece& s : pieces) {
              const double place = (p - s.start).dot(s.along) / s.length2;
              const double t = std::clamp(place, 0.0, 1.0);
              const Vector3d off = p - s.start - t * s.along;
              const double side = s.side + t * s.more_side, half_up = s.half_up + t * s.more_up;
              if (off.norm() - std::max(side, half_up) > nearest) continue;
              const bool at_end =
                  (&s == &pieces.front() && place < 0) || (&s == &pieces.back() && place > 1);
              const double end = (at_end ? cap : 1) * std::min(side, half_up);
              nearest = std::min(
                  nearest, superellipsoidDistance(s.into * off, {side, half_up, end}, squareness));
            }
            return nearest;
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

Solid bentPlate(const std::vector<std::vector<Vector3d>>& grid,
                const std::vector<std::vector<double>>& thickness) {
  constexpr int kSteps = 5;
  const int spans = static_cast<int>(grid.size()) - 1;
  const int rows = spans * kSteps + 1;
  const int columns = (static_cast<int>(grid[0].size()) - 1) * kSteps + 1;
  // A row of the grid and the thicknesses at t along its first direction.
  const auto rowAt = [](const auto& table, double t, auto* row) {
    for (std::size_t j = 0; j < table[0].size(); j++) {
      std::decay_t<decltype(*row)> column;
      for (const auto& r : table) column.push_back(r[j]);
      row->push_back(smooth(column, t));
    }
  };
  TriMesh middle;
  const auto half = std::make_shared<std::vector<double>>();  // thickness, of its vertices
  for (int i = 0; i < rows; i++) {
    std::vector<Vector3d> line;
    std::vector<double> thick;
    rowAt(grid, static_cast<double>(i) / kSteps, &line);
    rowAt(thickness, static_cast<double>(i) / kSteps, &thick);
    for (int j = 0; j < columns; j++) {
      const double t = static_cast<double>(j) / kSteps;
      middle.vertices.push_back(smooth(line, t));
      half->push_back(smooth(thick, t) / 2);
      if (i == 0 || j == 0) continue;
      const int d = i * columns + j, c = d - 1, b = d - columns, a = b - 1;
      middle.faces.push_back({a, b, d});
      middle.faces.push_back({a, d, c});
    }
  }
  const auto tree = std::make_shared<MeshTree>(middle);
  return {widened(tree->box(), *std::max_element(half->begin(), half->end())),
          [=](const Vector3d& p) {
            const MeshTree::Nearest nearest = tree->nearest(p);
            const auto& f = tree->mesh().faces[nearest.face];
            double thick = 0;
            for (int k = 0; k < 3; k++) thick += nearest.weights[k] * (*half)[f[k]];
            return nearest.distance - thick;
          }};
}

Solid meshSolid(const TriMesh& mesh) {
  const auto tree = std::make_shared<MeshTree>(mesh);
  return {tree->box(), [tree](const Vector3d& p) { return tree->signedDistance(p); }};
}

}  // namespace torso
