// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/blend.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace torso {

using Eigen::Vector3d;

double smoothMin(double a, double b, double k) {
  const double h = k > 0 ? std::max(k - std::abs(a - b), 0.0) / k : 0;
  return std::min(a, b) - h * h * k / 4;
}

double smoothMax(double a, double b, double k) { return -smoothMin(-a, -b, k); }

Blend& Blend::unite(const Solid& solid, double fillet) {
  steps_.push_back({solid, fillet, Action::kUnite});
  largest_fillet_ = std::max(largest_fillet_, fillet);
  box_.extend(solid.box);
  return *this;
}

Blend& Blend::carve(const Solid& solid, double fillet) {
  steps_.push_back({solid, fillet, Action::kCarve});
  largest_fillet_ = std::max(largest_fillet_, fillet);
  return *this;
}

Blend& Blend::clip(const Solid& solid, double fillet) {
  steps_.push_back({solid, fillet, Action::kClip});
  largest_fillet_ = std::max(largest_fillet_, fillet);
  return *this;
}

Blend& Blend::unitePair(const Solid& left, double fillet) {
  return unite(left, fillet).unite(mirrored(left), fillet);
}

Blend& Blend::carvePair(const Solid& left, double fillet) {
  return carve(left, fillet).carve(mirrored(left), fillet);
}

double Blend::distance(const Vector3d& p, double far) const {
  double d = std::numeric_limits<double>::infinity();
  for (const Step& s : steps_) {
    // Half the fillet's size is the most that a shape at that distance can do. Away from their
    // surface shapes' distances may be too small, by this factor.
    constexpr double kShort = 0.6;
    const double off = kShort * s.solid.box.exteriorDistance(p);
    if (s.action == Action::kCarve) {
      if (off < s.fillet - d) d = smoothMax(d, -s.solid.distance(p), s.fillet);
    } else if (s.action == Action::kClip) {
      d = smoothMax(d, s.solid.distance(p), s.fillet);
    } else if (off > far + largest_fillet_) {
      d = std::min(d, off);
    } else if (off < d + s.fillet) {
      d = smoothMin(d, s.solid.distance(p), s.fillet);
    }
  }
  return d;
}

Solid Blend::solid() const {
  Eigen::AlignedBox3d box;
  for (const Step& s : steps_) {
    if (s.action != Action::kUnite) continue;
    const Vector3d bulge = Vector3d::Constant(s.fillet / 4);  // the most that its fillet adds
    box.extend(s.solid.box.min() - bulge);
    box.extend(s.solid.box.max() + bulge);
  }
  return {box, [blend = *this](const Vector3d& p) {
            return blend.distance(p, std::numeric_limits<double>::infinity());
          }};
}

}  // namespace torso
