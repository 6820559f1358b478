// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The bones of one region each, for bone_mesh.cc. In the standing body [m]; of a pair the left one.

#include <vector>

#include "model/anatomy.h"
#include "model/blend.h"
#include "model/bone_mesh.h"
#include "model/loft.h"

namespace torso {

constexpr double operator""_mm(long double x) { return static_cast<double>(x) * 1e-3; }
constexpr double operator""_mm(unsigned long long x) { return static_cast<double>(x) * 1e-3; }

// Point and section from millimetres, for the tables in the code.
inline Eigen::Vector3d pointMm(double x, double y, double z) {
  return Eigen::Vector3d(x, y, z) * 1e-3;
}
inline Section sectionMm(double x, double y, double z, double side, double up) {
  return {pointMm(x, y, z), side * 1e-3, up * 1e-3, Eigen::Vector3d::Zero()};
}

// Rod with round ends. In any unit of length.
inline Solid bar(const std::vector<Section>& sections,
                 const Eigen::Vector3d& up = Eigen::Vector3d::UnitZ(), double squareness = 2) {
  TubeStyle style;
  style.up = up;
  style.squareness = squareness;
  style.cap = 1;
  return rod(sections, style);
}

TriMesh vertebraMesh(const Anatomy& anatomy, const std::string& level);  // L5 .. C3

TriMesh atlasMesh(const Anatomy& anatomy);   // C1
TriMesh axisMesh(const Anatomy& anatomy);    // C2
TriMesh sacrumMesh(const Anatomy& anatomy);  // with the coccyx

// Face of a left superior facet in the standing body: its frame has z out of the face, y up along
// it (its height) and x across (its width).
Eigen::Isometry3d facetFrame(const Anatomy& anatomy, const ArticularFacet& facet);

std::vector<BonePart> pelvisMesh(const Anatomy& anatomy);
std::vector<BonePart> ribCageMesh(const Anatomy& anatomy);
TriMesh headMesh(const Anatomy& anatomy);

TriMesh clavicleMesh(const Anatomy& anatomy);
TriMesh scapulaMesh(const Anatomy& anatomy);
TriMesh humerusMesh(const Anatomy& anatomy);
TriMesh forearmMesh(const Anatomy& anatomy);
TriMesh handMesh(const Anatomy& anatomy);
TriMesh femurMesh(const Anatomy& anatomy);
TriMesh shinMesh(const Anatomy& anatomy);
TriMesh footMesh(const Anatomy& anatomy);

// A part and its mirror image.
void appendPair(TriMesh& mesh, const TriMesh& left);

}  // namespace torso
