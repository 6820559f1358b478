// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "model/fuse.h"
#include "model/triangle_tree.h"

namespace torso {
namespace {

using Eigen::Affine3d;
using Eigen::AlignedBox3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// First order distance to a superellipsoid: (k - 1) / |grad k| with k = |q / half|_exponent.
double superellipsoidDistance(const Vector3d& q, const Vector3d& half, double exponent) {
  const Vector3d r = q.cwiseQuotient(half);
  if (exponent == 2) {
    const double k = r.norm(), slope = r.cwiseQuotient(half).norm();
    return k < 1e-9 ? -half.minCoeff() : k * (k - 1) / slope;
  }
  const Vector3d s = r.cwiseAbs();
  const auto power = [](double x, double e) {  // single precision: most of the time is spent here
    return std::pow(static_cast<float>(x), static_cast<float>(e));
  };
  const Vector3d slope(power(s.x(), exponent - 1), power(s.y(), exponent - 1),
                       power(s.z(), exponent - 1));
  const double sum = slope.dot(s);  // k to the exponent
  if (sum < 1e-9) return -half.minCoeff();
  const double k = power(sum, 1 / exponent);
  return (k - 1) * sum / (k * slope.cwiseQuotient(half).norm());
}

double blend(double a, double b, double fillet) {
  const double h = fillet > 0 ? std::max(fillet - std::abs(a - b), 0.0) / fillet : 0;
  return std::min(a, b) - h * h * fillet / 4;
}

// A smooth curve of elliptic sections, as straight pieces.
struct Piece {
  Vector3d a, along;  // from a to a + along
  double length2;
  Vector3d tangent, side, up;
  double side_a, side_b, up_a, up_b;
  bool first, last;
};

double tubeDistance(const std::vector<Piece>& pieces, double exponent, double cap,
                    const Vector3d& p) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Piece& s : pieces) {
    const double free = (p - s.a).dot(s.along) / s.length2, t = std::clamp(free, 0.0, 1.0);
    const Vector3d q = p - s.a - t * s.along;
    const double side = s.side_a + t * (s.side_b - s.side_a), up = s.up_a + t * (s.up_b - s.up_a);
    if (q.norm() - std::max(side, up) > nearest) continue;
    const bool at_end = (s.first && free < 0) || (s.last && free > 1);
    const Vector3d local(q.dot(s.side), q.dot(s.up), q.dot(s.tangent));
    const Vector3d half(side, up, (at_end ? cap : 1) * std::min(side, up));
    nearest = std::min(nearest, superellipsoidDistance(local, half, exponent));
  }
  return nearest;
}

// Catmull-Rom weights of four points around t in [0, 1].
std::array<double, 4> curveWeights(double t) {
  const double t2 = t * t, t3 = t2 * t;
  return {(-t + 2 * t2 - t3) / 2, (2 - 5 * t2 + 3 * t3) / 2, (t + 4 * t2 - 3 * t3) / 2,
          (-t2 + t3) / 2};
}

template <class T, class Get>
T curve(int count, double t, const Get& get) {
  const int k = std::clamp(static_cast<int>(t), 0, count - 2);
  const std::array<double, 4> w = curveWeights(t - k);
  // Beyond the ends the curve goes on straight.
  const T before = k > 0 ? T(get(k - 1)) : T(2 * get(0) - get(1));
  const T after = k + 2 < count ? T(get(k + 2)) : T(2 * get(count - 1) - get(count - 2));
  return w[0] * before + w[1] * get(k) + w[2] * get(k + 1) + w[3] * after;
}

}  // namespace

Shape ellipsoidShape(const Vector3d& centre, const Vector3d& half_axes, const Matrix3d& axes,
                     double squareness) {
  const Vector3d reach = axes.cwiseAbs() * half_axes;
  return {[=](const Vector3d& p) {
            return superellipsoidDistance(axes.transpose() * (p - centre), half_axes, squareness);
          },
          AlignedBox3d(centre - reach, centre + reach)};
}

Shape ballShape(const Vector3d& centre, double radius) {
  const Vector3d reach = Vector3d::Constant(radius);
  return {[=](const Vector3d& p) { return (p - centre).norm() - radius; },
          AlignedBox3d(centre - reach, centre + reach)};
}

