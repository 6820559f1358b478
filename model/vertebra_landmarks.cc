// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/vertebra_landmarks.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "model/mesh_section.h"
#include "model/rotation.h"
#include "model/vertebra_frame.h"

namespace torso {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Two cartilages between the faces of a joint, as in the generated bones.
constexpr double kJointGap = 2e-3;

constexpr double kTipReach = 2e-3;  // a tip is the mean of the surface within this of its end [m]

// Works in the vertebra's own axes.
class Finder {
 public:
  Finder(const TriMesh& mesh, const VertebraPrior& prior)
      : mesh_(mesh), prior_(prior), points_(surfacePoints(mesh, 1.2e-3)) {}

  VertebraLandmarks run() {
    body();
    canal();
    spinous();
    transverse();
    for (int side : {0, 1}) {
      out_.superior_face[side] = face(true, side);
      out_.inferior_face[side] = face(false, side);
    }
    return out_;
  }

 private:
  void body() {
    section_ = midSection(mesh_);
    const EndplateLine upper = endplateLine(section_.body, true);
    const EndplateLine lower = endplateLine(section_.body, false);
    double depth[2], middle[2];
    const double height = upper.at - lower.at;
    for (int i : {0, 1}) {  // lower, upper
      // How far the body reaches near that endplate.
      double front = -1, back = 1;
      for (const Vector2d& p : section_.body) {
        const EndplateLine& line = i ? upper : lower;
        if (std::abs(p.x() - line.at - line.slope * p.y()) > 0.2 * height) continue;
        front = std::max(front, p.y());
        back = std::min(back, p.y());
      }
      depth[i] = front - back;
      middle[i] = (front + back) / 2;
    }
    const auto landmark = [&](const EndplateLine& line, int i) {
      Landmark l;
      l.centre = {middle[i], 0, line.at + line.slope * middle[i]};
      l.normal = (i ? 1 : -1) * Vector3d(-line.slope, 0, 1).normalized();
      l.height = depth[i];
      l.width = endplateWidth(l, height, depth[i]);
      return l;
    };
    out_.upper_endplate = landmark(upper, 1);
    out_.lower_endplate = landmark(lower, 0);
    front_ = (middle[0] + middle[1]) / 2 + (depth[0] + depth[1]) / 4;
    back_ = (middle[0] + middle[1]) / 2 - (depth[0] + depth[1]) / 4;
    const auto between = [&](double x) {
      return upper.at - lower.at + (upper.slope - lower.slope) * x;
    };
    out_.body_height_anterior = between(front_);
    out_.body_height_posterior = between(back_);
    height_ = height;
  }

  // The widest of a few cuts close under the endplate, but below its rounded edge and the roots of
  // uncinate processes, in front of the pedicles.
  double endplateWidth(const Landmark& plate, double height, double depth) const {
    Isometry3d X = Isometry3d::Identity();
    X.linear() = leastRotation(Vector3d::UnitZ(), plate.normal).toRotationMatrix();
    X.translation() = plate.centre;
    const TriMesh local = transformed(mesh_, X.inverse());
    double widest = 0;
    for (double share : {0.09, 0.11, 0.14}) {
      for (const Outline& o : section(local, 2, -share * height)) {
        if (!contains(o, Vector2d(0.1 * depth, 0))) continue;
        double left = 0, right = 0;
        for (std::size_t i = 0; i < o.size(); i++) {
          const Vector2d &a = o[i], &b = o[(i + 1) % o.size()];
          for (double t = 0; t < 1; t += 0.25) {
            const Vector2d p = a + t * (b - a);
            if (p.x() < -0.1 * depth) continue;
            left = std::max(left, p.y());
            right = std::min(right, p.y());
          }
        }
        widest = std::max(widest, left - right);
      }
    }
    if (widest == 0) {
      throw std::runtime_error(
          "the body has no closed cut below its endplate; give the landmarks "
          "upper_endplate and lower_endplate with width and height");
    }
    return widest;
  }

  void canal() {
    arch_front_ = -1;
    for (const Vector2d& p : section_.arch) arch_front_ = std::max(arch_front_, p.y());
    out_.canal_depth = back_ - arch_front_;
    // Between the pedicles, just behind the body.
    out_.canal_width = 0;
    for (double share : {0.35, 0.5, 0.6}) {
      double width = std::numeric_limits<double>::infinity();
      for (double z = -0.4 * height_; z <= 0.5 * height_; z += 0.05 * height_) {
        const Vector3d p(back_ - share * out_.canal_depth, 0, z);
        width = std::min(width, breadth(mesh_, p));
      }
      // Closest where the pedicle is, widest half way back.
      if (std::isfinite(width) && !(out_.canal_width > width)) out_.canal_width = width;
    }
    if (!(out_.canal_depth > 0) || !(out_.canal_width > 0.3 * prior_.vertebra.canal_width) ||
        !(out_.canal_width < 3 * prior_.vertebra.canal_width)) {
      throw std::runtime_error(
          "no canal with a pedicle on each side behind the body; is this a "
          "whole vertebra?");
    }
  }

