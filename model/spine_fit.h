// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The tables of a person whose vertebrae are known from landmarks.

#include <map>
#include <string>
#include <vector>

#include "model/facet.h"
#include "model/ligament.h"
#include "model/vertebra_landmarks.h"

namespace torso {

// Landmarks by level, "L5" .. "C3", each in the axes of its own mesh [m].
using SpineLandmarks = std::map<std::string, VertebraLandmarks>;

// Size of the person over that of the tables: the median of the vertebrae's.
double spineScale(const Anatomy& anatomy, const SpineLandmarks& found);

struct SpineFit {
  Anatomy anatomy;
  std::map<std::string, Eigen::Isometry3d> placement;  // by level: from the mesh to standing body
  bool common_frame;                                   // the meshes' places to each other were used
  std::vector<std::string> remarks;                    // one line each, for the person to read
};

// Puts the vertebrae found into the tables `anatomy`, which are at the person's size. Levels not
// found are scaled in proportion to their neighbours. Where the meshes lie to each other as a spine
// does, those places are used, seen from the side (the model is symmetric: a bend to the side is
// straightened); otherwise each keeps the pitch of the standing spine, with discs of the tables'
// height. Everything above the sacrum moves along. Throws std::runtime_error if a level is unknown.
SpineFit fitSpine(const Anatomy& anatomy, const SpineLandmarks& found);

// Facet between a superior face (of the bone below) and the inferior face (of the bone above) that
// lies against it, both in the standing body: a flat ellipsoid that encloses the superior articular
// process (`lower` is that bone's surface) and passes through the inferior face, with four points
// on it. Replaces ellipsoid, radii and points of `facet`.
void fitFacet(const TriMesh& lower, const Landmark& superior, const Landmark& inferior,
              Facet* facet);

// makeFacets and makeLigaments of the fitted anatomy, those between bones of `meshes` (by level, in
// the standing body) fitted to the surfaces: facets as above, ligaments moved to the nearest place
// of the bone, those of spinous and transverse processes to the tips.
std::vector<Facet> fittedFacets(const SpineFit& fit, const SpineLandmarks& found,
                                const std::map<std::string, TriMesh>& meshes);
std::vector<LigamentSegment> fittedLigaments(const SpineFit& fit, const SpineLandmarks& found,
                                             const std::map<std::string, TriMesh>& meshes);

}  // namespace torso
