// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "model/mesh_checks.h"
#include "model/simplify.h"

namespace torso {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using Eigen::Vector3i;

// Signed distance on a grid, negative inside; of a symmetric solid the left half.
class Field {
 public:
  Field(const AlignedBox3d& box, double voxel, bool symmetric) : h_(voxel), symmetric_(symmetric) {
    origin_ = box.min() - Vector3d::Constant(3 * h_);
    if (symmetric_) origin_.y() = 0;
    const Vector3d extent = box.max() + Vector3d::Constant(3 * h_) - origin_;
    for (int k = 0; k < 3; k++) size_[k] = static_cast<int>(std::ceil(extent[k] / h_)) + 1;
    value_.resize(std::size_t(size_[0]) * size_[1] * size_[2]);
  }

  // The solid's distance near its surface; further off only its sign is right.
  void sample(const Blend& solid) {
    for (int i = 0; i < size_[0]; i += kBlock) {
      for (int j = 0; j < size_[1]; j += kBlock) {
        for (int k = 0; k < size_[2]; k += kBlock) sampleBlock(solid, {i, j, k}, kBlock);
      }
    }
  }

  // Each node towards the mean of its six neighbours; planes stay where they are.
  void smooth() {
    const std::vector<double> old = value_;
    for (int i = 0; i < size_[0]; i++) {
      for (int j = 0; j < size_[1]; j++) {
        for (int k = 0; k < size_[2]; k++) {
          double sum = 0;
          for (int step : {-1, 1}) {
            const int jn = symmetric_ && j + step < 0 ? 1 : j + step;
            sum += old[index(std::clamp(i + step, 0, size_[0] - 1), j, k)];
            sum += old[index(i, std::clamp(jn, 0, size_[1] - 1), k)];
            sum += old[index(i, j, std::clamp(k + step, 0, size_[2] - 1))];
          }
          value_[index(i, j, k)] = 0.5 * old[index(i, j, k)] + sum / 12;
        }
      }
    }
  }

  // Evens out a mesh of the surface: vertices to the middle of their neighbours and back to the
  // surface.
  void relax(TriMesh& mesh) const {
    std::vector<Vector3d> sum(mesh.vertices.size());
    std::vector<double> count(mesh.vertices.size());
    for (int pass = 0; pass < 6; pass++) {
      std::fill(sum.begin(), sum.end(), Vector3d::Zero());
      std::fill(count.begin(), count.end(), 0);
      for (const auto& f : mesh.faces) {
        for (int k = 0; k < 3; k++) {
          sum[f[k]] += mesh.vertices[f[(k + 1) % 3]] + mesh.vertices[f[(k + 2) % 3]];
          count[f[k]] += 2;
        }
      }
      for (std::size_t i = 0; i < mesh.vertices.size(); i++) {
        Vector3d& v = mesh.vertices[i];
        const bool border = symmetric_ && v.y() == 0;
        v += 0.6 * (sum[i] / count[i] - v);
        for (int step = 0; step < 2; step++) {
          const auto [value, gradient] = sample(v);
          if (gradient.squaredNorm() > 0.05) v -= value / gradient.squaredNorm() * gradient;
        }
        if (border) v.y() = 0;
      }
    }
  }

