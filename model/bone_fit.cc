// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/bone_fit.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>

#include "model/body.h"
#include "model/disc_fit.h"
#include "model/facet.h"
#include "model/facet_gap.h"
#include "model/ligament.h"
#include "model/ligament_site.h"
#include "model/parallel.h"
#include "model/vertebra_measure.h"

namespace torso {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class Checker {
 public:
  Checker(const Anatomy& anatomy, const Skeleton& skeleton)
      : a_(anatomy), s_(skeleton), mm_(1e-3 * anatomy.length_scale) {}

  std::vector<FitCheck> run(int threads) {
    for (const std::string& body : s_.bodies()) solid(body);
    for (const std::string& body : s_.bodies()) mirrorImage(body);
    for (std::size_t i = 0; i < s_.bodies().size(); i++) {
      for (std::size_t j = 0; j < i; j++) apart(s_.bodies()[i], s_.bodies()[j]);
    }
    for (const Disc& d : a_.discs) disc(d);
    canal();
    for (const Disc& d : a_.discs) foramen(d);
    ligaments();
    facets();
    std::vector<std::vector<FitCheck>> results(jobs_.size());
    forEach(static_cast<int>(jobs_.size()), threads, [&](int i) { results[i] = jobs_[i](); });
    std::vector<FitCheck> out;
    for (auto& r : results) out.insert(out.end(), r.begin(), r.end());
    return out;
  }

 private:
  using Checks = std::vector<FitCheck>;

  static FitCheck count(const std::string& check, const std::string& where, double value) {
    return {check, where, value, 0, 0, false};
  }
  static FitCheck length(const std::string& check, const std::string& where, double value,
                         double low, double high) {
    return {check, where, value, low, high, true};
  }
  std::string body(const std::string& level) const { return bodyOfLevel(a_, level); }
  bool hasLevel(const std::string& level) const { return s_.has(body(level)); }

  // ---- bones ----

  void solid(const std::string& name) {
    jobs_.push_back([=] {
      Checks out;
      for (const BonePart& part : s_.parts(name)) {
        const std::string where = name + (part.tissue == Tissue::kBone ? "" : " cartilage");
        const MeshFaults f = findFaults(part.mesh);
        out.push_back(count("closed", where,
                            f.bad_indices + f.open_edges + f.crowded_edges + f.misturned_edges +
                                f.pinched_vertices + f.flat_faces));
        out.push_back(count("self_intersection", where,
                            static_cast<double>(MeshTree(part.mesh).selfIntersections().size())));
      }
      return out;
    });
  }

  void mirrorImage(const std::string& name) {
    const auto [side, pair] = splitSide(name);
    const std::string other = side == Side::kMiddle ? name : "left_" + pair;
    if (side == Side::kLeft || !s_.has(other)) return;
    jobs_.push_back([=] {
      double furthest = 0;
      for (const Vector3d& p : s_.whole(name).mesh().vertices) {
        furthest = std::max(furthest, s_.whole(other).nearest(mirror(p)).distance);
      }
      return Checks{length("mirror", name, furthest, 0, 0.05 * mm_)};
    });
  }

  void apart(const std::string& a, const std::string& b) {
    if (!s_.whole(a).box().intersects(s_.whole(b).box())) return;
    jobs_.push_back([=] {
      const double depth = penetration(s_.whole(a), s_.whole(b));
      return Checks{length("apart", b + " - " + a, depth, 0, 0)};
    });
  }

  // ---- discs ----

  void disc(const Disc& d) {
    if (!hasLevel(d.lower) || !hasLevel(d.upper)) return;
    jobs_.push_back([this, &d] {
      DiscMesh mesh = makeDiscMesh(d.shape);
      const MeshTree &below = s_.bone(body(d.lower)), &above = s_.bone(body(d.upper));
      fitDiscFaces(d.frame, below, above, kDiscReach * a_.length_scale, &mesh);
      double gap = 0, overlap = 0;
      const auto face = [&](const MeshTree& bone, const std::vector<int>& nodes) {
        std::vector<char> in(mesh.rest_positions.size(), 0);
        for (int node : nodes) in[node] = 1;
        std::vector<Vector3d> points;
        for (int node : nodes) points.push_back(mesh.rest_positions[node]);
        for (const auto& t : mesh.tets) {
          for (int k = 0; k < 4; k++) {
            const int x = t[k], y = t[(k + 1) % 4], z = t[(k + 2) % 4];
            if (!in[x] || !in[y] || !in[z]) continue;
            points.push_back(
                (mesh.rest_positions[x] + mesh.rest_positions[y] + mesh.rest_positions[z]) / 3);
          }
        }
        for (const Vector3d& p : points) {
          const double distance = bone.signedDistance(d.frame * p);
          gap = std::max(gap, distance);
          overlap = std::max(overlap, -distance);
        }
      };
      face(below, mesh.lower_nodes);
      face(above, mesh.upper_nodes);
      // Half way up, at the nodes of the middle layer, but for those near the outside.
      double least = kInfinity;
      for (const Vector3d& p : makeDiscMesh(d.shape).rest_positions) {
        if (std::abs(p.z()) > 1e-9) continue;
        const double x = 2 * p.x() / d.shape.depth, y = 2 * p.y() / d.shape.width;
        if (x * x + y * y > 0.7) continue;  // beside it rise the neck's uncinate processes
        const double height =
            d.shape.height_posterior +
            (d.shape.height_anterior - d.shape.height_posterior) * (p.x() / d.shape.depth + 0.5);
        const Vector3d q = d.frame * p;
        const Vector3d up = d.frame.linear().col(2);
        const bool free = below.windingNumber(q) == 0 && above.windingNumber(q) == 0;
        const double room =
            free ? std::min(below.castRay(q, -up).distance, above.castRay(q, up).distance) : 0;
        least = std::min(least, room / (height / 2));
      }
      return Checks{length("disc_gap", d.name, gap, 0, 0.5 * mm_),
                    length("disc_overlap", d.name, overlap, 0, 0.5 * mm_),
                    FitCheck{"disc_space", d.name, least, 0.8, kInfinity, false}};
    });
  }

