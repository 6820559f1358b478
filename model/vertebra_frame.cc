// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/vertebra_frame.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>

namespace torso {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

double meshSize(const TriMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& v : mesh.vertices) box.extend(v);
  return box.diagonal().norm();
}

struct Plane {
  Vector3d normal;
  double offset;    // normal . x = offset
  double mismatch;  // mean distance of mirrored points to the surface
};

// About n points of equal weight.
std::vector<Vector3d> evenPoints(const TriMesh& mesh, int n, std::vector<Vector3d>* normals) {
  const std::vector<SurfacePoint> dense = surfacePoints(mesh, meshSize(mesh) / 60);
  double total = 0;
  for (const auto& p : dense) total += p.area;
  std::vector<Vector3d> out;
  double sum = 0;
  for (const auto& p : dense) {
    sum += p.area;
    if (sum < total * (static_cast<double>(out.size()) + 0.5) / n) continue;
    out.push_back(p.position);
    if (normals) normals->push_back(p.normal);
  }
  return out;
}

class SymmetrySearch {
 public:
  explicit SymmetrySearch(const TriMesh& mesh)
      : coarse_(evenPoints(mesh, 250, nullptr)), fine_(evenPoints(mesh, 2500, &normals_)) {
    for (const Vector3d& p : fine_) middle_ += p / static_cast<double>(fine_.size());
  }

  // Best planes, each a local optimum, the best first.
  std::vector<Plane> run() {
    std::vector<Plane> starts;
    constexpr int kDirections = 300;  // on a half sphere, a Fibonacci lattice
    for (int i = 0; i < kDirections; i++) {
      const double z = (i + 0.5) / kDirections, angle = i * M_PI * (3 - std::sqrt(5.0));
      const double r = std::sqrt(1 - z * z);
      const Vector3d n(r * std::cos(angle), r * std::sin(angle), z);
      starts.push_back({n, n.dot(middle_), 0});
      starts.back().mismatch = mismatch(starts.back(), coarse_, coarse_);
    }
    std::sort(starts.begin(), starts.end(),
              [](const Plane& a, const Plane& b) { return a.mismatch < b.mismatch; });
    std::vector<Plane> best;
    for (const Plane& start : starts) {
      if (best.size() >= 4) break;
      bool near = false;
      for (const Plane& p : best) near = near || std::abs(p.normal.dot(start.normal)) > 0.9;
      if (near) continue;
      best.push_back(refined(start));
    }
    std::sort(best.begin(), best.end(),
              [](const Plane& a, const Plane& b) { return a.mismatch < b.mismatch; });
    return best;
  }

 private:
  static Vector3d mirrored(const Plane& plane, const Vector3d& p) {
    return p - 2 * (plane.normal.dot(p) - plane.offset) * plane.normal;
  }

  static double mismatch(const Plane& plane, const std::vector<Vector3d>& points,
                         const std::vector<Vector3d>& surface) {
    double sum = 0;
    for (const Vector3d& p : points) {
      const Vector3d q = mirrored(plane, p);
      sum += (surface[nearestIndex(surface, q)] - q).norm();
    }
    return sum / static_cast<double>(points.size());
  }

  // Pairs mirrored points with the surface and moves the plane so that they come to lie on the
  // tangent planes there, by least squares; then again.
  Plane refined(Plane plane) const {
    constexpr int kCoarse = 15, kFine = 6;
    for (int iteration = 0; iteration < kCoarse + kFine; iteration++) {
      struct Row {
        double residual;
        Vector3d slope;  // by two tilts of the normal and the offset
        double distance;
      };
      std::vector<Row> rows;
      const Vector3d& n = plane.normal;
      const Vector3d e1 = n.unitOrthogonal(), e2 = n.cross(e1);
      const double offset = plane.offset - n.dot(middle_);
      const std::size_t stride = iteration < kCoarse ? 10 : 2;
      for (std::size_t i = 0; i < fine_.size(); i += stride) {
        const Vector3d image = mirrored(plane, fine_[i]);
        const std::size_t k = nearestIndex(fine_, image);
        const Vector3d p = fine_[i] - middle_, &normal = normals_[k];
        const double from_plane = n.dot(p) - offset, facing = normal.dot(n);
        rows.push_back({normal.dot(image - fine_[k]),
                        {-2 * (e1.dot(p) * facing + from_plane * normal.dot(e1)),
                         -2 * (e2.dot(p) * facing + from_plane * normal.dot(e2)), 2 * facing},
                        (image - fine_[k]).norm()});
      }
      // A fifth may be lopsided.
      std::sort(rows.begin(), rows.end(),
                [](const Row& a, const Row& b) { return a.distance < b.distance; });
      rows.resize(rows.size() * 4 / 5);
      Matrix3d A = Matrix3d::Zero();
      Vector3d b = Vector3d::Zero();
      for (const Row& row : rows) {
        A += row.slope * row.slope.transpose();
        b -= row.slope * row.residual;
      }
      A.diagonal() *= 1 + 1e-6;
      const Vector3d step = A.ldlt().solve(b);
      const Vector2d tilt = step.head<2>() / std::max(1.0, step.head<2>().norm() / 0.1);
      plane.normal = (n + tilt.x() * e1 + tilt.y() * e2).normalized();
      plane.offset = plane.normal.dot(middle_) + offset + step.z();
    }
    plane.mismatch = mismatch(plane, coarse_, fine_);
    return plane;
  }