  // Marching tetrahedra: closed, each edge between two faces (but for the plane y = 0 of a
  // symmetric field).
  TriMesh surface() const {
    TriMesh mesh;
    std::unordered_map<std::uint64_t, int> on_edge;
    const auto vertex = [&](const Vector3i& a, const Vector3i& b) {
      std::uint64_t ia = index(a[0], a[1], a[2]), ib = index(b[0], b[1], b[2]);
      const double va = value_[ia], vb = value_[ib];
      if (ia > ib) std::swap(ia, ib);
      const auto [it, is_new] = on_edge.emplace(ia * value_.size() + ib, mesh.vertices.size());
      if (is_new) {
        // Clear of the nodes, where faces would degenerate.
        const double t = std::clamp(va / (va - vb), 0.04, 0.96);
        mesh.vertices.push_back((1 - t) * node(a[0], a[1], a[2]) + t * node(b[0], b[1], b[2]));
      }
      return it->second;
    };
    const auto addFace = [&](int a, int b, int c, const Vector3d& outwards) {
      const auto& v = mesh.vertices;
      const bool flip = (v[b] - v[a]).cross(v[c] - v[a]).dot(outwards) < 0;
      mesh.faces.push_back({a, flip ? c : b, flip ? b : c});
    };
    // A cube is cut into six tetrahedra along its diagonal: one for each order of the axes.
    const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    for (int i = 0; i + 1 < size_[0]; i++) {
      for (int j = 0; j + 1 < size_[1]; j++) {
        for (int k = 0; k + 1 < size_[2]; k++) {
          bool any_in = false, any_out = false;
          for (int c = 0; c < 8; c++) {
            const bool in = value_[index(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2))] < 0;
            (in ? any_in : any_out) = true;
          }
          if (!any_in || !any_out) continue;
          for (const auto& order : orders) {
            Vector3i corner[4] = {{i, j, k}, {i, j, k}, {i, j, k}, {i, j, k}};
            for (int s = 0; s < 3; s++) {
              for (int q = s + 1; q < 4; q++) corner[q][order[s]]++;
            }
            std::vector<Vector3i> in, out;
            for (const Vector3i& c : corner) {
              (value_[index(c[0], c[1], c[2])] < 0 ? in : out).push_back(c);
            }
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
              addFace(vertex(in[0], out[0]), vertex(in[0], out[1]), vertex(in[0], out[2]),
                      outwards);
            } else {
              addFace(vertex(in[0], out[0]), vertex(in[1], out[0]), vertex(in[2], out[0]),
                      outwards);
            }
          }
        }
      }
    }
    return mesh;
  }

 private:
  static constexpr int kBlock = 4;

  // A cube of so many nodes, a power of two: at once if the surface is far from it, else by
  // eighths.
  void sampleBlock(const Blend& solid, const Vector3i& first, int nodes) {
    const double near = 2 * h_;
    if (nodes == 1) {
      value_[index(first[0], first[1], first[2])] =
          solid.distance(node(first[0], first[1], first[2]), near);
      return;
    }
    const double far = 0.5 * nodes * std::sqrt(3.0) * h_ + near;
    const Vector3d middle =
        node(first[0], first[1], first[2]) + Vector3d::Constant(0.5 * (nodes - 1) * h_);
    const double at_middle = solid.distance(middle, far);
    const bool empty = std::abs(at_middle) > far;
    const int step = empty ? 1 : nodes / 2;
    const Vector3i end = (first + Vector3i::Constant(nodes)).cwiseMin(size_);
    for (int i = first[0]; i < end[0]; i += step) {
      for (int j = first[1]; j < end[1]; j += step) {
        for (int k = first[2]; k < end[2]; k += step) {
          if (empty) {
            value_[index(i, j, k)] = at_middle;
          } else {
            sampleBlock(solid, {i, j, k}, step);
          }
        }
      }
    }
  }

  // Value and gradient, from the eight nodes around.
  std::pair<double, Vector3d> sample(const Vector3d& p) const {
    const Vector3i n = nodeBelow(p).cwiseMax(0).cwiseMin(size_ - Vector3i::Constant(2));
    const Vector3d t = (p - node(n[0], n[1], n[2])) / h_;
    double value = 0;
    Vector3d gradient = Vector3d::Zero();
    for (int c = 0; c < 8; c++) {
      const int bit[3] = {c & 1, c >> 1 & 1, c >> 2};
      const double x = value_[index(n[0] + bit[0], n[1] + bit[1], n[2] + bit[2])];
      double w[3], dw[3];
      for (int k = 0; k < 3; k++) {
        w[k] = bit[k] ? t[k] : 1 - t[k];
        dw[k] = (bit[k] ? 1 : -1) / h_;
      }
      value += w[0] * w[1] * w[2] * x;
      gradient += x * Vector3d(dw[0] * w[1] * w[2], w[0] * dw[1] * w[2], w[0] * w[1] * dw[2]);
    }
    return {value, gradient};
  }

  Vector3i nodeBelow(const Vector3d& p) const {
    return ((p - origin_) / h_).array().floor().cast<int>();
  }
  Vector3d node(int i, int j, int k) const { return origin_ + h_ * Vector3d(i, j, k); }
  std::size_t index(int i, int j, int k) const {
    return (std::size_t(i) * size_[1] + j) * size_[2] + k;
  }

  const double h_;
  const bool symmetric_;
  Vector3d origin_;
  Vector3i size_;
  std::vector<double> value_;
};