Shape rollShape(const Vector3d& centre, const Vector3d& axis, double radius, double half_length,
                double rounding) {
  const Vector3d reach = Vector3d::Constant(std::hypot(radius, half_length));
  return {[=](const Vector3d& p) {
            const double w = (p - centre).dot(axis), r = (p - centre - w * axis).norm();
            const double dr = r - (radius - rounding), dw = std::abs(w) - (half_length - rounding);
            return std::hypot(std::max(dr, 0.0), std::max(dw, 0.0)) +
                   std::min(std::max(dr, dw), 0.0) - rounding;
          },
          AlignedBox3d(centre - reach, centre + reach)};
}

Shape ringShape(const Vector3d& centre, const Vector3d& axis, double radius, double thickness) {
  const Vector3d reach = Vector3d::Constant(radius + thickness);
  return {[=](const Vector3d& p) {
            const double w = (p - centre).dot(axis), r = (p - centre - w * axis).norm();
            return std::hypot(r - radius, w) - thickness;
          },
          AlignedBox3d(centre - reach, centre + reach)};
}

Shape halfSpace(const Vector3d& point, const Vector3d& normal) {
  return {[=](const Vector3d& p) { return (p - point).dot(normal); }, AlignedBox3d()};
}

Shape tubeShape(const std::vector<Section>& sections, const Vector3d& up, double squareness,
                double cap) {
  constexpr int kSteps = 4;
  const int n = static_cast<int>(sections.size());
  const int count = (n - 1) * kSteps + 1;
  std::vector<Vector3d> centre(count), upwards(count);
  std::vector<double> half_side(count), half_up(count);
  AlignedBox3d box;
  for (int i = 0; i < count; i++) {
    const double t = static_cast<double>(i) / kSteps;
    const auto own_up = [&](int k) {
      return sections[k].up_direction.isZero() ? up : sections[k].up_direction;
    };
    centre[i] = curve<Vector3d>(n, t, [&](int k) { return sections[k].centre; });
    upwards[i] = curve<Vector3d>(n, t, [&](int k) { return own_up(k).normalized(); });
    half_side[i] = std::max(curve<double>(n, t, [&](int k) { return sections[k].side; }), 0.1);
    half_up[i] = std::max(curve<double>(n, t, [&](int k) { return sections[k].up; }), 0.1);
    const Vector3d reach = Vector3d::Constant(std::max(half_side[i], half_up[i]));
    box.extend(centre[i] - reach);
    box.extend(centre[i] + reach);
  }
  std::vector<Piece> pieces;
  for (int i = 0; i + 1 < count; i++) {
    Piece s;
    s.a = centre[i];
    s.along = centre[i + 1] - centre[i];
    s.length2 = s.along.squaredNorm();
    s.tangent = s.along.normalized();
    s.side = (upwards[i] + upwards[i + 1]).cross(s.tangent).normalized();
    s.up = s.tangent.cross(s.side);
    s.side_a = half_side[i], s.side_b = half_side[i + 1];
    s.up_a = half_up[i], s.up_b = half_up[i + 1];
    s.first = i == 0, s.last = i + 2 == count;
    pieces.push_back(s);
  }
  return {[pieces, squareness, cap](const Vector3d& p) {
            return tubeDistance(pieces, squareness, cap, p);
          },
          box};
}

Shape plateShape(const std::vector<std::vector<Vector3d>>& grid,
                 const std::vector<std::vector<double>>& thickness) {
  constexpr int kSteps = 5;
  const int rows = static_cast<int>(grid.size()), columns = static_cast<int>(grid[0].size());
  const int m = (rows - 1) * kSteps + 1, n = (columns - 1) * kSteps + 1;
  TriMesh mesh;
  auto half = std::make_shared<std::vector<double>>();
  double most = 0;
  for (int i = 0; i < m; i++) {
    for (int j = 0; j < n; j++) {
      const double s = static_cast<double>(i) / kSteps, t = static_cast<double>(j) / kSteps;
      mesh.vertices.push_back(curve<Vector3d>(rows, s, [&](int r) {
        return curve<Vector3d>(columns, t, [&](int c) { return grid[r][c]; });
      }));
      half->push_back(curve<double>(rows, s,
                                    [&](int r) {
                                      return curve<double>(columns, t,
                                                           [&](int c) { return thickness[r][c]; });
                                    }) /
                      2);
      most = std::max(most, half->back());
      if (i > 0 && j > 0) {
        const int d = i * n + j, c = d - 1, b = d - n, a = b - 1;
        mesh.faces.push_back({a, b, d});
        mesh.faces.push_back({a, d, c});
      }
    }
  }
  const auto tree = std::make_shared<TriangleTree>(mesh);
  AlignedBox3d box = tree->box();
  box.extend(box.max() + Vector3d::Constant(most));
  box.extend(box.min() - Vector3d::Constant(most));
  return {[tree, half](const Vector3d& p) {
            const TriangleTree::Nearest near = tree->nearest(p);
            double thick = 0;
            for (int k = 0; k < 3; k++) {
              thick += near.weights[k] * (*half)[tree->mesh().faces[near.face][k]];
            }
            return near.distance - thick;
          },
          box};
}

