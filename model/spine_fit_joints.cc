// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Facets and ligaments of vertebrae whose surfaces are known.

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/mesh_section.h"
#include "model/spine_fit.h"

namespace torso {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// Ligaments end on the bone if it is no further than this; else where the tables say.
constexpr double kSnap = 0.015;  // [m]

Landmark transformed(const Landmark& l, const Isometry3d& X) {
  return {X * l.centre, X.linear() * l.normal, l.width, l.height};
}

// Nearest place of a surface.
Vector3d nearestPoint(const TriMesh& mesh, const Vector3d& p) {
  Vector3d best = p;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& f : mesh.faces) {
    // Ericson 2005, Real-Time Collision Detection, section 5.1.5: by the region of the triangle.
    const Vector3d &a = mesh.vertices[f[0]], &b = mesh.vertices[f[1]], &c = mesh.vertices[f[2]];
    const Vector3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
    const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp),
                 d5 = ab.dot(cp), d6 = ac.dot(cp);
    const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    Vector3d q;
    if (d1 <= 0 && d2 <= 0) {
      q = a;
    } else if (d3 >= 0 && d4 <= d3) {
      q = b;
    } else if (d6 >= 0 && d5 <= d6) {
      q = c;
    } else if (vc <= 0 && d1 >= 0 && d3 <= 0) {
      q = a + d1 / (d1 - d3) * ab;
    } else if (vb <= 0 && d2 >= 0 && d6 <= 0) {
      q = a + d2 / (d2 - d6) * ac;
    } else if (va <= 0 && d4 >= d3 && d5 >= d6) {
      q = b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
    } else {
      q = a + (vb * ab + vc * ac) / (va + vb + vc);
    }
    if ((q - p).squaredNorm() < least) {
      least = (q - p).squaredNorm();
      best = q;
    }
  }
  return best;
}

const TriMesh* meshOf(const std::map<std::string, TriMesh>& meshes, const std::string& level) {
  const auto it = meshes.find(level);
  return it == meshes.end() ? nullptr : &it->second;
}

bool starts(const std::string& name, const char* prefix) { return name.rfind(prefix, 0) == 0; }

}  // namespace

void fitFacet(const TriMesh& lower, const Landmark& superior, const Landmark& inferior,
              Facet* facet) {
  // Half axes over the face's size to begin with: as those of the generated bones (facet.cc).
  constexpr double kWidthFactor = 1.2, kHeightFactor = 1.5, kThicknessFactor = 0.3;
  constexpr double kGrowth = 1.04, kLargest = 1.8;
  constexpr double kDeepest = 0.5;  // of the face's height: how far behind the face the process is

  const double width = (superior.width + inferior.width) / 2;
  const double height = (superior.height + inferior.height) / 2;
  // Between the two faces, if they look at each other at all.
  Vector3d normal = superior.normal;
  if (superior.normal.dot(inferior.normal) < -0.5) normal -= inferior.normal;
  normal.normalize();
  Vector3d up = Vector3d::UnitZ() - normal.z() * normal;
  if (up.norm() < 0.1) up = -Vector3d::UnitX() + normal.x() * normal;
  up.normalize();
  Matrix3d R;
  R << up.cross(normal), up, normal;

  // The apex lies on the inferior face, over the middle of the superior one.
  const double gap = (inferior.centre - superior.centre).dot(normal);
  const Vector3d apex = superior.centre + gap * normal;

  // The superior articular process: what lies behind its face.
  std::vector<Vector3d> process;
  for (const SurfacePoint& p : surfacePoints(lower, 1.5e-3)) {
    const Vector3d r = R.transpose() * (p.position - superior.centre);
    const bool on_face = std::hypot(r.x() / (0.55 * width), r.y() / (0.55 * height)) < 1;
    if (on_face && r.z() > -kDeepest * height && r.z() < 2e-3) process.push_back(p.position);
  }
  double growth = 1;
  for (;; growth *= kGrowth) {
    facet->radii =
        growth * Vector3d(kWidthFactor * width, kHeightFactor * height, kThicknessFactor * height);
    facet->ellipsoid = Isometry3d::Identity();
    facet->ellipsoid.linear() = R;
    facet->ellipsoid.translation() = apex - facet->radii.z() * normal;
    const bool encloses = std::all_of(process.begin(), process.end(), [&](const Vector3d& p) {
      const Vector3d r = facet->ellipsoid.inverse() * p;
      // Bone that reaches beyond the other face cannot be enclosed: the meshes overlap there.
      return r.z() > facet->radii.z() * 0.8 || r.cwiseQuotient(facet->radii).norm() <= 1;
    });
    if (encloses || growth > kLargest) break;
  }
  // Four points of the inferior face, seen along the normal.
  const Vector3d middle = facet->ellipsoid.inverse() * inferior.centre;
  const auto bound = [](double x, double limit) { return std::clamp(x, -limit, limit); };
  const double cx = bound(middle.x(), 0.3 * facet->radii.x());
  const double cy = bound(middle.y(), 0.3 * facet->radii.y());
  for (int i = 0; i < 4; i++) {
    const double x = cx + (i % 2 ? 0.25 : -0.25) * inferior.width;
    const double y = cy + (i / 2 ? 0.25 : -0.25) * inferior.height;
    const double rest = 1 - x * x / (facet->radii.x() * facet->radii.x()) -
                        y * y / (facet->radii.y() * facet->radii.y());
    facet->points[i] =
        facet->ellipsoid * Vector3d(x, y, facet->radii.z() * std::sqrt(std::max(0.05, rest)));
  }
}

