// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/sheet.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/loft.h"

namespace torso {

using Eigen::Vector2d;
using Eigen::Vector3d;

Solid sheetSolid(const Sheet& sheet) {
  Solid solid;
  for (const Vector2d& p : sheet.outline) {
    for (double side : {1.0, -1.0}) {
      const double reach = side * (sheet.max_height + sheet.max_half_thickness);
      solid.box.extend(sheet.frame * Vector3d(p.x(), p.y(), reach));
    }
  }
  const Eigen::Isometry3d into = sheet.frame.inverse();
  solid.distance = [=](const Vector3d& p) {
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
  return solid;
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

}  // namespace torso
