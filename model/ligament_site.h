// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The parts of a bone that ligaments are named after, as regions of space about the bone.

#include <Eigen/Core>
#include <string>

#include "model/anatomy.h"
#include "model/mesh_checks.h"

namespace torso {

// Whether a point of the standing body [m] is where a ligament ("ALL_lat_left", ...) attaches on
// the side towards the head (upper) or the feet of a level's bone: at the body's edge in front or
// behind, by the canal's back, at an articular process, on the spinous or the transverse process.
// Levels: "S1", "L5" .. "C3". Throws std::runtime_error for an unknown ligament.
bool onSite(const Anatomy& anatomy, const std::string& level, const std::string& ligament,
            bool upper, const Eigen::Vector3d& point);

// The place on a bone's surface (standing body [m]) where a ligament attaches; `guess` is about
// there, on the ligament's side or on the mid-line, and so is the result. The arguments as above.
Eigen::Vector3d ligamentSite(const Anatomy& anatomy, const std::string& level,
                             const std::string& ligament, bool upper, const Eigen::Vector3d& guess,
                             const MeshTree& bone);

}  // namespace torso