// A mesh with an open edge in the plane y = 0 and its mirror image, joined there.
TriMesh joinedWithMirror(const TriMesh& half) {
  TriMesh mesh = half;
  std::vector<int> image(half.vertices.size());
  for (std::size_t i = 0; i < half.vertices.size(); i++) {
    Vector3d v = half.vertices[i];
    image[i] = static_cast<int>(i);
    if (v.y() == 0) continue;
    image[i] = static_cast<int>(mesh.vertices.size());
    v.y() = -v.y();
    mesh.vertices.push_back(v);
  }
  for (const auto& f : half.faces) mesh.faces.push_back({image[f[0]], image[f[2]], image[f[1]]});
  return mesh;
}

// Without the crumbs and bubbles that grazing shapes leave.
TriMesh largestPart(const TriMesh& mesh) {
  std::vector<TriMesh> parts = connectedParts(mesh);
  const auto fewer = [](const TriMesh& a, const TriMesh& b) {
    return a.faces.size() < b.faces.size();
  };
  return parts.empty() ? mesh : *std::max_element(parts.begin(), parts.end(), fewer);
}

// Vertices back to the surface, each a little towards the middle of its neighbours.
void settle(const Blend& solid, double voxel, bool symmetric, TriMesh& mesh) {
  const std::size_t n = mesh.vertices.size();
  const double step = 0.25 * voxel, far = 2 * voxel;
  for (int pass = 0; pass < 2; pass++) {
    std::vector<Vector3d> sum(n, Vector3d::Zero());
    std::vector<int> count(n, 0);
    for (const auto& f : mesh.faces) {
      for (int k = 0; k < 3; k++) {
        sum[f[k]] += mesh.vertices[f[(k + 1) % 3]] + mesh.vertices[f[(k + 2) % 3]];
        count[f[k]] += 2;
      }
    }
    for (std::size_t i = 0; i < n; i++) {
      const Vector3d was = mesh.vertices[i];
      const bool border = symmetric && was.y() == 0;
      Vector3d v = was + 0.15 * (sum[i] / count[i] - was);
      if (border) v.y() = 0;
      const double d = solid.distance(v, far);
      Vector3d gradient;
      for (int k = 0; k < 3; k++) {
        gradient[k] = (solid.distance(v + step * Vector3d::Unit(k), far) - d) / step;
      }
      if (border) gradient.y() = 0;
      if (gradient.squaredNorm() > 0.05) v -= d / gradient.squaredNorm() * gradient;
      if ((v - was).norm() < 1.5 * voxel) mesh.vertices[i] = v;
    }
  }
}

}  // namespace

TriMesh surface(const Blend& solid, double voxel, int max_faces, bool symmetric, Finish finish) {
  Field field(solid.box(), voxel, symmetric);
  field.sample(solid);
  if (finish == Finish::kRounded) field.smooth();
  constexpr int kPasses = 4;
  for (int pass = 1;; pass++) {
    TriMesh mesh = largestPart(field.surface());
    field.relax(mesh);
    mesh = simplified(mesh, symmetric ? max_faces / 2 : max_faces);
    if (finish == Finish::kEven) settle(solid, voxel, symmetric, mesh);
    if (pass == kPasses || mesh.faces.empty() || MeshTree(mesh).selfIntersections().empty()) {
      return symmetric ? joinedWithMirror(mesh) : mesh;
    }
    field.smooth();  // spurs thinner than a voxel make faces cross
  }
}

}  // namespace torso
