// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/facet.h"

#include <cmath>

namespace torso {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kFacetGap = 2e-3;  // bone to bone: two cartilages; as the bones are made
constexpr double kBand = 0.2;       // Lee et al. 2023, equation 6

// Half axes of a facet's ellipsoid over the face's width and height. The face is the middle of a
// shell that is large enough for the opposite face to glide over in full flexion (about half its
// height), and as thick as the process that carries it. Assumed.
constexpr double kWidthFactor = 1.2, kHeightFactor = 1.5, kThicknessFactor = 0.3;

// Frame with z along `normal`, x as level as can be.
Matrix3d faceAxes(const Vector3d& normal) {
  Vector3d height = Vector3d::UnitZ() - Vector3d::UnitZ().dot(normal) * normal;
  if (height.norm() < 0.1) height = -Vector3d::UnitX() + Vector3d::UnitX().dot(normal) * normal;
  height.normalize();
  Matrix3d R;
  R << height.cross(normal), height, normal;
  return R;
}

Isometry3d mirrored(const Isometry3d& X) {
  // Mirror the axes too, then turn x round to stay right-handed: the ellipsoid is the same.
  Isometry3d out = Isometry3d::Identity();
  out.translation() = mirror(X.translation());
  for (int i = 0; i < 3; i++) out.linear().col(i) = mirror(X.linear().col(i));
  out.linear().col(0) *= -1;
  return out;
}

Facet mirrored(const Facet& left, const std::string& points_body,
               const std::string& ellipsoid_body) {
  Facet right = left;
  right.name.replace(right.name.rfind("left"), 4, "right");
  right.points_body = points_body;
  right.ellipsoid_body = ellipsoid_body;
  right.ellipsoid = mirrored(left.ellipsoid);
  for (Vector3d& p : right.points) p = mirror(p);
  return right;
}

// Points at (+-u, +-v) on the face z > 0 of an ellipsoid.
std::array<Vector3d, 4> facePoints(const Isometry3d& X, const Vector3d& radii, double u, double v) {
  std::array<Vector3d, 4> points;
  for (int i = 0; i < 4; i++) {
    const double x = i % 2 ? u : -u, y = i / 2 ? v : -v;
    const double z = radii.z() * std::sqrt(1 - x * x / (radii.x() * radii.x()) -
                                           y * y / (radii.y() * radii.y()));
    points[i] = X * Vector3d(x, y, z);
  }
  return points;
}

// Flat ellipsoid whose apex is the centre of a face.
Facet faceFacet(const Vector3d& position, const Vector3d& normal, double width, double height) {
  Facet f;
  f.radii = {kWidthFactor * width, kHeightFactor * height, kThicknessFactor * height};
  f.ellipsoid = Isometry3d::Identity();
  f.ellipsoid.linear() = faceAxes(normal);
  f.ellipsoid.translation() = position - f.radii.z() * normal;
  f.points = facePoints(f.ellipsoid, f.radii, width / 4, height / 4);
  f.band = kBand;
  return f;
}

void addZygapophyseal(const Anatomy& a, std::vector<Facet>& facets) {
  for (const Disc& disc : a.discs) {
    if (disc.upper == a.c2.name) continue;  // C2 belongs to the head, which turns on a ball joint
    for (const ArticularFacet& face : a.facets) {
      if (face.level != disc.lower) continue;
      const Isometry3d X = a.boneFrame(face.level);
      const Vector3d normal = X.linear() * face.normal;
      Facet f = faceFacet(X * face.position + kFacetGap * normal, normal, face.width, face.height);
      f.kind = Facet::Kind::kZygapophyseal;
      f.name = disc.name + "_left";
      f.points_body = disc.upper;
      f.ellipsoid_body = disc.lower == "S1" ? "pelvis" : disc.lower;
      facets.push_back(f);
      facets.push_back(mirrored(f, f.points_body, f.ellipsoid_body));
    }
  }
}

// Rib head: a ball in the socket of the body's corner; tubercle: a face on the transverse process.
void addCostal(const Anatomy& a, std::vector<Facet>& facets) {
  constexpr double kRibHeadRadius = 0.007, kConeAngle = 0.8;         // assumed
  constexpr double kTubercleWidth = 0.009, kTubercleHeight = 0.011;  // assumed
  for (const CostalJoint& joint : a.costal_joints) {
    if (joint.level[0] != 'T' || std::stoi(joint.level.substr(1)) > 7) continue;
    const Isometry3d X = a.boneFrame(joint.level);
    Facet f;
    if (joint.costotransverse) {
      const Vector3d normal = Vector3d(1, 0.4, 0.1).normalized();
      f = faceFacet(X * joint.position, X.linear() * normal, kTubercleWidth, kTubercleHeight);
      f.kind = Facet::Kind::kCostotransverse;
      f.name = joint.level + "_costotransverse_left";
    } else {
      f.radii = Vector3d::Constant(kRibHeadRadius);
      const Vector3d outward = Vector3d(joint.position.x(), joint.position.y(), 0).normalized();
      f.ellipsoid = Isometry3d::Identity();
      f.ellipsoid.linear() = X.linear() * faceAxes(outward);
      f.ellipsoid.translation() = X * joint.position;
      f.band = kBand;
      const double u = kRibHeadRadius * std::sin(kConeAngle) / std::sqrt(2.0);
      f.points = facePoints(f.ellipsoid, f.radii, u, u);
      f.kind = Facet::Kind::kCostovertebral;
      f.name = joint.level + "_costovertebral_left";
    }
    f.points_body = "ribcage";
    f.ellipsoid_body = joint.level;
    facets.push_back(f);
    facets.push_back(mirrored(f, f.points_body, f.ellipsoid_body));
  }
}

void addScapulothoracic(const Anatomy& a, std::vector<Facet>& facets) {
  // van der Helm 1994, J Biomech 27:527-550, one ellipsoid for the whole thorax: half axes 93, 142
  // and 205 mm, centred 58 mm behind and 145 mm below IJ; grown by serratus anterior, subscapularis
  // and half the blade (assumed) to where the scapula's costal surface lies.
  Facet f;
  const Vector3d centre = a.landmark("suprasternal_notch_IJ") + Vector3d(-0.058, 0, -0.145);
  f.radii = Vector3d(0.093, 0.142, 0.205) + Vector3d(0.019, 0.013, 0.017);
  // At 0.2 the scapula could leave the thorax by a centimetre; 0.05 leaves it about 3 mm.
  f.band = 0.05;
  f.ellipsoid = Isometry3d::Identity();
  f.ellipsoid.translation() = centre;
  const Vector3d ts = a.landmark("scapula_root_of_spine_TS");
  const Vector3d ai = a.landmark("scapula_inferior_angle_AI");
  const Vector3d gh = a.landmark("glenohumeral_centre_GH");
  // Near the four corners of the blade: superior angle, root of the spine, inferior angle, neck.
  const std::array<Vector3d, 4> corners = {ts + 0.35 * (ts - ai), ts + 0.1 * (ai - ts),
                                           ai + 0.1 * (ts - ai), gh + 0.45 * (ts - gh)};
  for (int i = 0; i < 4; i++) {
    const Vector3d from_centre = corners[i] - centre;
    const double scale = from_centre.cwiseQuotient(f.radii).norm();
    f.points[i] = centre + from_centre / scale;
  }
  f.kind = Facet::Kind::kScapulothoracic;
  f.name = "scapulothoracic_left";
  f.points_body = "left_scapula";
  f.ellipsoid_body = "ribcage";
  facets.push_back(f);
  facets.push_back(mirrored(f, "right_scapula", "ribcage"));
}

}  // namespace

