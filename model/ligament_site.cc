// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/ligament_site.h"

#include <cmath>
#include <stdexcept>

namespace torso {

using Eigen::Vector3d;

bool onSite(const Anatomy& anatomy, const std::string& level, const std::string& ligament,
            bool upper, const Vector3d& point) {
  const double mm = 1e-3 * anatomy.length_scale;
  const bool sacrum = level == "S1";
  const Vector3d p = anatomy.boneFrame(level).inverse() * point;
  const double x = p.x(), y = std::abs(p.y());
  // Of the endplate on that side.
  double width, depth, rim, height, canal_back, reach;
  if (sacrum) {
    width = anatomy.discs.front().shape.width;
    depth = anatomy.discs.front().shape.depth;
    rim = 0;
    height = 25 * mm;
    canal_back = -depth / 2 - 15 * mm;
    reach = 56 * mm;
  } else {
    const Vertebra& v = anatomy.vertebra(level);
    width = upper ? v.upper_endplate_width : v.lower_endplate_width;
    depth = upper ? v.upper_endplate_depth : v.lower_endplate_depth;
    height = (v.body_height_anterior + v.body_height_posterior) / 2;
    const double tilt = (upper ? v.upper_endplate_pitch : v.lower_endplate_pitch) - v.pitch;
    rim = (upper ? 0.5 : -0.5) * height - x * std::tan(tilt);
    canal_back = -depth / 2 - v.canal_depth;
    reach = v.transverse_process_span / 2;
  }
  const auto starts = [&](const char* prefix) { return ligament.rfind(prefix, 0) == 0; };
  const bool by_rim = std::abs(p.z() - rim) < 4 * mm, behind_canal = x < canal_back + 2 * mm;
  if (starts("ALL_mid")) return by_rim && x > 0.35 * depth && y < 0.1 * width;
  if (starts("ALL_lat")) return by_rim && x > 0.15 * depth && y > 0.2 * width;
  if (starts("PLL_mid")) return by_rim && x < -0.35 * depth && y < 0.1 * width;
  if (starts("PLL_lat")) {
    return by_rim && x < -0.25 * depth && x > canal_back && y > 0.1 * width && y < 0.4 * width;
  }
  if (starts("LF_")) {
    // On the laminae: behind the middle of the canal.
    return x < (canal_back - depth / 2) / 2 && x > canal_back - 8 * mm && y > 1 * mm;
  }
  if (starts("CL_")) return x < -depth / 2 && y > 5 * mm;
  if (starts("ISL")) return y < 2 * mm && behind_canal;
  if (starts("SSL")) return y < 2 * mm && x < canal_back - 8 * mm;
  if (starts("ITL_tip")) return y > 0.75 * reach;
  if (starts("ITL_base")) return y > 0.45 * reach && y < 0.8 * reach;
  throw std::runtime_error("anatomy: nothing is known about the sites of ligament '" + ligament +
                           "'");
}

}  // namespace torso
