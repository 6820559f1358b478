// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/ligament_site.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

namespace torso {

using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

// Rays and nearest points of a bone, in its own frame, for the left side or the mid-line.
class Surface {
 public:
  Surface(const MeshTree& bone, const Isometry3d& frame) : bone_(bone), frame_(frame) {}

  // Where the ray meets the bone before it has gone `length`.
  std::optional<Vector3d> hit(const Vector3d& from, const Vector3d& along, double length) const {
    const double t = bone_.castRay(frame_ * from, frame_.linear() * along).distance;
    if (!(t < length)) return std::nullopt;
    return from + t * along;
  }
  Vector3d nearest(const Vector3d& p) const {
    return frame_.inverse() * bone_.nearest(frame_ * p).point;
  }
  // Middle of what lies beyond this share of its reach to the left, and the reach.
  Vector3d leftmost(double share) const {
    double reach = 0;
    for (const Vector3d& p : bone_.mesh().vertices) reach = std::max(reach, p.y());
    Eigen::AlignedBox3d box;
    for (const Vector3d& p : bone_.mesh().vertices) {
      if (p.y() > share * reach) box.extend(frame_.inverse() * p);
    }
    const Vector3d middle = box.center();
    return {middle.x(), reach, middle.z()};
  }

 private:
  const MeshTree& bone_;
  const Isometry3d frame_;
};

}  // namespace

Vector3d ligamentSite(const Anatomy& anatomy, const std::string& level, const std::string& ligament,
                      bool upper, const Vector3d& guess, const MeshTree& bone) {
  const double mm = 1e-3 * anatomy.length_scale, sign = upper ? 1 : -1;
  const bool sacrum = level == "S1", left = guess.y() > 0, middle = guess.y() == 0;
  const Isometry3d frame = anatomy.boneFrame(level);
  const Surface surface(bone, frame);
  const auto starts = [&](const char* prefix) { return ligament.rfind(prefix, 0) == 0; };
  // Bones are mirror images: all is found on the left.
  const Vector3d p = frame.inverse() * (left || middle ? guess : mirror(guess));
  const Vector3d z = Vector3d::UnitZ(), off = 0.2 * mm * Vector3d::UnitY();  // off the mid-line

  std::optional<Vector3d> site;
  if (starts("LF_")) {
    // Backwards out of the canal to the lamina: its upper edge, or the lower half of its front.
    const double depth =
        sacrum ? anatomy.discs.front().shape.depth : anatomy.vertebra(level).upper_endplate_depth;
    const double canal = sacrum ? 15 * mm : anatomy.vertebra(level).canal_depth;
    const double height = sacrum ? 30 * mm : anatomy.vertebra(level).body_height_posterior;
    for (double down = 0; down < 0.8 * height && !site; down += 0.5 * mm) {
      site = surface.hit({-depth / 2 - 0.45 * canal, p.y(), p.z() - sign * down},
                         -Vector3d::UnitX(), 0.55 * canal + 7 * mm);
    }
  } else if (starts("ISL")) {
    site = surface.hit(p + off + sign * 25 * mm * z, -sign * z, 45 * mm);
  } else if (starts("SSL")) {
    const Vector3d along = sacrum ? Vector3d(-1, 0, 0) : Vector3d(p.normalized());
    site = surface.hit(p + off + 20 * mm * along, -along, 40 * mm);
  } else if (starts("ITL")) {
    const bool tip = starts("ITL_tip");
    const Vector3d end = sacrum ? p : surface.leftmost(0.93);
    const double y = sacrum ? p.y() : (tip ? 0.93 : 0.62) * end.y();
    const double x = tip || sacrum ? end.x() : p.x();
    for (double aside = 0; aside < 12 * mm && !site; aside += mm) {
      for (double way : {1.0, -1.0}) {
        if (site) break;
        site = surface.hit({x + way * aside, y, end.z() + sign * 20 * mm}, -sign * z, 40 * mm);
      }
    }
  }
  Vector3d q = frame * (site ? *site : surface.nearest(p));
  if (middle) q.y() = 0;
  return left || middle ? q : mirror(q);
}

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
    // On the laminae, down to their roots at the pedicles.
    return x < -depth / 2 + 0.3 * (canal_back + depth / 2) && x > canal_back - 8 * mm && y > 1 * mm;
  }
  if (starts("CL_")) return x < -depth / 2 + 4 * mm && y > 5 * mm;
  if (starts("ISL")) return y < 2 * mm && behind_canal;
  if (starts("SSL")) return y < 2 * mm && x < canal_back - (sacrum ? 0 : 4 * mm);
  if (starts("ITL_tip")) return y > 0.75 * reach;
  if (starts("ITL_base")) return y > 0.45 * reach && y < 0.8 * reach;
  throw std::runtime_error("anatomy: nothing is known about the sites of ligament '" + ligament +
                           "'");
}

}  // namespace torso
