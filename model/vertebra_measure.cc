// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/vertebra_measure.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "model/mesh_section.h"

namespace torso {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Plane z = a + b x + c y through points, by least squares.
Vector3d fitPlane(const std::vector<Vector3d>& points) {
  Matrix3d A = Matrix3d::Zero();
  Vector3d b = Vector3d::Zero();
  for (const Vector3d& p : points) {
    const Vector3d row(1, p.x(), p.y());
    A += row * row.transpose();
    b += p.z() * row;
  }
  return A.ldlt().solve(b);
}

}  // namespace

std::optional<FaceRegion> findFace(const MeshTree& bone, const Vector3d& near,
                                   const Vector3d& outwards, const Vector3d& up, double size) {
  const double mm = 1e-3 * size, step = 0.4 * mm, flat = 0.6 * mm;
  constexpr int kHalf = 30;  // of the grid
  FaceRegion face{near, outwards, 0, 0, 0};
  for (int pass = 0; pass < 6; pass++) {
    const Vector3d along = (up - up.dot(face.normal) * face.normal).normalized();
    const Vector3d across = along.cross(face.normal);
    // The first passes see the middle of the face only, from further away.
    const int reach = pass < 2 ? 7 : pass < 3 ? 11 : kHalf;
    const double far = (pass < 2 ? 4 : 2) * mm, bound = pass == 0  ? far
                                                        : pass < 3 ? 2 * flat
                                                                   : flat;
    const auto height = [&](int i, int j) {  // over the plane; NaN beyond the face
      const Vector3d p = face.centre + step * (i * across + j * along);
      const double h = far - bone.castRay(p + far * face.normal, -face.normal).distance;
      return std::abs(h) < bound ? h : kNaN;
    };
    std::vector<Vector3d> points;
    double low_u = 0, high_u = 0, low_v = 0, high_v = 0;
    // Row by row from the middle, both ways; a row is what hangs together about the last one's
    // middle. It ends where the face does, or at a neck beyond which the bone goes on flat.
    for (int way : {1, -1}) {
      int middle = 0, least = 2 * reach + 1;
      for (int j = way > 0 ? 0 : -1; std::abs(j) <= reach; j += way) {
        double h = height(middle, j);
        if (!std::isfinite(h)) break;
        std::vector<Vector3d> row = {{middle * step, j * step, h}};
        int ends[2] = {middle, middle};
        for (int side : {0, 1}) {
          for (int i = middle + (side ? 1 : -1); std::abs(i) <= reach; i += side ? 1 : -1) {
            if (!std::isfinite(h = height(i, j))) break;
            row.push_back({i * step, j * step, h});
            ends[side] = i;
          }
        }
        const int width = static_cast<int>(row.size());
        if (pass >= 3 && width > 1.15 * least + 1) break;
        if (std::abs(j) * step > 2 * mm) least = std::min(least, width);
        middle = (ends[0] + ends[1]) / 2;
        points.insert(points.end(), row.begin(), row.end());
        low_u = std::min(low_u, ends[0] * step);
        high_u = std::max(high_u, ends[1] * step);
        low_v = std::min(low_v, j * step);
        high_v = std::max(high_v, j * step);
      }
    }
    if (points.size() < 12) return std::nullopt;
    face.width = high_u - low_u + step;
    face.height = high_v - low_v + step;
    face.area = points.size() * step * step;
    const Vector3d plane = fitPlane(points);
    const double u = (low_u + high_u) / 2, v = (low_v + high_v) / 2;
    face.centre += u * across + v * along + (plane[0] + plane[1] * u + plane[2] * v) * face.normal;
    face.normal = (face.normal - plane[1] * across - plane[2] * along).normalized();
  }
  return face;
}

VertebraShape::VertebraShape(const MeshTree& bone, double size) : bone_(bone), mm_(1e-3 * size) {
  upper_ = findEndplate(true);
  lower_ = findEndplate(false);
  pedicle_ = findPedicle();
}

