// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/disc_gap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "model/body.h"

namespace torso::tools {

using Eigen::Isometry3d;
using Eigen::Vector3d;

DiscGap::DiscGap(const Anatomy& anatomy, const Skeleton& skeleton, const Disc& disc)
    : lower_(transformed(skeleton.bone(bodyOfLevel(anatomy, disc.lower)).mesh(),
                         disc.frame.inverse())) {
  // Inside of the rim, where cervical bodies have uncinate processes.
  constexpr double kFace = 0.8;
  constexpr int kRings = 4, kRays = 12;
  const DiscShape& shape = disc.shape;
  for (int ring = 0; ring <= kRings; ring++) {
    for (int ray = 0; ray < (ring ? kRays : 1); ray++) {
      const double r = kFace * ring / kRings, angle = 2 * EIGEN_PI * ray / kRays;
      const double front = 0.5 * r * std::cos(angle);  // share of the depth
      const double height = 0.5 * (shape.height_anterior + shape.height_posterior) +
                            front * (shape.height_anterior - shape.height_posterior);
      face_.push_back({front * shape.depth, 0.5 * r * std::sin(angle) * shape.width, height / 2});
    }
  }
}

double DiscGap::at(const Isometry3d& upper) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Vector3d& p : face_) least = std::min(least, lower_.signedDistance(upper * p));
  return least;
}

std::vector<DiscGap> discGaps(const Anatomy& anatomy, const Skeleton& skeleton) {
  std::vector<DiscGap> gaps;
  for (const Disc& disc : anatomy.discs) gaps.emplace_back(anatomy, skeleton, disc);
  return gaps;
}

GapStatistics gapStatistics(const std::string& disc, double rest,
                            const std::vector<double>& distances) {
  const double n = static_cast<double>(distances.size());
  const double mean = std::accumulate(distances.begin(), distances.end(), 0.0) / n;
  double squares = 0;
  for (double x : distances) squares += (x - mean) * (x - mean);
  const auto hits =
      std::count_if(distances.begin(), distances.end(), [](double x) { return x < 0; });
  return {disc, rest, mean, std::sqrt(squares / n), static_cast<double>(hits) / n};
}

}  // namespace torso::tools
