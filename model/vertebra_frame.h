// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Which way a vertebra looks, from its shape alone.

#include <Eigen/Geometry>
#include <optional>

#include "model/mesh_section.h"
#include "model/tri_mesh.h"

namespace torso {

struct VertebraPose {
  Eigen::Isometry3d frame;  // from the vertebra's axes (x forward, y left, z up; origin at the
                            // centre of the body) to the mesh's
  double up_certainty;      // 0 doubtful to 1 sure: which end is up
};

// mesh: closed, faces outwards, whole vertebra, in any unit, place and turn. The mid-plane is the
// plane that mirrors the surface best onto itself; its cut shows the body before and the arch
// behind the canal; pedicles leave the upper half of the body, and processes point downwards.
// up: a direction known to be about upwards, if it is. Throws std::runtime_error if the cut does
// not show a body and an arch.
VertebraPose vertebraPose(const TriMesh& mesh,
                          const std::optional<Eigen::Vector3d>& up = std::nullopt);

// The cut in the mid-plane, of a mesh in the vertebra's axes: outlines in (z, x) of the body and of
// the arch. Throws std::runtime_error if there are not two.
struct MidSection {
  Outline body, arch;
};
MidSection midSection(const TriMesh& mesh);

// Between the surfaces that are met from a point to the left and to the right (along y) [m];
// infinity if there are not both.
double breadth(const TriMesh& bone, const Eigen::Vector3d& point);

// Straight edge of an endplate in the mid-plane: z = at + slope * x, from x = back to x = front.
struct EndplateLine {
  double at, slope, back, front;
};

// The line that rests on the body's outline, (z, x), from above (upper) or below, touching it as
// far forward and as far back as can be: on the rims if the endplate is hollow.
EndplateLine endplateLine(const Outline& body, bool upper);

}  // namespace torso