double VertebraShape::surface(bool upper, double x, double y) const {
  const double sign = upper ? 1 : -1, from = 25 * mm_;
  const double t = ray({x, y, sign * from}, {0, 0, -sign});
  return t < from ? sign * (from - t) : kNaN;
}

VertebraShape::Endplate VertebraShape::findEndplate(bool upper) const {
  const double sign = upper ? 1 : -1, off = 0.1 * mm_;  // off the mid-line's edges
  // The waist bounds where to look first.
  const double front = ray({0, off, 0}, Vector3d::UnitX()),
               back = ray({0, off, 0}, -Vector3d::UnitX());
  Endplate plate{0, 0, front, -back, front + back, front + back};
  for (int pass = 0; pass < 3; pass++) {
    // The middle first, then a ring near the edge, which is what stands out of a hollow endplate;
    // not the sides, where the neck's uncinate processes rise.
    std::vector<Vector3d> points;
    const double centre = (plate.front + plate.back) / 2;
    for (int k = 0; k < 24; k++) {
      const double a = 2 * M_PI * (k + 0.5) / 24, r = pass == 0 ? 0.3 : 0.82;
      if (std::abs(std::sin(a)) > 0.7) continue;
      const double x = centre + r * plate.depth / 2 * std::cos(a);
      const double y = r * plate.width / 2 * std::sin(a);
      const double z = surface(upper, x, y);
      if (std::isfinite(z)) points.push_back({x, y, z});
    }
    if (points.size() < 6) return {kNaN, kNaN, kNaN, kNaN, kNaN, kNaN};
    const Vector3d plane = fitPlane(points);
    plate.height = plane[0];
    plate.slope = plane[1];
    const Vector3d along = Vector3d(1, 0, plate.slope).normalized();
    const auto inSlice = [&](double x) { return Vector3d(x, off, plate.at(x) - sign * 1.5 * mm_); };
    const double a = ray(inSlice(0), along), b = ray(inSlice(0), -along);
    plate.front = a * along.x();
    plate.back = -b * along.x();
    plate.depth = a + b;
    double width = 0;
    for (int k = 0; k <= 24; k++) {
      const Vector3d p = inSlice(plate.depth * (-0.25 + 0.6 * k / 24));
      const double w = chord(p, Vector3d::UnitY());
      if (w < 2 * plate.depth) width = std::max(width, w);
    }
    plate.width = width;
  }
  return plate;
}

double VertebraShape::height(bool anterior) const {
  double most = kNaN;
  for (double in = 1; in <= 3; in += 0.25) {
    const double x = anterior ? std::min(upper_.front, lower_.front) - in * mm_
                              : std::max(upper_.back, lower_.back) + in * mm_;
    const double h = surface(true, x, 0.1 * mm_) - surface(false, x, 0.1 * mm_);
    if (!(h <= most)) most = h;
  }
  return most;
}

double VertebraShape::backWall(double z) const {
  return -ray({0, 0.1 * mm_, z}, -Vector3d::UnitX());
}

double VertebraShape::canalDepth() const {
  double least = kNaN;
  const double top = 0.9 * upper_.height, bottom = 0.9 * lower_.height;
  for (int k = 0; k <= 40; k++) {
    const double z = bottom + (top - bottom) * k / 40, in = 0.2 * mm_;
    const double depth = in + ray({backWall(z) - in, 0.1 * mm_, z}, -Vector3d::UnitX());
    if (std::isfinite(depth) && !(depth >= least)) least = depth;
  }
  return least;
}