  std::vector<Vector3d> normals_, coarse_, fine_;  // normals_: of fine_
  Vector3d middle_ = Vector3d::Zero();
};

// z, x -> turned by the frame R about y.
Isometry3d aboutY(const Vector3d& origin, const Vector3d& x, const Vector3d& z) {
  Isometry3d X = Isometry3d::Identity();
  X.linear().col(0) = x.normalized();
  X.linear().col(2) = z.normalized();
  X.linear().col(1) = X.linear().col(2).cross(X.linear().col(0));
  X.translation() = origin;
  return X;
}

// Direction in which the two outlines are furthest apart, from the arch to the body.
Vector2d apart(const MidSection& s) {
  Vector2d best = Vector2d::UnitX();
  double widest = -std::numeric_limits<double>::infinity();
  for (int degree = 0; degree < 360; degree++) {
    const Vector2d d(std::cos(degree * M_PI / 180), std::sin(degree * M_PI / 180));
    double back = std::numeric_limits<double>::infinity(), front = -back;
    for (const Vector2d& p : s.body) back = std::min(back, d.dot(p));
    for (const Vector2d& p : s.arch) front = std::max(front, d.dot(p));
    if (back - front > widest) {
      widest = back - front;
      best = d;
    }
  }
  return best;
}

// How much speaks for +z being up; about 1 for a clear case.
double upEvidence(const TriMesh& mesh, const MidSection& s) {
  const EndplateLine upper = endplateLine(s.body, true), lower = endplateLine(s.body, false);
  const double height = upper.at - lower.at, middle = (upper.at + lower.at) / 2;
  const double back = (upper.back + lower.back) / 2;
  double front = -std::numeric_limits<double>::infinity();
  for (const Vector2d& p : s.arch) front = std::max(front, p.y());
  // Pedicles: all bone beside the canal close behind the body.
  double area = 0, moment = 0;
  for (const Outline& o : section(mesh, 0, back - 0.2 * (back - front))) {
    area += signedArea(o);
    moment += signedArea(o) * centroid(o).y();
  }
  const double pedicles = area > 0 ? (moment / area - middle) / height : 0;
  const double arch = (centroid(s.arch).x() - middle) / height;
  return 2 * pedicles - arch;
}

}  // namespace

double breadth(const TriMesh& bone, const Vector3d& point) {
  return rayLength(bone, point, Vector3d::UnitY()) + rayLength(bone, point, -Vector3d::UnitY());
}

MidSection midSection(const TriMesh& mesh) {
  struct Piece {
    Outline outline;
    double bulk;
  };
  std::vector<Piece> pieces;
  for (const Outline& o : section(mesh, 1, 0)) {
    const double area = signedArea(o);
    if (area <= 0) continue;
    const Vector2d zx = centroid(o);
    const double b = breadth(mesh, {zx.y(), 0, zx.x()});
    pieces.push_back({o, area * (std::isfinite(b) ? b : 0)});
  }
  // The two largest; the body is the bulkier.
  std::sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) {
    return signedArea(a.outline) > signedArea(b.outline);
  });
  if (pieces.size() < 2 || signedArea(pieces[1].outline) < 0.04 * signedArea(pieces[0].outline)) {
    throw std::runtime_error("its mid-plane does not cut a body and, behind the canal, an arch");
  }
  const int body = pieces[0].bulk >= pieces[1].bulk ? 0 : 1;
  return {pieces[body].outline, pieces[1 - body].outline};
}

