// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Surfaces of the bones, made from the tables. A bone is a union of closed shells.
// What the tables do not give (outlines of flat bones, girths of shafts, ...) is assumed after
// general anatomy and scaled to the tables' landmarks.

#include <string>
#include <vector>

#include "model/anatomy.h"
#include "model/tri_mesh.h"

namespace torso {

enum class Tissue { kBone, kCartilage };

struct BonePart {
  Tissue tissue;
  TriMesh mesh;
};

// Surfaces of one body in the axes and origin of the standing body (see anatomy.h) [m]. Names:
// "pelvis" (sacrum, coccyx and both hip bones), "L5" .. "C3", "ribcage" (12 pairs of ribs, costal
// cartilage, sternum), "head" (C1, C2, skull, mandible), and, with "left_" or "right_" in front,
// "clavicle", "scapula", "upper_arm" (humerus), "lower_arm" (radius, ulna), "hand", "thigh"
// (femur), "shin" (tibia, fibula, patella), "foot". At most one part per tissue. Throws
// std::invalid_argument for another name. Takes up to two seconds.
std::vector<BonePart> boneMesh(const Anatomy& anatomy, const std::string& body);

// Of a body that is no free vertebra: what boneMesh makes for a person (personalAnatomy), from what
// it has made for the tables' body, `parts`. Fast.
std::vector<BonePart> carriedMesh(const Anatomy& person, const std::string& body,
                                  std::vector<BonePart> parts);

// Tissues of boneMesh's parts, in their order, without making them. Throws as boneMesh does.
std::vector<Tissue> boneTissues(const Anatomy& anatomy, const std::string& body);

}  // namespace torso