  // Mean of the surface near its furthest point along a direction, of the points that count.
  template <typename Predicate>
  Vector3d tip(const Vector3d& direction, Predicate counts) const {
    double furthest = -std::numeric_limits<double>::infinity();
    for (const auto& p : points_) {
      if (counts(p.position)) furthest = std::max(furthest, direction.dot(p.position));
    }
    Vector3d sum = Vector3d::Zero();
    double weight = 0;
    for (const auto& p : points_) {
      if (!counts(p.position) || direction.dot(p.position) < furthest - kTipReach) continue;
      sum += p.area * p.position;
      weight += p.area;
    }
    if (weight == 0) return Vector3d::Zero();
    const Vector3d mean = sum / weight;
    return mean + (furthest - direction.dot(mean)) * direction;
  }

  void spinous() {
    // Bifid processes end beside the mid-plane.
    const auto counts = [&](const Vector3d& p) {
      return p.x() < arch_front_ && std::abs(p.y()) < 0.5 * out_.canal_width;
    };
    const double declination = prior_.vertebra.spinous_declination;
    Vector3d along(-std::cos(declination), 0, -std::sin(declination));
    for (int pass = 0; pass < 4; pass++) {
      out_.spinous_tip = tip(along, counts);
      out_.spinous_tip.y() = 0;
      along = out_.spinous_tip.normalized();
    }
  }

  void transverse() {
    for (int side : {0, 1}) {
      const Vector3d out = side ? -Vector3d::UnitY() : Vector3d(Vector3d::UnitY());
      out_.transverse_tip[side] = tip(out, [&](const Vector3d& p) {
        return p.x() < 0.35 * back_ && out.dot(p) > 0.4 * out_.canal_width;
      });
    }
  }

  // A place of the prior on this vertebra: lengths in proportion, part by part.
  Vector3d placed(const Vector3d& p) const {
    const Vertebra& v = prior_.vertebra;
    const double back = -(v.upper_endplate_depth + v.lower_endplate_depth) / 4;
    const double height = (v.body_height_anterior + v.body_height_posterior) / 2;
    const double side = std::sqrt(out_.canal_width / v.canal_width *
                                  (out_.upper_endplate.width + out_.lower_endplate.width) /
                                  (v.upper_endplate_width + v.lower_endplate_width));
    return {p.x() < back ? back_ + (p.x() - back) * out_.canal_depth / v.canal_depth
                         : back_ * p.x() / back,
            side * p.y(), p.z() * height_ / height};
  }

  Landmark face(bool superior, int side) const {
    const Landmark& p = superior ? prior_.superior_face : prior_.inferior_face;
    const double sign = side ? -1 : 1;
    const auto sided = [&](const Vector3d& v) { return Vector3d(v.x(), sign * v.y(), v.z()); };
    const Vector3d expected = sided(p.normal);
    Vector3d start = placed(p.centre);
    const double scale =
        std::sqrt(out_.canal_width / prior_.vertebra.canal_width * height_ * 2 /
                  (prior_.vertebra.body_height_anterior + prior_.vertebra.body_height_posterior));
    const double width = scale * p.width, height = scale * p.height;
    // The process ends half a face beyond the face's middle.
    const Vector3d up = upAlong(p.normal);
    const double end = tipHeight(superior, start.y());
    if (std::isfinite(end)) {
      const double wanted = end - (superior ? 0.5 : -0.5) * height * up.z();
      start.z() += std::clamp(wanted - start.z(), -0.5 * height, 0.5 * height);
    }
    start = sided(start);

    // Coarse or odd bones may show no such face close by: then look further around.
    for (double reach : {0.55 * height, 1.1 * height}) {
      Vector3d centre = start, normal = expected;
      if (search(start, expected, reach, 0.03 * width * height, &centre, &normal)) {
        return measured(centre, normal, width, height, start);
      }
    }
    throw std::runtime_error(std::string("no ") + (superior ? "superior" : "inferior") +
                             " articular face where one should be; give the landmark " +
                             (side ? "right_" : "left_") +
                             (superior ? "superior_face" : "inferior_face"));
  }