EndplateLine endplateLine(const Outline& body, bool upper) {
  constexpr double kTouch = 0.015;  // of the body's size, what counts as touching
  constexpr double kSteepest = 35 * M_PI / 180, kStep = 0.25 * M_PI / 180;
  const double sign = upper ? 1 : -1;
  Eigen::AlignedBox2d box;
  for (const Vector2d& p : body) box.extend(p);
  const double touch = kTouch * box.diagonal().norm();
  struct Rest {
    double angle, height, back, front;  // height along the line's normal
    double span() const { return front - back; }
  };
  std::vector<Rest> rests;
  double longest = 0;
  for (double angle = -kSteepest; angle <= kSteepest; angle += kStep) {
    const Vector2d normal = sign * Vector2d(std::cos(angle), -std::sin(angle));  // (z, x)
    Rest rest = {angle, -std::numeric_limits<double>::infinity(), 0, 0};
    for (const Vector2d& p : body) rest.height = std::max(rest.height, normal.dot(p));
    rest.back = std::numeric_limits<double>::infinity();
    rest.front = -rest.back;
    for (std::size_t i = 0; i < body.size(); i++) {
      // The part of each edge within reach of the line.
      const Vector2d &a = body[i], &b = body[(i + 1) % body.size()];
      const double da = rest.height - normal.dot(a), db = rest.height - normal.dot(b);
      if (std::min(da, db) > touch) continue;
      for (const auto& [p, q, d, e] : {std::tuple{a, b, da, db}, std::tuple{b, a, db, da}}) {
        const Vector2d end = d <= touch ? p : (p + (d - touch) / (d - e) * (q - p)).eval();
        rest.back = std::min(rest.back, end.y());
        rest.front = std::max(rest.front, end.y());
      }
    }
    longest = std::max(longest, rest.span());
    rests.push_back(rest);
  }
  EndplateLine line = {0, 0, 0, 0};
  int count = 0;
  for (const Rest& rest : rests) {
    if (rest.span() < 0.97 * longest) continue;
    line.slope += rest.angle;
    line.back += rest.back;
    line.front += rest.front;
    count++;
  }
  line.back /= count;
  line.front /= count;
  line.slope = std::tan(line.slope / count);
  line.at = -sign * std::numeric_limits<double>::infinity();
  for (const Vector2d& p : body) {
    const double at = p.x() - line.slope * p.y();
    line.at = upper ? std::max(line.at, at) : std::min(line.at, at);
  }
  return line;
}

VertebraPose vertebraPose(const TriMesh& mesh, const std::optional<Vector3d>& up_hint) {
  const double size = meshSize(mesh);
  std::string reason = "it has no plane of symmetry";
  for (const Plane& plane : SymmetrySearch(mesh).run()) {
    if (plane.mismatch > 0.05 * size) continue;
    // Any frame with that mid-plane; then the arch shows the rear, and the body's corners the rest.
    Vector3d z = plane.normal.unitOrthogonal();
    Isometry3d X = aboutY(plane.offset * plane.normal, plane.normal.cross(z), z);
    try {
      for (int pass = 0; pass < 5; pass++) {
        const TriMesh local = transformed(mesh, X.inverse());
        const MidSection s = midSection(local);
        Vector2d front;  // (z, x)
        Vector2d origin;
        if (pass == 0) {
          front = apart(s);
          origin = centroid(s.body);
        } else {
          const EndplateLine upper = endplateLine(s.body, true);
          const EndplateLine lower = endplateLine(s.body, false);
          const double pitch = (std::atan(upper.slope) + std::atan(lower.slope)) / 2;
          front = {std::sin(pitch), std::cos(pitch)};
          const double x = (upper.back + upper.front + lower.back + lower.front) / 4;
          origin = {(upper.at + lower.at + (upper.slope + lower.slope) * x) / 2, x};
        }
        front.normalize();
        const Vector3d x(front.y(), 0, front.x());
        X = X * aboutY(Vector3d(origin.y(), 0, origin.x()), x, x.cross(Vector3d::UnitY()));
      }
      const TriMesh local = transformed(mesh, X.inverse());
      double up = upEvidence(local, midSection(local));
      if (up_hint) up = 2 * up_hint->normalized().dot(X.linear().col(2));
      if (up < 0) X = X * Eigen::AngleAxisd(M_PI, Vector3d::UnitX());
      return {X, std::min(1.0, std::abs(up))};
    } catch (const std::runtime_error& e) {
      reason = e.what();
    }
  }
  throw std::runtime_error(reason);
}

}  // namespace torso
