// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/solid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <unordered_map>

#include "model/fuse.h"
#include "model/loft.h"

namespace torso {
namespace {

// A shape that is farther away than its fillet and the surface does not matter; its distance may
// fall short of the true one by this factor.
constexpr double kSlack = 0.5;

using Eigen::AlignedBox3d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3i;

// Distance to an ellipse or a box with rounded corners, exact only near the surface.
double sectionDistance(double s, double u, double side, double up, double exponent) {
  s = std::abs(s) / side;
  u = std::abs(u) / up;
  if (exponent == 2) {
    const double k0 = std::sqrt(s * s + u * u),
                 k1 = std::sqrt(s * s / (side * side) + u * u / (up * up));
    return k1 > 0 ? k0 * (k0 - 1) / k1 : -std::min(side, up);
  }
  const double ps = std::pow(s, exponent - 1), pu = std::pow(u, exponent - 1);
  const double sum = ps * s + pu * u;
  if (sum < 1e-12) return -std::min(side, up);
  const double k0 = std::pow(sum, 1 / exponent);
  const double k1 = k0 / sum * std::sqrt(ps * ps / (side * side) + pu * pu / (up * up));
  return (k0 - 1) / k1;
}

// Values of a solid on the nodes of a grid, known only near its surface, and that surface.
class Grid {
 public:
  Grid(const Solid& solid, AlignedBox3d box, double voxel, bool symmetric) : h_(voxel) {
    origin_ = box.min() - Vector3d::Constant(2.5 * h_);
    if (symmetric) origin_.y() = 0;
    const Vector3d extent = box.max() + Vector3d::Constant(2.5 * h_) - origin_;
    for (int k = 0; k < 3; k++) {
      blocks_[k] = static_cast<int>(std::ceil(extent[k] / (h_ * kBlock)));
      size_[k] = blocks_[k] * kBlock + 1;
    }
    value_.assign(std::size_t(size_[0]) * size_[1] * size_[2],
                  std::numeric_limits<double>::quiet_NaN());
    // Shapes' distances are not exact, so a block is left out only well away from the surface.
    const double reach = 1.7 * h_ * kBlock * std::sqrt(3.0) / 2;
    for (int i = 0; i < blocks_[0]; i++) {
      for (int j = 0; j < blocks_[1]; j++) {
        for (int k = 0; k < blocks_[2]; k++) {
          const Vector3i first = kBlock * Vector3i(i, j, k);
          const Vector3d centre = node(first) + Vector3d::Constant(0.5 * h_ * kBlock);
          if (std::abs(solid.distance(centre)) > reach) continue;
          active_.push_back(first);
          fill(solid, first);
        }
      }
    }
  }

