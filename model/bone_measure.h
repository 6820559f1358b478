// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Bones measured on their surfaces, as an anatomist measures them with a caliper, and published
// measures to compare with. Nothing here reads the tables that the bones were made from, but for
// the frame of a bone, where a search begins, and the size of the body.

#include <cmath>
#include <string>
#include <vector>

#include "model/anatomy.h"
#include "model/skeleton.h"

namespace torso {

struct BoneMeasure {
  std::string bone;      // "L5" .. "C3", "S1", "sacrum", "pelvis", "rib_cage", "clavicle", ...
  std::string quantity;  // "upper_endplate_width", ... as in bone_measures.csv
  double value;          // [m], [m^2], [m^3], [rad]
};

// All measures of the bones that the skeleton has; of pairs the left one. A quantity that cannot be
// found on a surface (no pedicle where pedicles are, ...) is left out. Vertebrae:
//   upper_, lower_endplate_width, _depth: of the body's outline 1.5 mm below the endplate's plane;
//     depth on the mid-line.
//   body_height_anterior, _posterior: between the endplates, along the body's axis, 1 - 3 mm inside
//     the edge of the body on the mid-line.
//   canal_width: between the pedicles where they are narrowest; canal_depth: from the body to the
//     arch on the mid-line, where it is least.
//   pedicle_width, _height: the least chord across, in the horizontal and the upright plane.
//   transverse_process_span: tip to tip. spinous_tip_distance: body centre to tip.
//   superior_facet_width, _height, _area: of the part of the face that is within 0.6 mm of one
//     plane; _transverse_angle: 0 horizontal, 90 deg vertical; _frontal_angle: 0 frontal, 90 deg
//     sagittal, positive facing backwards and to the mid-line.
//   volume; body_volume: of what lies in front of the back wall of the body.
// clavicle medial_breadth: of the medial fifth, horizontally across the bone.
std::vector<BoneMeasure> measureBones(const Anatomy& anatomy, const Skeleton& skeleton);

// The body that a bone is part of: "sacrum" -> "pelvis", "clavicle" -> "left_clavicle".
std::string bodyOfBone(const std::string& bone);

// A row of bone_measures.csv, for a man of 170 cm.
struct PublishedMeasure {
  std::string bone, quantity, unit;  // unit: "mm", "mm2", "cm3", "deg"
  double mean, sd;                   // SI; sd < 0: not known
  std::string source, provenance, note;
};
// SI of one unit of the table. Throws std::invalid_argument for another word.
double measureUnit(const std::string& unit);
// The table in the folder of the anatomy. Throws std::runtime_error that names file, line, column.
std::vector<PublishedMeasure> loadPublishedMeasures(const std::string& folder);

// The row for a body of another size: lengths times the scale, areas and volumes accordingly.
PublishedMeasure scaled(const PublishedMeasure& row, double length_scale);
// How far a measure may be from the mean: one SD, or 5 % of the mean where none is known.
double tolerance(const PublishedMeasure& row);
inline bool inside(const PublishedMeasure& row, double value) {
  return std::abs(value - row.mean) <= tolerance(row);
}

}  // namespace torso
