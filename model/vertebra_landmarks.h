// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Where the parts of a vertebra are on its surface.

#include <Eigen/Geometry>
#include <array>
#include <map>
#include <optional>
#include <string>

#include "model/anatomy.h"
#include "model/tri_mesh.h"

namespace torso {

// A face of the bone: of an endplate, `width` is from side to side and `height` from front to back;
// of an articular process, `height` is along it and `width` across. Of a tip, only the centre
// counts.
struct Landmark {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // unit, out of the bone
  double width = 0, height = 0;
};

// Lengths in the mesh's unit, everything in the mesh's axes.
struct VertebraLandmarks {
  Eigen::Isometry3d frame;  // the vertebra frame of anatomy.h: origin at the body's centre
  Landmark upper_endplate, lower_endplate;
  Eigen::Vector3d spinous_tip;
  std::array<Eigen::Vector3d, 2> transverse_tip;         // left, right
  std::array<Landmark, 2> superior_face, inferior_face;  // left, right
  double body_height_anterior, body_height_posterior;
  double canal_width, canal_depth;
  double up_certainty;  // see VertebraPose; 1 if endplates were given
};

// What is known before the search: a vertebra of the tables at about the mesh's size. Its faces are
// in its vertebra frame, on the left; they start the search on the mesh.
struct VertebraPrior {
  Vertebra vertebra;
  Landmark superior_face, inferior_face;
};
// Of "L5" .. "C3"; the inferior face is the mirror of the superior one of the bone below.
VertebraPrior vertebraPrior(const Anatomy& anatomy, const std::string& level);

// Landmarks that a person gave, by the names of kLandmarkNames; in the mesh's unit and axes. What
// is zero in them (normal, width, height) is taken from the search.
using GivenLandmarks = std::map<std::string, Landmark>;
const std::vector<std::string>& landmarkNames();

// mesh [m]: closed, faces outwards, in any place and turn. Without `given` endplates (both) and
// spinous tip the frame is found by vertebraPose, with its hint `up`. Throws std::runtime_error
// "... ; give the landmark(s) ..." if a part cannot be found.
VertebraLandmarks findLandmarks(const TriMesh& mesh, const VertebraPrior& prior,
                                const GivenLandmarks& given = {},
                                const std::optional<Eigen::Vector3d>& up = std::nullopt);

}  // namespace torso