  // ---- canal and foramina ----

  // Middle of a vertebra's canal; the shape in the vertebra frame.
  Vector3d canalMiddle(const std::string& level) const {
    const MeshTree local(transformed(s_.bone(level).mesh(), bodyFrame(a_, level).inverse()));
    const VertebraShape shape(local, a_.length_scale);
    return bodyFrame(a_, level) * Vector3d(shape.backWall(0) - shape.canalDepth() / 2, 0, 0);
  }

  void canal() {
    for (std::size_t i = 0; i < a_.vertebrae.size(); i++) {
      const std::string level = a_.vertebrae[i].name;
      if (!s_.has(level)) continue;
      const bool has_next = i + 1 < a_.vertebrae.size() && s_.has(a_.vertebrae[i + 1].name);
      jobs_.push_back([=] {
        const Vector3d from = canalMiddle(level);
        const Vector3d to = has_next ? canalMiddle(a_.vertebrae[i + 1].name) : from;
        double room = kInfinity;
        for (int k = 0; k <= 10; k++) {
          const Vector3d p = from + k / 10.0 * (to - from);
          room = std::min(room, s_.bone(level).signedDistance(p));
          if (has_next) {
            room = std::min(room, s_.bone(a_.vertebrae[i + 1].name).signedDistance(p));
          }
        }
        return Checks{length("canal", level, room, 5 * mm_, kInfinity)};
      });
    }
  }

  void foramen(const Disc& d) {
    if (!hasLevel(d.lower) || !hasLevel(d.upper) || d.upper == a_.c2.name) return;
    jobs_.push_back([this, &d] {
      const MeshTree &below = s_.bone(body(d.lower)), &above = s_.bone(body(d.upper));
      const auto room = [&](const Vector3d& p) {
        return std::min(below.signedDistance(p), above.signedDistance(p));
      };
      const Vertebra& v = a_.vertebra(d.upper);
      // The sagittal plane through the middle of the upper pedicle: between the disc and the facet
      // joint, from the pedicle above to the one below.
      const double y = (v.canal_width + v.pedicle_width) / 2, back = -d.shape.depth / 2;
      double radius = -kInfinity;
      Vector3d middle = d.frame.translation();
      for (double x = back - 14 * mm_; x < back; x += mm_) {
        for (double z = -8 * mm_; z < 22 * mm_; z += mm_) {
          const Vector3d p = d.frame * Vector3d(x, y, z);
          const double r = room(p);
          if (r > radius) {
            radius = r;
            middle = p;
          }
        }
      }
      // In from the canal, and out: straight, or forwards past the transverse process.
      const auto free = [&](const Vector3d& along, double length) {
        const Vector3d u = d.frame.linear() * along.normalized();
        return below.castRay(middle, u).distance > length &&
               above.castRay(middle, u).distance > length;
      };
      bool in = false, out = false;
      for (double a = -0.9; a <= 0.9; a += 0.15) {
        for (double b = -0.6; b <= 0.6; b += 0.15) {
          const Vector3d along(std::sin(a), std::cos(a), std::sin(b));
          out = out || free(along, 15 * mm_);
          in = in || free({along.x(), -along.y(), along.z()}, y - 0.2 * v.canal_width);
        }
      }
      return Checks{length("foramen", d.name, in && out ? radius : 0, 2 * mm_, kInfinity)};
    });
  }

  // ---- ligaments ----

