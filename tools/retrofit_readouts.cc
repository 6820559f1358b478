// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/retrofit_readouts.h"

#include <fmt/format.h>

#include <algorithm>

#include "plugin/mujoco_torso.h"
#include "tools/posture.h"

namespace torso::tools {

Motion motionOf(const RetrofitModels& models, const RetrofitResult& result) {
  return {result.rate, qposColumns(models.human.get()), result.qpos};
}

std::string readoutsCsv(const RetrofitModels& models, const RetrofitResult& result) {
  const mjModel* m = models.torso.get();
  const Posture posture(m);
  std::string text = "time_s,held_error_mm,held_error_deg,unrest_deg";
  for (int i = 0; i < static_cast<int>(posture.names().size()); i++) {
    const std::string& name = posture.names()[i];
    text += fmt::format(",{0}_lateral_bending_deg,{0}_flexion_deg,{0}_axial_rotation_deg", name);
    if (i < posture.levels()) text += fmt::format(",{0}_pressure_mpa,{0}_ligament_n", name);
  }
  const int facets = result.frames.empty() ? 0 : static_cast<int>(result.frames[0].facets.size());
  for (int i = 0; i < facets; i++) text += fmt::format(",{}_facet_n", torso_facetName(m, i));
  text += ",flags\n";
  constexpr double kDegrees = 180 / EIGEN_PI;
  for (std::size_t frame = 0; frame < result.frames.size(); frame++) {
    const RetrofitFrame& read = result.frames[frame];
    text +=
        fmt::format("{:.6f},{:.4f},{:.4f},{:.5f}", frame / result.rate, 1e3 * read.position_error,
                    kDegrees * read.rotation_error, kDegrees * read.unrest);
    for (std::size_t i = 0; i < read.turns.size(); i++) {
      const Eigen::Vector3d turn = kDegrees * read.turns[i];
      text += fmt::format(",{:.4f},{:.4f},{:.4f}", turn.x(), turn.y(), turn.z());
      if (static_cast<int>(i) >= posture.levels()) continue;
      text += fmt::format(",{:.5f},{:.3f}", 1e-6 * read.pressures[i], read.ligaments[i]);
    }
    for (double force : read.facets) text += fmt::format(",{:.3f}", force);
    std::vector<std::string> flags = read.flags;
    for (std::string& flag : flags) std::replace(flag.begin(), flag.end(), ',', ' ');
    text += fmt::format(",{}\n", fmt::join(flags, "; "));
  }
  return text;
}

}  // namespace torso::tools