  // Marching tetrahedra: each edge lies between two faces (but for those in the plane y = 0 of a
  // symmetric solid).
  TriMesh surface() const {
    TriMesh mesh;
    std::unordered_map<std::uint64_t, int> on_edge;
    const auto vertex = [&](Vector3i a, Vector3i b) {
      std::uint64_t ia = index(a), ib = index(b);
      if (ia > ib) std::swap(ia, ib), std::swap(a, b);
      const auto [it, is_new] = on_edge.emplace(ia * value_.size() + ib, mesh.vertices.size());
      if (is_new) {
        // Clear of the nodes, where faces would degenerate.
        const double t = std::clamp(value_[ia] / (value_[ia] - value_[ib]), 0.04, 0.96);
        mesh.vertices.push_back((1 - t) * node(a) + t * node(b));
      }
      return it->second;
    };
    const auto addFace = [&](int a, int b, int c, const Vector3d& outwards) {
      const auto& v = mesh.vertices;
      const bool flip = (v[b] - v[a]).cross(v[c] - v[a]).dot(outwards) < 0;
      mesh.faces.push_back({a, flip ? c : b, flip ? b : c});
    };
    for (const Vector3i& first : active_) {
      for (int n = 0; n < kBlock * kBlock * kBlock; n++) {
        const Vector3i cell =
            first + Vector3i(n / (kBlock * kBlock), n / kBlock % kBlock, n % kBlock);
        int inside = 0;
        for (int c = 0; c < 8; c++) {
          inside += value_[index(cell + Vector3i(c & 1, c >> 1 & 1, c >> 2))] < 0;
        }
        if (inside == 0 || inside == 8) continue;
        // Six tetrahedra along the diagonal: one for each order of the axes.
        static constexpr int kOrders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                              {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
        for (const auto& order : kOrders) {
          Vector3i corner[4] = {cell, cell, cell, cell};
          for (int s = 0; s < 3; s++) {
            for (int q = s + 1; q < 4; q++) corner[q][order[s]]++;
          }
          std::vector<Vector3i> in, out;
          for (const Vector3i& c : corner) (value_[index(c)] < 0 ? in : out).push_back(c);
          if (in.empty() || out.empty()) continue;
          Vector3d outwards = Vector3d::Zero();
          for (const Vector3i& c : out) outwards += c.cast<double>() / double(out.size());
          for (const Vector3i& c : in) outwards -= c.cast<double>() / double(in.size());
          if (in.size() == 2) {
            const int a = vertex(in[0], out[0]), b = vertex(in[0], out[1]),
                      c = vertex(in[1], out[1]), d = vertex(in[1], out[0]);
            addFace(a, b, c, outwards);
            addFace(a, c, d, outwards);
          } else if (in.size() == 1) {
            addFace(vertex(in[0], out[0]), vertex(in[0], out[1]), vertex(in[0], out[2]), outwards);
          } else {
            addFace(vertex(in[0], out[0]), vertex(in[1], out[0]), vertex(in[2], out[0]), outwards);
          }
        }
      }
    }
    return mesh;
  }

 private:
  static constexpr int kBlock = 8;

  void fill(const Solid& whole, const Vector3i& first) {
    const AlignedBox3d block(node(first), node(first + Vector3i::Constant(kBlock)));
    const Solid solid = whole.near(block, block.diagonal().norm());
    for (int i = 0; i <= kBlock; i++) {
      for (int j = 0; j <= kBlock; j++) {
        for (int k = 0; k <= kBlock; k++) {
          const Vector3i n = first + Vector3i(i, j, k);
          double& value = value_[index(n)];
          if (std::isnan(value)) value = solid.distance(node(n));
        }
      }
    }
  }

  Vector3d node(const Vector3i& n) const { return origin_ + h_ * n.cast<double>(); }
  std::size_t index(const Vector3i& n) const {
    return (std::size_t(n[0]) * size_[1] + n[1]) * size_[2] + n[2];
  }

  double h_;
  Vector3d origin_;
  Vector3i size_, blocks_;
  std::vector<double> value_;
  std::vector<Vector3i> active_;
};

// Vertices by the share `even` of the way to the middle of their neighbours, for even faces, and
// back to the surface.
void relax(const Solid& whole, double voxel, bool symmetric, int passes, double even,
           TriMesh& mesh) {
  const std::size_t n = mesh.vertices.size();
  // What is near to a vertex, by the cell of a coarse grid that it lies in.
  const double cell = 8 * voxel;
  std::map<std::array<int, 3>, Solid> by_cell;
  std::vector<const Solid*> solids(n);
  for (std::size_t i = 0; i < n; i++) {
    const Vector3i at = (mesh.vertices[i] / cell).array().floor().cast<int>();
    const auto [it, is_new] = by_cell.emplace(std::array<int, 3>{at[0], at[1], at[2]}, Solid());
    if (is_new) {
      AlignedBox3d region(cell * at.cast<double>(), cell * (at + Vector3i::Ones()).cast<double>());
      region.min().array() -= 3 * voxel;
      region.max().array() += 3 * voxel;
      it->second = whole.near(region, 4 * voxel);
    }
    solids[i] = &it->second;
  }
  const double step = 0.25 * voxel;
  const auto gradient = [&](std::size_t i, double d) {
    const Vector3d& v = mesh.vertices[i];
    Vector3d g;
    for (int k = 0; k < 3; k++)
      g[k] = (solids[i]->distance(v + step * Vector3d::Unit(k)) - d) / step;
    if (symmetric && v.y() == 0) g.y() = 0;
    return g;
  };
  std::vector<Vector3d> sum(n), downhill(n);
  std::vector<int> count(n);
  for (int pass = 0; pass < passes; pass++) {
    std::fill(sum.begin(), sum.end(), Vector3d::Zero());
    std::fill(count.begin(), count.end(), 0);
    for (const auto& f : mesh.faces) {
      for (int k = 0; k < 3; k++) {
        sum[f[k]] += mesh.vertices[f[(k + 1) % 3]] + mesh.vertices[f[(k + 2) % 3]];
        count[f[k]] += 2;
      }
    }
    for (std::size_t i = 0; i < n; i++) {
      Vector3d& v = mesh.vertices[i];
      const bool border = symmetric && v.y() == 0;
      const Vector3d was = v;
      v += even * (sum[i] / count[i] - v);
      if (border) v.y() = 0;
      const double d = solids[i]->distance(v);
      if (pass % 2 == 0) downhill[i] = gradient(i, d);
      const double slope = downhill[i].squaredNorm();
      if (slope > 0.05) v -= d / slope * downhill[i];
      if ((v - was).norm() > 1.5 * voxel) v = was;  // a place without a clear gradient
    }
  }
}

// A mesh with an open edge in the plane y = 0 and its mirror image, joined there.
TriMesh joinedWithMirror(const TriMesh& half) {
  TriMesh mesh = half;
  std::vector<int> image(half.vertices.size());
  for (std::size_t i = 0; i < half.vertices.size(); i++) {
    const Vector3d& v = half.vertices[i];
    image[i] = static_cast<int>(v.y() == 0 ? i : mesh.vertices.size());
    if (v.y() != 0) mesh.vertices.push_back({v.x(), -v.y(), v.z()});
  }
  for (const auto& f : half.faces) mesh.faces.push_back({image[f[0]], image[f[2]], image[f[1]]});
  return mesh;
}

}  // namespace

Shape ellipsoidShape(const Vector3d& centre, const Vector3d& half_axes, const Matrix3d& axes) {
  Shape shape;
  const Vector3d reach = (axes * half_axes.asDiagonal()).rowwise().norm();
  shape.box = AlignedBox3d(centre - reach, centre + reach);
  const Matrix3d into = axes.transpose();
  shape.distance = [=](const Vector3d& p) {
    const Vector3d q = into * (p - centre);
    const double k0 = q.cwiseQuotient(half_axes).norm();
    const double k1 = q.cwiseQuotient(half_axes.cwiseAbs2()).norm();
    return k1 > 0 ? k0 * (k0 - 1) / k1 : -half_axes.minCoeff();
  };
  return shape;
}

Shape sweepShape(const std::vector<SweepPoint>& points, const SweepStyle& style) {
  struct Piece {
    Vector3d from, along;
    double inverse_squared_length, side0, side1, up0, up1;
  };
  std::vector<Vector3d> centres, axes;
  for (const SweepPoint& p : points) {
    centres.push_back(p.centre);
    axes.push_back({p.side, p.up, 0});
  }
  std::vector<Piece> pieces;
  Shape shape;
  const int n = style.steps * (static_cast<int>(points.size()) - 1);
  for (int i = 0; i < n; i++) {
    const double t0 = double(i) / style.steps, t1 = double(i + 1) / style.steps;
    const Vector3d a = curveAt(centres, t0), b = curveAt(centres, t1), r0 = curveAt(axes, t0),
                   r1 = curveAt(axes, t1);
    pieces.push_back({a, b - a, 1 / (b - a).squaredNorm(), r0[0], r1[0], r0[1], r1[1]});
    const double reach = std::max(std::max(r0[0], r0[1]), std::max(r1[0], r1[1]));
    for (const Vector3d& end : {a, b}) {
      shape.box.extend(end - Vector3d::Constant(reach));
      shape.box.extend(end + Vector3d::Constant(reach));
    }
  }
  const Vector3d up = style.up.normalized();
  const double exponent = style.squareness;
  shape.distance = [=](const Vector3d& p) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Piece& piece : pieces) {
      const Vector3d from = p - piece.from;
      const double t = std::clamp(from.dot(piece.along) * piece.inverse_squared_length, 0.0, 1.0);
      const Vector3d away = from - t * piece.along;
      const double side = piece.side0 + t * (piece.side1 - piece.side0);
      const double high = piece.up0 + t * (piece.up1 - piece.up0);
      const double reach = nearest + std::max(side, high);
      if (reach > 0 && away.squaredNorm() > reach * reach) continue;
      const double u = away.dot(up);
      const double s = std::sqrt(std::max(0.0, away.squaredNorm() - u * u));
      nearest = std::min(nearest, sectionDistance(s, u, side, high, exponent));
    }
    return nearest;
  };
  return shape;
}