FacetGap facetGap(const Vector3d& point, const Vector3d& radii, double band, const Vector3d& rest) {
  constexpr double kWrongSide = 0.3;  // share of the way from the centre to the rest place
  const Vector3d inverse = radii.cwiseInverse();
  const Vector3d scaled = point.cwiseProduct(inverse), side = rest.cwiseProduct(inverse);
  const double along = scaled.dot(side);
  if (along < kWrongSide) {
    const Vector3d gradient = side.cwiseProduct(inverse);
    const double slope = gradient.norm();
    return {(std::sqrt(1 - band) - along) / slope, gradient / slope};
  }
  const double C = scaled.squaredNorm() - 1;
  const Vector3d gradient = 2 * scaled.cwiseProduct(inverse);
  const double slope = gradient.norm();
  return {(std::abs(C) - band) / slope, (C > 0 ? -1 : 1) / slope * gradient};
}

std::vector<Facet> makeFacets(const Anatomy& anatomy) {
  const double scale = anatomy.length_scale;
  const Anatomy table_size = anatomy.scaled(1 / scale, 1);  // the size that the constants are for
  std::vector<Facet> facets;
  addZygapophyseal(table_size, facets);
  addCostal(table_size, facets);
  addScapulothoracic(table_size, facets);
  for (Facet& f : facets) {
    f.ellipsoid.translation() *= scale;
    f.radii *= scale;
    for (Vector3d& p : f.points) p *= scale;
  }
  return facets;
}

}  // namespace torso