std::vector<Facet> fittedFacets(const SpineFit& fit, const SpineLandmarks& found,
                                const std::map<std::string, TriMesh>& meshes) {
  std::vector<Facet> facets = makeFacets(fit.anatomy);
  for (Facet& facet : facets) {
    if (facet.kind != Facet::Kind::kZygapophyseal) continue;
    const auto lower = found.find(facet.ellipsoid_body), upper = found.find(facet.points_body);
    const TriMesh* mesh = meshOf(meshes, facet.ellipsoid_body);
    if (lower == found.end() || upper == found.end() || !mesh) continue;
    const int side = facet.name.rfind("_right") != std::string::npos ? 1 : 0;
    fitFacet(*mesh, transformed(lower->second.superior_face[side], fit.placement.at(lower->first)),
             transformed(upper->second.inferior_face[side], fit.placement.at(upper->first)),
             &facet);
  }
  return facets;
}

std::vector<LigamentSegment> fittedLigaments(const SpineFit& fit, const SpineLandmarks& found,
                                             const std::map<std::string, TriMesh>& meshes) {
  std::vector<LigamentSegment> segments = makeLigaments(fit.anatomy);
  for (LigamentSegment& s : segments) {
    const double ratio = s.max_length / (s.upper_point - s.lower_point).norm();
    for (const auto& [level, point] :
         {std::pair{s.lower, &s.lower_point}, {s.upper, &s.upper_point}}) {
      const TriMesh* mesh = meshOf(meshes, level);
      const auto it = found.find(level);
      if (!mesh || it == found.end()) continue;
      const Isometry3d& X = fit.placement.at(level);
      Vector3d wanted = *point;
      if (starts(s.name, "SSL")) wanted = X * it->second.spinous_tip;
      if (starts(s.name, "ITL")) {
        const Vector3d tip = X * it->second.transverse_tip[point->y() > 0 ? 0 : 1];
        wanted = tip;
        if (starts(s.name, "ITL_base")) {
          const Vector3d centre = fit.anatomy.vertebra(level).position;
          wanted.y() = centre.y() + 0.62 * (tip.y() - centre.y());
        }
      }
      const Vector3d nearest = nearestPoint(*mesh, wanted);
      if ((nearest - wanted).norm() < kSnap) *point = nearest;
    }
    s.max_length = ratio * (s.upper_point - s.lower_point).norm();
  }
  return segments;
}

}  // namespace torso
