// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/bone_parts.h"
#include "model/fuse.h"

namespace torso {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

TriMesh sacrum(const Anatomy& anatomy) {
  TriMesh mesh;
  // S1's body. The disc has the mean size of its two endplates.
  const Disc& disc = anatomy.discs.front();
  const Vertebra& l5 = anatomy.vertebrae.front();
  const double width = 2 * disc.shape.width - l5.lower_endplate_width;
  const double depth = 2 * disc.shape.depth - l5.lower_endplate_depth;
  const Isometry3d s1 = anatomy.boneFrame("S1");
  std::vector<Ring> body;
  const double stations[][3] = {// depth below the endplate [mm], girth, shift to the rear [mm]
                                {0, 0.45, 0},   {0, 0.96, 0},  {0.4, 0.988, 0}, {1.2, 1, 0},
                                {2.5, 0.99, 0}, {9, 0.9, 0.5}, {18, 0.82, 2},   {30, 0.72, 6}};
  for (const auto& s : stations) {
    Ring ring;
    for (const Vector2d& p : endplateOutline(width, depth, 48)) {
      ring.push_back(s1 * Vector3d(p.x() * s[1] - s[2] * 1e-3, p.y() * s[1], -s[0] * 1e-3));
    }
    body.push_back(ring);
  }
  append(mesh, loft(body));

  // Fused vertebrae: a bent wedge, hollow in front.
  TubeStyle style;
  style.up = Vector3d(1, 0, -0.6);  // out of the pelvic surface
  style.squareness = 2.5;
  style.cap = 0.4;
  append(mesh, tube({sectionMm(-15, 0, -4, 44, 13), sectionMm(-24, 0, -18, 50, 15),
                     sectionMm(-37, 0, -35, 46, 13.5), sectionMm(-49, 0, -53, 36, 11),
                     sectionMm(-57, 0, -72, 27, 8.5), sectionMm(-59, 0, -88, 20, 6.5),
                     sectionMm(-57, 0, -101, 11, 4.5)},
                    style));
  // Alae.
  style.up = Vector3d::UnitZ();
  style.squareness = 2.3;
  appendPair(mesh, tube({sectionMm(-10, 8, -17, 14, 10), sectionMm(-12, 30, -14, 15, 10),
                         sectionMm(-15, 42, -16, 14, 12), sectionMm(-21, 48, -24, 9, 10)},
                        style));
  // Median crest, four bumps of spinous processes; beside it the foramina's ridge.
  style.up = Vector3d(-1, 0, 0.6);
  append(mesh, tube({sectionMm(-37, 0, 4, 5, 7), sectionMm(-45, 0, -8, 3.5, 9),
                     sectionMm(-53, 0, -20, 4, 8), sectionMm(-60, 0, -33, 3.2, 8.5),
                     sectionMm(-65, 0, -46, 4, 7), sectionMm(-68, 0, -62, 3, 6.5),
                     sectionMm(-67, 0, -78, 2.5, 4)},
                    style));
  appendPair(mesh, tube({sectionMm(-36, 19, 0, 5, 5), sectionMm(-50, 17, -22, 4, 5),
                         sectionMm(-61, 14, -46, 3.5, 4.5), sectionMm(-67, 11, -72, 3, 3.5),
                         sectionMm(-65, 8, -94, 2.5, 3)},
                        style));
  // Superior articular processes, and the roof of the canal between them.
  for (const ArticularFacet& f : anatomy.facets) {
    if (f.level != "S1") continue;
    const Isometry3d face = facetFrame(anatomy, f);
    appendPair(mesh, facetPad(face, f.width, f.height, 6_mm));
    style.up = Vector3d::UnitX();
    appendPair(mesh,
               tube({{face * Vector3d(0, -3_mm, -5_mm), 7_mm, 5_mm}, sectionMm(-24, 25, -4, 8, 7)},
                    style));
  }
  style.up = Vector3d(-0.6, 0, 1);
  append(mesh, tube({sectionMm(-30, -22, 2, 3.5, 8), sectionMm(-37, 0, 3, 3.5, 8),
                     sectionMm(-30, 22, 2, 3.5, 8)},
                    style));
  // Coccyx.
  style.up = Vector3d(1, 0, -0.3);
  append(mesh, tube({sectionMm(-56, 0, -105, 11, 4), sectionMm(-53, 0, -112, 8, 4)}, style));
  append(mesh, tube({sectionMm(-50, 0, -116, 6.5, 3.5), sectionMm(-46, 0, -122, 5, 3)}, style));
  append(mesh, tube({sectionMm(-43, 0, -125.5, 4, 2.8), sectionMm(-37, 0, -129, 2.5, 2.2)}, style));
  return mesh;
}

}  // namespace

TriMesh sacrumMesh(const Anatomy& anatomy) {
  return fuse(sacrum(anatomy), {1.4_mm, 4_mm, 1400, 1, true});
}

}  // namespace torso