  // Moves centre and normal to the middle of what looks about the same way; false if that is less
  // than an area.
  bool search(const Vector3d& start, const Vector3d& expected, double reach, double area,
              Vector3d* centre, Vector3d* normal) const {
    double weight = 0;
    for (int pass = 0; pass < 12; pass++) {
      Vector3d sum = Vector3d::Zero(), normals = Vector3d::Zero();
      weight = 0;
      for (const auto& q : points_) {
        const double along = q.normal.dot(*normal), known = q.normal.dot(expected);
        if (along < 0.5 || known < 0.4) continue;
        // Close to the face's middle, but not forever away from where it should be.
        const double d2 = (q.position - *centre).squaredNorm() / (reach * reach) +
                          0.3 * (q.position - start).squaredNorm() / (reach * reach);
        const double w = q.area * along * along * std::exp(-d2);
        weight += w;
        sum += w * q.position;
        normals += w * q.normal;
      }
      if (weight < area) return false;
      *centre = sum / weight;
      *normal = normals.normalized();
    }
    return true;
  }

  // Plane and extent of the face about a place on it. The plane is that of its middle, clear of the
  // rounded edge.
  // How high it lies, the end of its process has told: by `start`.
  Landmark measured(const Vector3d& place, const Vector3d& direction, double width, double height,
                    const Vector3d& start) const {
    constexpr double kSlide = 0.12;  // of the height, up or down from there
    Landmark l;
    l.centre = place;
    l.normal = direction;
    Vector2d spread = Vector2d::Zero();
    double area = 0;
    for (int pass = 0; pass < 6; pass++) {
      const Vector3d up = upAlong(l.normal), across = up.cross(l.normal);
      Vector3d sum = Vector3d::Zero(), normals = Vector3d::Zero();
      double inner_area = 0;
      spread.setZero();
      area = 0;
      for (const auto& q : points_) {
        const Vector3d r = q.position - l.centre;
        const double x = r.dot(across) / width, y = r.dot(up) / height;
        if (q.normal.dot(l.normal) < 0.75 || std::abs(r.dot(l.normal)) > 2.5e-3) continue;
        const double out = std::hypot(x, y);
        if (out > 0.55) continue;
        area += q.area;
        spread += q.area * Vector2d(r.dot(across), r.dot(up)).cwiseAbs2();
        sum += q.area * q.position;
        if (out > 0.4) continue;
        inner_area += q.area;
        normals += q.area * q.normal;
      }
      if (inner_area == 0) return {place, direction, width, height};
      l.centre = sum / area;
      const double slide = (l.centre - start).dot(up);
      l.centre -= (slide - std::clamp(slide, -kSlide * height, kSlide * height)) * up;
      l.normal = normals.normalized();
    }
    // An even ellipse spreads by a quarter of its axes.
    l.width = std::clamp(4 * std::sqrt(spread.x() / area), 0.5 * width, 1.5 * width);
    l.height = std::clamp(4 * std::sqrt(spread.y() / area), 0.5 * height, 1.5 * height);
    return l;
  }

  // Upwards along a face; backwards along a level one.
  static Vector3d upAlong(const Vector3d& normal) {
    Vector3d up = Vector3d::UnitZ() - normal.z() * normal;
    if (up.norm() < 0.1) up = -Vector3d::UnitX() + normal.x() * normal;
    return up.normalized();
  }

  // Upper (lower) end of the superior (inferior) articular processes, both sides together.
  double tipHeight(bool superior, double y) const {
    const double sign = superior ? 1 : -1;
    double end = -std::numeric_limits<double>::infinity();
    for (const auto& p : points_) {
      const Vector3d& q = p.position;
      const double side = std::abs(q.y());
      if (q.x() > back_ - 0.25 * out_.canal_depth || q.x() < arch_front_ - 0.012) continue;
      if (side < std::max(0.004, y - 0.008) || side > y + 0.008) continue;
      end = std::max(end, sign * q.z());
    }
    return sign * end;
  }

  const TriMesh& mesh_;
  const VertebraPrior& prior_;
  std::vector<SurfacePoint> points_;
  VertebraLandmarks out_;
  MidSection section_;
  double front_ = 0, back_ = 0, height_ = 0;  // of the body [m]
  double arch_front_ = 0;                     // of the arch's cut
};

Landmark moved(const Landmark& l, const Isometry3d& X) {
  return {X * l.centre, X.linear() * l.normal, l.width, l.height};
}

// Frame from endplates and spinous tip that a person gave.
Isometry3d givenFrame(const GivenLandmarks& given) {
  const Landmark &upper = given.at("upper_endplate"), &lower = given.at("lower_endplate");
  const Vector3d up = upper.normal.norm() > 0 && lower.normal.norm() > 0
                          ? (upper.normal.normalized() - lower.normal.normalized()).eval()
                          : (upper.centre - lower.centre).eval();
  Isometry3d X = Isometry3d::Identity();
  X.translation() = (upper.centre + lower.centre) / 2;
  const Vector3d z = up.normalized();
  Vector3d x = X.translation() - given.at("spinous_tip").centre;
  x = (x - x.dot(z) * z).normalized();
  X.linear() << x, z.cross(x), z;
  return X;
}

// Of the body, from its endplates in the vertebra's axes.
void heightsBetween(VertebraLandmarks* l) {
  const Landmark &upper = l->upper_endplate, &lower = l->lower_endplate;
  const auto heightAt = [](const Landmark& plate, double x) {
    return plate.centre.z() - plate.normal.x() / plate.normal.z() * (x - plate.centre.x());
  };
  const double middle = (upper.centre.x() + lower.centre.x()) / 2;
  const double half = (upper.height + lower.height) / 4;
  l->body_height_anterior = heightAt(upper, middle + half) - heightAt(lower, middle + half);
  l->body_height_posterior = heightAt(upper, middle - half) - heightAt(lower, middle - half);
}

bool gives(const GivenLandmarks& given, const char* name) { return given.count(name) > 0; }

}  // namespace