  void ligaments() {
    if (!hasLevel("S1")) return;
    for (const Vertebra& v : a_.vertebrae) {
      if (!s_.has(v.name)) return;
    }
    const auto segments = std::make_shared<std::vector<LigamentSegment>>(makeLigaments(a_, s_));
    for (const LigamentSegment& s : *segments) {
      for (bool upper : {false, true}) {
        const std::string level = upper ? s.upper : s.lower;
        jobs_.push_back([=, &s] {
          (void)segments;  // s is one of them
          const Vector3d p = upper ? s.upper_point : s.lower_point;
          // The upper point is on the lower side of the upper bone.
          const double distance = onSite(a_, level, s.ligament, !upper, p)
                                      ? s_.bone(body(level)).nearest(p).distance
                                      : kInfinity;
          return Checks{length("ligament", s.name + " on " + level, distance, 0, 1.5 * mm_)};
        });
      }
    }
  }

  // ---- facets ----

  void facets() {
    const bool scapulae = s_.has("left_scapula") && s_.has("right_scapula");
    const auto all =
        std::make_shared<std::vector<Facet>>(scapulae ? makeFacets(a_, s_) : makeFacets(a_));
    for (const Facet& f : *all) {
      if (!s_.has(f.points_body) || !s_.has(f.ellipsoid_body)) continue;
      if (f.kind == Facet::Kind::kZygapophyseal) {
        jobs_.push_back([=, &f] {
          (void)all;
          return zygapophyseal(f);
        });
      } else if (f.kind == Facet::Kind::kScapulothoracic) {
        jobs_.push_back([=, &f] {
          (void)all;
          return scapulothoracic(f);
        });
      }
    }
  }

  double furthest(const MeshTree& bone, const std::array<Vector3d, 4>& points) const {
    double most = 0;
    for (const Vector3d& p : points) most = std::max(most, bone.nearest(p).distance);
    return most;
  }

  Checks zygapophyseal(const Facet& f) const {
    const MeshTree& superior = s_.bone(f.ellipsoid_body);
    // The face below the ellipsoid's apex.
    const Vector3d n = f.ellipsoid.linear().col(2);
    const auto face = findFace(superior, f.ellipsoid * Vector3d(0, 0, f.radii.z() - 2 * mm_), n,
                               Vector3d::UnitZ(), a_.length_scale);
    double out = kInfinity;
    if (face) {
      out = 0;
      const Vector3d up = (Vector3d::UnitZ() - n.z() * n).normalized();
      const Vector3d across = up.cross(n);
      for (int k = 0; k < 16; k++) {  // the rim of the face
        const double a = 2 * M_PI * k / 16;
        const Vector3d p = face->centre + face->width / 2 * std::cos(a) * across +
                           face->height / 2 * std::sin(a) * up;
        const Vector3d q = f.ellipsoid.inverse() * p;
        const FacetGap gap = facetGap(q, f.radii, 1e-3, Vector3d(0, 0, f.radii.z()));
        if (q.cwiseQuotient(f.radii).norm() > 1) out = std::max(out, gap.violation);
      }
    }
    return {length("facet_points", f.name, furthest(s_.bone(f.points_body), f.points), 0, mm_),
            length("facet_ellipsoid", f.name, out, 0, 0.5 * mm_)};
  }

  Checks scapulothoracic(const Facet& f) const {
    const MeshTree &scapula = s_.bone(f.points_body), &ribs = s_.bone(f.ellipsoid_body);
    const Vector3d centre = f.ellipsoid.translation();
    double most = 0;
    for (const Vector3d& p : f.points) {
      const MeshTree::Nearest nearest = scapula.nearest(p);
      // The costal surface looks at the ribs.
      const bool costal = scapula.normal(nearest.face).dot(centre - nearest.point) > 0;
      most = std::max(most, costal ? nearest.distance : kInfinity);
    }
    // Between the points, where the scapula glides.
    Checks out = {length("scapula_points", f.name, most, 0, 1.5 * mm_)};
    double least = kInfinity, largest = -kInfinity;
    for (int i = 0; i <= 8; i++) {
      for (int j = 0; j <= 8; j++) {
        const double u = i / 8.0, v = j / 8.0;  // points: superior, root, inferior, neck
        const Vector3d p = (1 - u) * ((1 - v) * f.points[0] + v * f.points[2]) + u * f.points[3];
        const Vector3d along = (p - centre).normalized();
        const double surface =
            1 / (f.ellipsoid.linear().transpose() * along).cwiseQuotient(f.radii).norm();
        const double off = ribs.signedDistance(centre + surface * along);
        least = std::min(least, off);
        largest = std::max(largest, off);
      }
    }
    out.push_back(length("scapula_ellipsoid", f.name + " nearest", least, 0, 20 * mm_));
    out.push_back(length("scapula_ellipsoid", f.name + " furthest", largest, 0, 35 * mm_));
    return out;
  }

  const Anatomy& a_;
  const Skeleton& s_;
  const double mm_;
  std::vector<std::function<Checks()>> jobs_;
};

}  // namespace

std::vector<FitCheck> checkFit(const Anatomy& anatomy, const Skeleton& skeleton, int threads) {
  return Checker(anatomy, skeleton).run(threads);
}

}  // namespace torso
