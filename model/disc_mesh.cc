// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// The structured mesh of a disc.

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "model/disc.h"

namespace torso {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// The outline's share of its bounding rectangle, as endplates have (an ellipse has 0.785).
constexpr double kOutlineFill = 0.82;
// Share of the depth that lies in front of the widest place.
constexpr double kFrontShare = 0.6;
// The nucleus: its share of the area (0.43-0.465 in the five lumbar discs of Remus et al. 2021,
// PLoS ONE 16:e0250456; 0.3-0.5 in finite-element models since Shirazi-Adl et al. 1984, Spine
// 9:120-134), and how far behind the centre it lies, as a share of the depth (0.02-0.06 there).
constexpr double kNucleusShare = 0.43;
constexpr double kNucleusShift = 0.05;
// Of the coarsest mesh.
constexpr int kSectors = 12, kAnnulusRings = 2, kLayers = 4;
constexpr int kCellLayers = 2;  // layers in a cell of the annulus

// Left half of the outline from the foremost to the rearmost point: a quarter of a superellipse in
// front and a flatter one (larger exponent) behind. Bounding box: width x depth about the origin.
std::vector<Vector2d> halfOutline(double width, double depth, double exponent) {
  constexpr int kSamples = 2000;
  std::vector<Vector2d> points;
  for (int i = 0; i <= kSamples; ++i) {
    const double angle = M_PI * i / kSamples;
    const bool front = 2 * i <= kSamples;
    const double power = 2 / (front ? exponent : exponent + 1);
    const double half_depth = depth * (front ? kFrontShare : 1 - kFrontShare);
    const double c = std::pow(std::abs(std::cos(angle)), power);
    const double s = std::pow(std::sin(angle), power);
    points.emplace_back(depth * (0.5 - kFrontShare) + (front ? c : -c) * half_depth, s * width / 2);
  }
  points.front() = {depth / 2, 0};
  points.back() = {-depth / 2, 0};
  return points;
}

// n + 1 points that divide a polyline into n parts of equal length.
std::vector<Vector2d> divide(const std::vector<Vector2d>& line, int n) {
  std::vector<double> length(line.size(), 0);
  for (size_t i = 1; i < line.size(); ++i) {
    length[i] = length[i - 1] + (line[i] - line[i - 1]).norm();
  }
  std::vector<Vector2d> points = {line.front()};
  for (int k = 1; k < n; ++k) {
    const double s = length.back() * k / n;
    const size_t i = std::upper_bound(length.begin(), length.end(), s) - length.begin();
    const double t = (s - length[i - 1]) / (length[i] - length[i - 1]);
    points.push_back((1 - t) * line[i - 1] + t * line[i]);
  }
  points.push_back(line.back());
  return points;
}

double largestY(const std::vector<Vector2d>& points) {
  double y = 0;
  for (const auto& p : points) y = std::max(y, p.y());
  return y;
}

// One layer of nodes, ring by ring around node 0; each ring counter-clockwise from the foremost.
struct Plane {
  int ring_size(int ring) const { return first[ring + 1] - first[ring]; }
  int node(int ring, int i) const { return first[ring] + i % ring_size(ring); }