std::optional<VertebraShape::Pedicle> VertebraShape::findPedicle() const {
  if (!std::isfinite(upper_.height) || !std::isfinite(lower_.height)) return std::nullopt;
  std::vector<Pedicle> sections;
  const double step = 0.4 * mm_;
  for (double behind = 1.5; behind <= 5.5; behind += 0.5) {
    const double x = backWall(0) - behind * mm_;
    // Heights at which there is a wall beside the canal, not further out than 3 mm beyond the
    // nearest; of those the stretch about the nearest.
    std::vector<double> wall, level;
    for (double z = 0.8 * lower_.height; z <= upper_.height + 4 * mm_; z += step) {
      level.push_back(z);
      wall.push_back(ray({x, 0, z}, Vector3d::UnitY()));
    }
    const int n = static_cast<int>(wall.size());
    // In the upper two thirds: below them hang the laminae.
    const auto first = wall.begin() + n / 3;
    const double nearest = *std::min_element(first, wall.end());
    if (!(nearest < 30 * mm_)) continue;
    int low = static_cast<int>(std::min_element(first, wall.end()) - wall.begin()), high = low;
    while (low > 0 && wall[low - 1] < nearest + 3 * mm_) low--;
    while (high + 1 < n && wall[high + 1] < nearest + 3 * mm_) high++;
    double z = (level[low] + level[high]) / 2;
    Vector3d p;
    double medial = 0;
    for (int pass = 0; pass < 2; pass++) {  // the middle of the section
      medial = ray({x, 0, z}, Vector3d::UnitY());
      const double thick = ray({x, medial + 0.05 * mm_, z}, Vector3d::UnitY());
      p = {x, medial + thick / 2, z};
      z += (ray(p, Vector3d::UnitZ()) - ray(p, -Vector3d::UnitZ())) / 2;
    }
    if (!(medial < 30 * mm_) || bone_.windingNumber(p) <= 0) continue;
    double width = INFINITY, height = INFINITY;
    for (int deg = -60; deg <= 60; deg += 5) {
      const double a = deg * M_PI / 180, b = a * 0.5;
      width = std::min(width, chord(p, {std::sin(a), std::cos(a), 0}));
      height = std::min(height, chord(p, {std::sin(b), 0, std::cos(b)}));
    }
    sections.push_back({width, height, medial, p});
  }
  if (sections.empty()) return std::nullopt;
  Pedicle narrowest =
      *std::min_element(sections.begin(), sections.end(),
                        [](const Pedicle& a, const Pedicle& b) { return a.width < b.width; });
  for (const Pedicle& p : sections) {  // wider ones are of a transverse process or its root
    if (p.width < 1.3 * narrowest.width) narrowest.height = std::min(narrowest.height, p.height);
  }
  return narrowest;
}

double VertebraShape::bodyVolume() const {
  constexpr int kSlices = 40;
  const double back = backWall(0), step = (bone_.box().max().x() - back) / kSlices;
  double sum = 0;
  for (int i = 0; i < kSlices; i++) {
    for (const Outline& o : section(bone_.mesh(), 0, back + (i + 0.5) * step)) {
      sum += signedArea(o) * step;
    }
  }
  return sum;
}

double VertebraShape::transverseSpan() const {
  double span = 0;
  for (const Vector3d& p : bone_.mesh().vertices) span = std::max(span, 2 * std::abs(p.y()));
  return span;
}

Vector3d VertebraShape::spinousTip() const {
  const double behind = backWall(0) - 12 * mm_;
  Vector3d tip = Vector3d::Zero();
  for (const Vector3d& p : bone_.mesh().vertices) {
    if (p.x() < behind && std::abs(p.y()) < 12 * mm_ && p.norm() > tip.norm()) tip = p;
  }
  return tip;
}

double VertebraShape::spinousTipDistance() const {
  // Along the middle of the process' end, not to a corner of it.
  const double furthest = spinousTip().norm();
  Vector3d sum = Vector3d::Zero();
  std::vector<Vector3d> process;
  for (const Vector3d& p : bone_.mesh().vertices) {
    if (p.x() > backWall(0) - 12 * mm_ || std::abs(p.y()) > 12 * mm_) continue;
    process.push_back(p);
    if (p.norm() > furthest - 3 * mm_) sum += p;
  }
  const Vector3d along = Vector3d(sum.x(), 0, sum.z()).normalized();
  double reach = 0;
  for (const Vector3d& p : process) reach = std::max(reach, p.dot(along));
  return reach;
}

}  // namespace torso
