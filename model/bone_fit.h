// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Do the parts of the body fit each other: are the bones sound solids that keep apart, are canal
// and foramina open, do discs, ligaments and facets lie on the bones.

#include <string>
#include <vector>

#include "model/anatomy.h"
#include "model/skeleton.h"

namespace torso {

// One thing looked at in one place: it fits if low <= value <= high.
struct FitCheck {
  std::string check;  // "closed", "apart", "disc_gap", ...
  std::string where;  // "L4", "L4/L5_left", "ribcage - T7"
  double value;       // a count, or [m]
  double low, high;
  bool length;  // value is a length, else a count

  bool passed() const { return value >= low && value <= high; }
};

// The checks whose bodies the skeleton has all of:
//   closed: faults of the surface (findFaults), 0.
//   self_intersection: pairs of faces that cross, of one tissue of a body, 0.
//   mirror: how far the right side is from the mirrored left one, below 0.05 mm.
//   apart: how deep two bodies reach into each other, 0.
//   canal: room about the line through the middles of the vertebral canals, 5 mm at least.
//   foramen: radius of the largest ball in the intervertebral foramen, 2 mm at least, with a free
//     way in and out.
//   disc_space: what lies free at half height of a disc, over half its height, at least 0.8,
//     but for its outer part.
//   disc_gap, disc_overlap: of the disc's faces, corners and middles of the faces of its mesh, from
//     the endplates, below 0.5 mm.
//   ligament: distance of an attachment from the surface of the bone, where the ligament's name
//     says, below 1.5 mm; infinite in another place.
//   facet_points: distance of the points from the inferior articular face, below 1 mm.
//   facet_ellipsoid: how far the superior articular face stands out of the ellipsoid, below 0.5 mm.
//   scapula_points: distance of the points from the costal surface of the scapula, below 1.5 mm.
//   scapula_ellipsoid: room between the ribs and the ellipsoid behind them, for serratus anterior
//     and subscapularis: 0 to 20 mm where it is least, up to 35 mm where the ribs fall away.
// Lengths of the bounds are for a body of the tables' size. Uses up to `threads` threads.
std::vector<FitCheck> checkFit(const Anatomy& anatomy, const Skeleton& skeleton, int threads);

}  // namespace torso