  std::vector<Vector2d> nodes;
  std::vector<int> first;                     // (ring + 1) its first node; ring 0 is node 0
  std::vector<std::array<int, 3>> triangles;  // counter-clockwise
  std::vector<int> ring, sector;              // (triangle) ring outside of it, its sector there
};

// The nodes. The polygon of the last ring has the outline's extents and area.
Plane layerNodes(const DiscShape& shape, int refinement) {
  const int sectors = kSectors * refinement;
  // The polygon cuts corners of the outline, so the exponent is found for the polygon.
  double low = 1.5, high = 12;
  for (int i = 0; i < 60; ++i) {
    const double exponent = (low + high) / 2;
    const auto p = divide(halfOutline(shape.width, shape.depth, exponent), sectors / 2);
    double area = 0;  // of both halves
    for (size_t k = 1; k < p.size(); ++k) {
      area += p[k - 1].x() * p[k].y() - p[k].x() * p[k - 1].y();
    }
    area *= shape.width / 2 / largestY(p);
    (area < kOutlineFill * shape.width * shape.depth ? low : high) = exponent;
  }
  const auto line = halfOutline(shape.width, shape.depth, low);
  const double stretch = shape.width / 2 / largestY(divide(line, sectors / 2));
  const double nucleus = std::sqrt(kNucleusShare);  // its radius over the outline's
  const int annulus_rings = kAnnulusRings * refinement;
  Plane plane;
  plane.nodes = {Vector2d(-kNucleusShift * shape.depth, 0)};
  plane.first = {0, 1};
  for (int k = 1; k <= refinement + annulus_rings; ++k) {
    const int size = std::min(kSectors * k, sectors);
    const double outwards = std::max(0, k - refinement) / static_cast<double>(annulus_rings);
    const double radius =
        k <= refinement ? nucleus * k / refinement : nucleus + (1 - nucleus) * outwards;
    const auto left = divide(line, size / 2);
    for (int i = 0; i < size; ++i) {
      const bool mirrored = i > size / 2;
      Vector2d p = left[mirrored ? size - i : i];
      p.y() *= mirrored ? -stretch : stretch;
      plane.nodes.emplace_back(radius * p -
                               Vector2d(kNucleusShift * shape.depth * (1 - outwards), 0));
    }
    plane.first.push_back(static_cast<int>(plane.nodes.size()));
  }
  return plane;
}

// The triangles between the rings: the left half, each with its mirror image.
void addTriangles(Plane* plane) {
  const auto add = [plane](std::array<int, 3> t, int ring, int sector) {
    plane->triangles.push_back(t);
    plane->ring.push_back(ring);
    plane->sector.push_back(sector);
  };
  for (int k = 1; k + 1 < static_cast<int>(plane->first.size()); ++k) {
    const int outer = plane->ring_size(k), inner = plane->ring_size(k - 1);
    // a, b: steps done along the outer and the inner ring; the one behind goes next.
    for (int a = 0, b = 0; a < outer / 2 || b < inner / 2;) {
      const bool step_outer = (2 * a + 1) * (inner / 2) <= (2 * b + 1) * (outer / 2);
      const int sector = step_outer ? a : std::max(a - 1, 0);
      // Nodes of the triangle, and of its mirror image, by ring and place.
      const int a1 = outer - a, b1 = inner - b;
      if (step_outer) {
        add({plane->node(k - 1, b), plane->node(k, a), plane->node(k, a + 1)}, k, sector);
        add({plane->node(k - 1, b1), plane->node(k, a1 - 1), plane->node(k, a1)}, k,
            outer - 1 - sector);
        ++a;
      } else {
        add({plane->node(k - 1, b), plane->node(k, a), plane->node(k - 1, b + 1)}, k, sector);
        add({plane->node(k - 1, b1), plane->node(k - 1, b1 - 1), plane->node(k, a1)}, k,
            outer - 1 - sector);
        ++b;
      }
    }
  }
}

// Rank by which a prism's quadrilaterals are cut; a node and its mirror image have the same.
std::vector<int> mirrorRanks(const Plane& plane) {
  std::vector<int> rank = {0};
  int next = 1;
  for (int k = 1; k + 1 < static_cast<int>(plane.first.size()); ++k) {
    const int size = plane.ring_size(k);
    for (int i = 0; i < size; ++i) rank.push_back(next + std::min(i, size - i));
    next += size / 2 + 1;
  }
  return rank;
}

double signedVolume(const DiscMesh& mesh, const std::array<int, 4>& t) {
  const Vector3d& a = mesh.rest_positions[t[0]];
  return (mesh.rest_positions[t[1]] - a)
             .cross(mesh.rest_positions[t[2]] - a)
             .dot(mesh.rest_positions[t[3]] - a) /
         6;
}

}  // namespace

DiscMesh makeDiscMesh(const DiscShape& shape, int refinement) {
  for (double size : {shape.width, shape.depth, shape.height_anterior, shape.height_posterior}) {
    if (!(size > 0) || !std::isfinite(size)) {
      throw std::invalid_argument("disc shape: width, depth and heights must be positive");
    }
  }
  if (refinement < 1) throw std::invalid_argument("disc mesh: refinement must be at least 1");
  Plane plane = layerNodes(shape, refinement);
  addTriangles(&plane);
  const int n = static_cast<int>(plane.nodes.size());
  const int layers = kLayers * refinement, annulus_rings = kAnnulusRings * refinement;
  const int sectors = kSectors * refinement;
  DiscMesh mesh;
  for (int j = 0; j <= layers; ++j) {
    for (const auto& p : plane.nodes) {
      const double front = p.x() / shape.depth + 0.5;
      const double height =
          shape.height_posterior + front * (shape.height_anterior - shape.height_posterior);
      mesh.rest_positions.emplace_back(p.x(), p.y(), height * (2 * j - layers) / (2.0 * layers));
    }
  }
  for (int i = 0; i < n; ++i) {
    mesh.lower_nodes.push_back(i);
    mesh.upper_nodes.push_back(layers * n + i);
  }
  const auto rank = mirrorRanks(plane);
  for (int j = 0; j < layers; ++j) {
    for (size_t k = 0; k < plane.triangles.size(); ++k) {
      auto t = plane.triangles[k];
      // Each quadrilateral is cut from the bottom of its first node to the top of its second. The
      // order is reversed half way up, which makes the mesh symmetric about z = 0 too.
      const int sign = 2 * j < layers ? -1 : 1;
      std::sort(t.begin(), t.end(), [&](int a, int b) { return sign * rank[a] < sign * rank[b]; });
      const int a0 = j * n + t[0], b0 = j * n + t[1], c0 = j * n + t[2];
      const int a1 = a0 + n, b1 = b0 + n, c1 = c0 + n;
      const int ring = plane.ring[k] - refinement - 1;  // of the annulus
      const int cell = ring < 0
                           ? DiscMesh::kNucleus
                           : (j / kCellLayers * annulus_rings + ring) * sectors + plane.sector[k];
      for (std::array<int, 4> tet :
           {std::array<int, 4>{a0, b0, c0, c1}, std::array<int, 4>{a0, b0, c1, b1},
            std::array<int, 4>{a0, b1, c1, a1}}) {
        if (signedVolume(mesh, tet) < 0) std::swap(tet[2], tet[3]);
        mesh.tets.push_back(tet);
        mesh.cells.push_back(cell);
      }
    }
  }
  for (int j = 0; j < layers; j += kCellLayers) {
    for (int k = 0; k < annulus_rings; ++k) {
      for (int i = 0; i < sectors; ++i) {
        const int ring = refinement + 1 + k;
        mesh.hoops.push_back({j * n + plane.node(ring, i), j * n + plane.node(ring, i + 1)});
      }
    }
  }
  return mesh;
}

}  // namespace torso