Shape meshShape(const TriMesh& mesh) {
  const auto tree = std::make_shared<TriangleTree>(mesh);
  return {[tree](const Vector3d& p) { return tree->signedDistance(p); }, tree->box()};
}

Shape moved(const Shape& shape, const Affine3d& X) {
  const Affine3d back = X.inverse();
  const double scale = X.linear().col(0).norm();
  return {[=](const Vector3d& p) { return scale * shape.distance(back * p); },
          shape.box.transformed(X)};
}

Shape grown(const Shape& shape, double by) {
  const Vector3d reach = Vector3d::Constant(by);
  return {[=](const Vector3d& p) { return shape.distance(p) - by; },
          AlignedBox3d(shape.box.min() - reach, shape.box.max() + reach)};
}

Sculpture& Sculpture::add(const Shape& shape, double fillet) {
  steps_.push_back({Action::kAdd, shape, fillet});
  return *this;
}

Sculpture& Sculpture::cut(const Shape& shape, double fillet) {
  steps_.push_back({Action::kCut, shape, fillet});
  return *this;
}

Sculpture& Sculpture::clip(const Shape& shape, double fillet) {
  steps_.push_back({Action::kClip, shape, fillet});
  return *this;
}

Shape Sculpture::shape() const {
  AlignedBox3d box;
  for (const Step& s : steps_) {
    if (s.action != Action::kAdd) continue;
    const Vector3d bulge = Vector3d::Constant(s.fillet / 4);
    box.extend(s.shape.box.min() - bulge);
    box.extend(s.shape.box.max() + bulge);
  }
  const auto distance = [steps = steps_](const Vector3d& p) {
    double d = std::numeric_limits<double>::infinity();
    for (const Step& s : steps) {
      // A step whose box is too far away changes nothing; that spares most of the work.
      const double far = s.shape.box.isEmpty() ? 0 : s.shape.box.exteriorDistance(p);
      if (s.action == Action::kAdd) {
        if (far > d + s.fillet) continue;
        const double e = s.shape.distance(p);
        d = std::isinf(d) ? e : blend(d, e, s.fillet);
      } else if (s.action == Action::kCut) {
        if (-far < d - s.fillet) continue;
        d = -blend(-d, s.shape.distance(p), s.fillet);
      } else {
        d = -blend(-d, -s.shape.distance(p), s.fillet);
      }
    }
    return d;
  };
  return {distance, box};
}

std::vector<Shape> keptApart(const std::vector<Shape>& shapes, double gap) {
  std::vector<Shape> out;
  for (std::size_t i = 0; i < shapes.size(); i++) {
    std::vector<Shape> others;
    const AlignedBox3d near = grown(shapes[i], gap).box;
    for (std::size_t j = 0; j < shapes.size(); j++) {
      if (j != i && near.intersects(shapes[j].box)) others.push_back(shapes[j]);
    }
    const auto distance = [own = shapes[i], others, gap](const Vector3d& p) {
      const double mine = own.distance(p);
      double d = mine;
      for (const Shape& other : others) {
        if (mine + gap - other.box.exteriorDistance(p) < 2 * d) continue;
        d = std::max(d, (mine + gap - other.distance(p)) / 2);
      }
      return d;
    };
    out.push_back({distance, shapes[i].box});
  }
  return out;
}

TriMesh surface(const Shape& shape, double voxel, int max_faces, const Eigen::Affine3d& X) {
  FuseOptions options;
  options.voxel = voxel;
  options.max_faces = max_faces;
  options.fillet = 0;
  options.smoothing = 1;
  TriMesh mesh = surfaceOf(shape.distance, shape.box, options);
  for (Vector3d& v : mesh.vertices) v = X * v;
  return mesh;
}

}  // namespace torso
