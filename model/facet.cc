// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/facet.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "model/body_warp.h"

namespace torso {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kFacetGap = 2e-3;  // bone to bone: two cartilages; as the bones are made
constexpr double kBand = 0.2;       // Lee et al. 2023, equation 6

// Half axes of a facet's ellipsoid over the face's width and height. The face is the middle of a
// shell that is large enough for the opposite face to glide over in full flexion (about half its
// height). A tenth of the half thickness is what the band lets the faces part and close: their
// capsule's slack and cartilage. Assumed, with torso rom: lumbar and thoracic segments then turn
// about their axis, and cervical ones flex, as far as measured.
constexpr double kWidthFactor = 1.2, kHeightFactor = 1.5;
constexpr double kThicknessFactor = 0.5, kCervicalThicknessFactor = 0.9;

// The rib cage is one body, but ribs bend: vertebrae of living people turn by up to 5 degrees
// against the mean of the cage (Fujimori et al. 2012, Spine 37:E1383), 2 mm at its joints with
// the ribs. So far their bands are wide; the stiffness of the ribs is that of the bushings.
constexpr double kCostalBand = 0.4;
constexpr double kRibHeadRadius = 0.010, kTubercleThicknessFactor = 0.9;

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

// Flat ellipsoid whose apex is the centre of a face; thickness: half of it, over the height.
Facet faceFacet(const Vector3d& position, const Vector3d& normal, double width, double height,
                double thickness) {
  Facet f;
  f.radii = {kWidthFactor * width, kHeightFactor * height, thickness * height};
  f.ellipsoid = Isometry3d::Identity();
  f.ellipsoid.linear() = faceAxes(normal);
  f.ellipsoid.translation() = position - f.radii.z() * normal;
  f.points = facePoints(f.ellipsoid, f.radii, width / 4, height / 8);
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
      const bool cervical = disc.region == Region::kCervical;
      Facet f = faceFacet(X * face.position + kFacetGap * normal, normal, face.width, face.height,
                          cervical ? kCervicalThicknessFactor : kThicknessFactor);
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
  constexpr double kConeAngle = 0.8;                                 // assumed
  constexpr double kTubercleWidth = 0.009, kTubercleHeight = 0.011;  // assumed
  for (const CostalJoint& joint : a.costal_joints) {
    if (joint.level[0] != 'T' || std::stoi(joint.level.substr(1)) > 7) continue;
    const Isometry3d X = a.boneFrame(joint.level);
    Facet f;
    if (joint.costotransverse) {
      const Vector3d normal = Vector3d(1, 0.4, 0.1).normalized();
      f = faceFacet(X * joint.position, X.linear() * normal, kTubercleWidth, kTubercleHeight,
                    kTubercleThicknessFactor);
      f.kind = Facet::Kind::kCostotransverse;
      f.name = joint.level + "_costotransverse_left";
    } else {
      f.radii = Vector3d::Constant(kRibHeadRadius);
      const Vector3d outward = Vector3d(joint.position.x(), joint.position.y(), 0).normalized();
      f.ellipsoid = Isometry3d::Identity();
      f.ellipsoid.linear() = X.linear() * faceAxes(outward);
      f.ellipsoid.translation() = X * joint.position;
      const double u = kRibHeadRadius * std::sin(kConeAngle) / std::sqrt(2.0);
      f.points = facePoints(f.ellipsoid, f.radii, u, u);
      f.kind = Facet::Kind::kCostovertebral;
      f.name = joint.level + "_costovertebral_left";
    }
    f.band = kCostalBand;
    f.points_body = "ribcage";
    f.ellipsoid_body = joint.level;
    facets.push_back(f);
    facets.push_back(mirrored(f, f.points_body, f.ellipsoid_body));
  }
}

void addScapulothoracic(const Anatomy& a, std::vector<Facet>& facets) {
  // An upright ellipsoid for each side, turned to face back and outwards, as in Seth et al. 2016,
  // PLoS ONE 11:e0141028 (half axes 70, 70 and 150 mm, turned by 50 degrees). Fitted to our ribs 2
  // to 8, some 15 mm off them for serratus anterior and subscapularis, so that the scapula stays on
  // it while it moves as bone pins do (shoulder_rhythm.csv), shrugs, protracts and retracts.
  Facet f;
  const Matrix3d turn = a.warp ? a.warp->thoraxRotation() : Matrix3d(Matrix3d::Identity());
  const Vector3d growth = a.warp ? a.warp->thoraxGrowth() : Vector3d(1, 1, 1);
  const Vector3d centre = a.landmark("suprasternal_notch_IJ") +
                          turn * growth.cwiseProduct(Vector3d(-0.106, 0.075, -0.132));
  const Matrix3d axes = Eigen::AngleAxisd(M_PI / 4, Vector3d::UnitZ()).toRotationMatrix();
  f.radii = {0.0925, 0.0575, 0.159};
  for (int k = 0; k < 3; k++) f.radii[k] *= growth.cwiseProduct(Vector3d(axes.col(k))).norm();
  f.band = 0.045;  // about 2 mm
  f.ellipsoid = Isometry3d::Identity();
  f.ellipsoid.linear() = turn * axes;
  f.ellipsoid.translation() = centre;
  const Vector3d ts = a.landmark("scapula_root_of_spine_TS");
  const Vector3d ai = a.landmark("scapula_inferior_angle_AI");
  const Vector3d gh = a.landmark("glenohumeral_centre_GH");
  // Near the four corners of the blade: superior angle, root of the spine, inferior angle, neck.
  const std::array<Vector3d, 4> corners = {ts + 0.25 * (ts - ai), ts + 0.2 * (ai - ts),
                                           ai + 0.2 * (ts - ai), gh + 0.45 * (ts - gh)};
  for (int i = 0; i < 4; i++) {
    const Vector3d from_centre = corners[i] - centre;
    const Vector3d from_axes = f.ellipsoid.linear().transpose() * from_centre;
    const double scale = from_axes.cwiseQuotient(f.radii).norm();
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

std::vector<Facet> makeFacets(const Anatomy& anatomy, const Skeleton& skeleton) {
  std::vector<Facet> facets = makeFacets(anatomy);
  if (!skeleton.has("left_scapula")) return facets;
  for (std::size_t i = 0; i + 1 < facets.size(); i++) {
    Facet& left = facets[i];
    if (left.kind != Facet::Kind::kScapulothoracic || left.points_body != "left_scapula") continue;
    fitToScapula(skeleton.bone("left_scapula"), anatomy.length_scale, &left);
    facets[i + 1] = mirrored(left, "right_scapula", left.ellipsoid_body);
  }
  return facets;
}

void fitToScapula(const MeshTree& scapula, double size, Facet* facet) {
  const double mm = 1e-3 * size;
  // The costal surface: what looks at the thorax with nothing of the scapula in between.
  const Vector3d thorax = facet->ellipsoid.translation();
  std::vector<Vector3d> costal;
  const TriMesh& mesh = scapula.mesh();
  for (std::size_t i = 0; i < mesh.faces.size(); i++) {
    const auto& f = mesh.faces[i];
    const Vector3d a = mesh.vertices[f[0]], b = mesh.vertices[f[1]], c = mesh.vertices[f[2]];
    const Vector3d n = scapula.normal(static_cast<int>(i));
    for (const Vector3d& p : {Vector3d((a + b + c) / 3), Vector3d((a + b) / 2),
                              Vector3d((b + c) / 2), Vector3d((c + a) / 2)}) {
      const Vector3d inwards = (thorax - p).normalized();
      if (n.dot(inwards) < 0.6) continue;
      if (scapula.castRay(p + 0.1 * mm * n, inwards).face < 0) costal.push_back(p);
    }
  }
  if (costal.empty()) return;
  const auto nearest = [&](const Vector3d& from, const auto& cost) {
    const Vector3d* best = &costal.front();
    for (const Vector3d& p : costal) {
      if (cost(p, from) < cost(*best, from)) best = &p;
    }
    return *best;
  };
  std::array<Vector3d, 4> corners;
  for (int k = 0; k < 4; k++) {
    corners[k] = nearest(facet->points[k],
                         [](const Vector3d& p, const Vector3d& from) { return (p - from).norm(); });
  }

  // Half axes and centre, by least squares (Gauss and Newton, differences), held to what they were:
  // 10 mm off there weighs as much as 1 mm between a corner and the ellipsoid.
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  using Vector10d = Eigen::Matrix<double, 10, 1>;
  const Matrix3d axes = facet->ellipsoid.linear();
  const Vector3d radii = facet->radii;
  const auto level = [&](const Vector6d& x, const Vector3d& p) {  // 1 on the ellipsoid
    return (axes.transpose() * (p - thorax - x.tail<3>()))
        .cwiseQuotient(radii + x.head<3>())
        .norm();
  };
  const auto residuals = [&](const Vector6d& x) {
    Vector10d r;
    for (int k = 0; k < 4; k++) r[k] = (level(x, corners[k]) - 1) * (corners[k] - thorax).norm();
    r.tail<6>() = 0.1 * x;
    return r;
  };
  Vector6d x = Vector6d::Zero();
  for (int pass = 0; pass < 10; pass++) {
    const Vector10d r = residuals(x);
    Eigen::Matrix<double, 10, 6> J;
    for (int k = 0; k < 6; k++) {
      Vector6d y = x;
      y[k] += 1e-6;
      J.col(k) = (residuals(y) - r) / 1e-6;
    }
    x -= (J.transpose() * J).ldlt().solve(J.transpose() * r);
  }
  facet->radii = radii + x.head<3>();
  facet->ellipsoid.translation() = thorax + x.tail<3>();

  for (int k = 0; k < 4; k++) {
    // About the corner; a millimetre off the ellipsoid counts as much as ten along it.
    const Vector3d p = nearest(corners[k], [&](const Vector3d& q, const Vector3d& from) {
      return 10 * std::abs(level(x, q) - 1) * (q - thorax).norm() + (q - from).norm();
    });
    const Vector3d centre = facet->ellipsoid.translation();
    facet->points[k] = centre + (p - centre) / level(x, p);
  }
}

}  // namespace torso