Shape sheetShape(const Sheet& sheet) {
  Shape shape;
  for (const Vector2d& p : sheet.outline) {
    for (double side : {1.0, -1.0}) {
      const double reach = side * (sheet.max_height + sheet.max_half_thickness);
      shape.box.extend(sheet.frame * Vector3d(p.x(), p.y(), reach));
    }
  }
  const Eigen::Isometry3d into = sheet.frame.inverse();
  shape.distance = [=](const Vector3d& p) {
    const Vector3d q = into * p;
    const double across = std::abs(q.z() - sheet.middle(q.x(), q.y()));
    const double above = across - sheet.max_half_thickness;
    if (above > 3 * sheet.max_half_thickness) return above;  // far away
    // Signed distance to the outline, positive outside.
    double nearest = std::numeric_limits<double>::infinity();
    bool inside = false;
    const std::size_t n = sheet.outline.size();
    for (std::size_t i = 0, j = n - 1; i < n; j = i++) {
      const Vector2d &a = sheet.outline[i], &b = sheet.outline[j];
      const Vector2d e = b - a, w = q.head<2>() - a;
      const double t = std::clamp(w.dot(e) / e.squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (w - t * e).squaredNorm());
      if ((a.y() > q.y()) != (b.y() > q.y()) &&
          q.x() < a.x() + (q.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) {
        inside = !inside;
      }
    }
    const double edge = (inside ? -1 : 1) * std::sqrt(nearest);
    const double inset = std::max(0.0, -edge);
    const double half = sheet.half_thickness(q.x(), q.y(), inset);
    // Rounded edge: the distance to a sheet without thickness, narrower by `half`.
    const double out = edge + half;
    return out > 0 ? std::sqrt(across * across + out * out) - half : across - half;
  };
  return shape;
}

std::vector<Vector2d> smoothOutline(const std::vector<Vector2d>& points, int steps) {
  const std::size_t n = points.size();
  std::vector<Vector3d> closed;  // with three more points on either side, for smooth ends
  for (std::size_t i = 0; i < n + 3; i++) {
    const Vector2d& p = points[(i + n - 1) % n];
    closed.push_back({p.x(), p.y(), 0});
  }
  std::vector<Vector2d> out;
  for (std::size_t i = 0; i < n * steps; i++) {
    out.push_back(curveAt(closed, 1 + double(i) / steps).head<2>());
  }
  return out;
}

Shape mirrored(const Shape& shape) {
  const auto flip = [](const Vector3d& p) { return Vector3d(p.x(), -p.y(), p.z()); };
  AlignedBox3d box;
  box.extend(flip(shape.box.min()));
  box.extend(flip(shape.box.max()));
  return {[=](const Vector3d& p) { return shape.distance(flip(p)); }, box};
}

void Solid::add(const Shape& shape, double fillet) {
  parts_.push_back({std::make_shared<Shape>(shape), false, fillet});
}
void Solid::cut(const Shape& shape, double fillet) {
  parts_.push_back({std::make_shared<Shape>(shape), true, fillet});
}

void Solid::addPair(const Shape& left, double fillet) {
  add(left, fillet);
  add(mirrored(left), fillet);
}

void Solid::cutPair(const Shape& left, double fillet) {
  cut(left, fillet);
  cut(mirrored(left), fillet);
}

double Solid::distance(const Vector3d& p) const {
  double d = std::numeric_limits<double>::infinity();
  for (const Part& part : parts_) {
    const double sign = part.cut ? -1 : 1, mine = sign * d;
    const double least = part.shape->box.exteriorDistance(p);
    if (least > 0 && kSlack * least > (part.cut ? -d : d) + part.fillet) continue;
    const double other = part.shape->distance(p);
    const double h =
        part.fillet > 0 ? std::max(part.fillet - std::abs(mine - other), 0.0) / part.fillet : 0;
    // Cutting is uniting the outside.
    const double united = std::min(mine, other) - 0.25 * h * h * part.fillet;
    d = std::isinf(d) && !part.cut ? other : sign * united;
  }
  return d;
}

Solid Solid::near(const AlignedBox3d& region, double reach) const {
  Solid out;
  for (const Part& part : parts_) {
    if (kSlack * part.shape->box.exteriorDistance(region) <= reach + part.fillet) {
      out.parts_.push_back(part);
    }
  }
  return out;
}

TriMesh Solid::surface(double voxel, int max_faces, bool symmetric) const {
  AlignedBox3d box;
  for (const Part& part : parts_) {
    if (!part.cut) box.extend(part.shape->box);
  }
  TriMesh mesh;
  for (const TriMesh& part : connectedParts(Grid(*this, box, voxel, symmetric).surface())) {
    AlignedBox3d extent;
    for (const Vector3d& v : part.vertices) extent.extend(v);
    if (extent.diagonal().norm() > 5 * voxel) append(mesh, part);  // not a crumb of a fillet
  }
  relax(*this, voxel, symmetric, 4, 0.6, mesh);
  mesh = simplified(mesh, symmetric ? max_faces / 2 : max_faces);
  relax(*this, voxel, symmetric, 2, 0.15, mesh);  // thinning leaves edges rough
  return symmetric ? joinedWithMirror(mesh) : mesh;
}

}  // namespace torso