const std::vector<std::string>& landmarkNames() {
  static const std::vector<std::string> kNames = {
      "upper_endplate",      "lower_endplate",       "spinous_tip",
      "left_transverse_tip", "right_transverse_tip", "left_superior_face",
      "right_superior_face", "left_inferior_face",   "right_inferior_face"};
  return kNames;
}

VertebraPrior vertebraPrior(const Anatomy& anatomy, const std::string& level) {
  VertebraPrior prior;
  prior.vertebra = anatomy.vertebra(level);
  std::string below = "S1";
  for (const Vertebra& v : anatomy.vertebrae) {
    if (v.name == level) break;
    below = v.name;
  }
  const auto faceOf = [&](const std::string& bone) {
    for (const ArticularFacet& f : anatomy.facets) {
      if (f.level == bone) return Landmark{f.position, f.normal, f.width, f.height};
    }
    throw std::runtime_error("anatomy: facets.csv has no row for " + bone);
  };
  prior.superior_face = faceOf(level);
  Landmark opposite = faceOf(below);
  opposite.centre += kJointGap * opposite.normal;
  opposite.normal = -opposite.normal;
  prior.inferior_face =
      moved(opposite, anatomy.boneFrame(level).inverse() * anatomy.boneFrame(below));
  return prior;
}

VertebraLandmarks findLandmarks(const TriMesh& mesh, const VertebraPrior& prior,
                                const GivenLandmarks& given, const std::optional<Vector3d>& up) {
  Isometry3d X;
  double certainty = 1;
  if (gives(given, "upper_endplate") && gives(given, "lower_endplate") &&
      gives(given, "spinous_tip")) {
    X = givenFrame(given);
  } else {
    try {
      const VertebraPose pose = vertebraPose(mesh, up);
      X = pose.frame;
      certainty = pose.up_certainty;
    } catch (const std::runtime_error& e) {
      throw std::runtime_error(std::string(e.what()) +
                               "; if this is a whole vertebra, give the landmarks upper_endplate, "
                               "lower_endplate and spinous_tip");
    }
  }
  const TriMesh local = transformed(mesh, X.inverse());
  VertebraLandmarks out = Finder(local, prior).run();
  out.up_certainty = certainty;

  // What was given, in the vertebra's axes, goes over what was found.
  const auto take = [&](const char* name, Landmark* l) {
    const auto it = given.find(name);
    if (it == given.end()) return;
    const Landmark g = moved(it->second, X.inverse());
    l->centre = g.centre;
    if (g.normal.norm() > 0) l->normal = g.normal.normalized();
    if (g.width > 0) l->width = g.width;
    if (g.height > 0) l->height = g.height;
  };
  const auto takePoint = [&](const char* name, Vector3d* p) {
    if (gives(given, name)) *p = X.inverse() * given.at(name).centre;
  };
  take("upper_endplate", &out.upper_endplate);
  take("lower_endplate", &out.lower_endplate);
  if (gives(given, "upper_endplate") || gives(given, "lower_endplate")) heightsBetween(&out);
  takePoint("spinous_tip", &out.spinous_tip);
  takePoint("left_transverse_tip", &out.transverse_tip[0]);
  takePoint("right_transverse_tip", &out.transverse_tip[1]);
  take("left_superior_face", &out.superior_face[0]);
  take("right_superior_face", &out.superior_face[1]);
  take("left_inferior_face", &out.inferior_face[0]);
  take("right_inferior_face", &out.inferior_face[1]);

  out.frame = X;
  for (Landmark* l : {&out.upper_endplate, &out.lower_endplate, &out.superior_face[0],
                      &out.superior_face[1], &out.inferior_face[0], &out.inferior_face[1]}) {
    *l = moved(*l, X);
  }
  for (Vector3d* p : {&out.spinous_tip, &out.transverse_tip[0], &out.transverse_tip[1]}) {
    *p = X * *p;
  }
  return out;
}

}  // namespace torso
