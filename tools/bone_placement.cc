// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/bone_placement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/body.h"
#include "model/bone_mesh.h"
#include "model/bone_registration.h"
#include "model/mesh_repair.h"
#include "model/mesh_section.h"
#include "model/tri_mesh.h"
#include "tools/error.h"

namespace torso::tools {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// A bone that fits so much better mirrored is of the other side.
constexpr double kMirrored = 0.8;

struct Placed {
  TriMesh mesh;  // [m], file axes
  Matrix3d rotation;
  Vector3d anchor;  // of the body, in the mesh
  double ratio;     // size over the generated bone
  double misfit;
};

TriMesh mirroredAcross(TriMesh mesh, const Vector3d& normal, double offset) {
  for (Vector3d& v : mesh.vertices) v -= 2 * (normal.dot(v) - offset) * normal;
  for (auto& f : mesh.faces) std::swap(f[1], f[2]);
  return mesh;
}

class Placer {
 public:
  Placer(const std::vector<BonePiece>& pieces, const std::optional<Matrix3d>& axes,
         Anatomy* anatomy, std::vector<std::string>* remarks)
      : pieces_(pieces), axes_(axes), a_(*anatomy), remarks_(*remarks) {}

  // From the trunk outwards.
  void run(std::map<std::string, TriMesh>* meshes) {
    placePelvis();
    placeRibcage();
    placeHead();
    for (const char* name :
         {"clavicle", "scapula", "upper_arm", "lower_arm", "hand", "thigh", "shin", "foot"}) {
      placePair(name);
    }
    for (const auto& [body, placed] : placed_) {
      const auto [side, name] = splitSide(body);
      Vector3d to = bodyAnchor(a_, name);
      if (side == Side::kRight) to = mirror(to);
      TriMesh mesh = placed.mesh;
      for (Vector3d& v : mesh.vertices) v = placed.rotation * (v - placed.anchor) + to;
      if (body == "head") append(mesh, splitHead().neck);
      (*meshes)[body] = mesh;
    }
  }

 private:
  void say(const std::string& remark) { remarks_.push_back(remark); }

  std::vector<const BonePiece*> piecesOf(const std::string& body) const {
    std::vector<const BonePiece*> out;
    for (const BonePiece& piece : pieces_) {
      if (piece.body == body) out.push_back(&piece);
    }
    return out;
  }

  Placed place(const TriMesh& mesh, const TriMesh& reference, const Vector3d& anchor,
               const std::string& where, const std::string& body) const {
    const auto starts = axes_ ? std::vector<Matrix3d>{*axes_} : axisTurns();
    const Registration r = registerBone(mesh, reference, starts);
    const double ratio = 1 / r.scale;
    if (ratio > kLargestRatio || ratio < 1 / kLargestRatio) {
      throw Error(
          fmt::format("{}: {} is {:.3g} times as large as it should be; check --unit, or "
                      "name the bone with --map",
                      where, body, ratio));
    }
    const Vector3d at = ratio * (r.rotation.transpose() * (anchor - r.translation));
    return {mesh, r.rotation, at, ratio, r.misfit};
  }

  void take(const std::string& body, const Placed& p) {
    say(
        fmt::format("{}: laid over the generated bone: {:.2f} times as large, surfaces {:.0f} % of "
                    "its size apart",
                    body, p.ratio, 100 * p.misfit));
    placed_[body] = p;
  }

  void placeMiddle(const std::string& body, const TriMesh& mesh, const TriMesh& reference) {
    const std::string where = piecesOf(body).front()->where;
    take(body, place(mesh, reference, bodyAnchor(a_, body), where, body));
    resizeBody(body, placed_[body].ratio, &a_);
  }

  void placePelvis() {
    const auto pieces = piecesOf("pelvis");
    if (pieces.empty()) return;
    TriMesh mesh, middle;
    std::vector<const BonePiece*> hips;
    for (const BonePiece* piece : pieces) {
      append(mesh, piece->mesh);
      if (piece->side.empty()) {
        append(middle, piece->mesh);
      } else {
        hips.push_back(piece);
      }
    }
    const TriMesh reference = boneOnly(a_, "pelvis");
    const double size = bounds(mesh).diagonal().norm() / bounds(reference).diagonal().norm();
    if (hips.empty() && size < 0.7) {
      say(pieces.front()->where + ": a sacrum without hip bones; the generated pelvis is kept");
      return;
    }
    const bool one_side = std::all_of(hips.begin(), hips.end(), [&](const BonePiece* hip) {
      return hip->side == hips.front()->side;
    });
    if (!hips.empty() && one_side) {
      if (!axes_) {
        throw Error(hips.front()->where +
                    ": one hip bone only, and nothing tells which way it "
                    "looks; give --axes, or the other one");
      }
      // The other is its mirror image, in the middle of the sacrum or at the symphysis.
      const Vector3d left = axes_->transpose() * Vector3d::UnitY();
      const double sign = hips.front()->side == "left" ? 1 : -1;
      double plane = std::numeric_limits<double>::infinity();
      for (const BonePiece* hip : hips) {
        for (const Vector3d& v : hip->mesh.vertices) plane = std::min(plane, sign * left.dot(v));
      }
      plane *= sign;
      if (!middle.vertices.empty()) plane = left.dot(bounds(middle).center());
      for (const BonePiece* hip : hips) append(mesh, mirroredAcross(hip->mesh, left, plane));
      say(hips.front()->where + ": one hip bone only; the other is its mirror image");
    }
    placeMiddle("pelvis", mesh, reference);
    moveToEndplate();
  }

  // The pelvis hangs on the S1 endplate: the uppermost surface that looks along the sacral slope,
  // near where the registration puts it.
  void moveToEndplate() {
    constexpr double kRadius = 0.022, kReach = 0.035, kThickness = 0.005;  // [m]
    Placed& p = placed_.at("pelvis");
    const Vector3d normal = a_.boneFrame("S1").linear().col(2);
    struct Spot {
      Vector3d position;
      double height, area;
    };
    std::vector<Spot> spots;
    for (const SurfacePoint& q : surfacePoints(p.mesh, 2e-3)) {
      const Vector3d r = p.rotation * (q.position - p.anchor);
      const double height = normal.dot(r);
      if (normal.dot(p.rotation * q.normal) < 0.75 || std::abs(height) > kReach) continue;
      if ((r - height * normal).norm() < kRadius * a_.length_scale) {
        spots.push_back({r, height, q.area});
      }
    }
    double total = 0, sum = 0;
    for (const Spot& s : spots) total += s.area;
    if (total < 1e-4) return;  // a square centimetre
    std::sort(spots.begin(), spots.end(),
              [](const Spot& a, const Spot& b) { return a.height > b.height; });
    double top = spots.front().height;
    for (const Spot& s : spots) {
      sum += s.area;
      top = s.height;
      if (sum > 0.2 * total) break;
    }
    Vector3d centre = Vector3d::Zero();
    double weight = 0;
    for (const Spot& s : spots) {
      if (std::abs(s.height - top) > kThickness) continue;
      centre += s.area * s.position;
      weight += s.area;
    }
    centre /= weight;
    centre.y() = 0;
    p.anchor += p.rotation.transpose() * centre;
  }

  void placeRibcage() {
    const auto pieces = piecesOf("ribcage");
    if (pieces.empty()) return;
    TriMesh mesh;
    for (const BonePiece* piece : pieces) append(mesh, piece->mesh);
    // Scans show ribs with their cartilage, as often as not.
    TriMesh reference;
    for (const BonePart& part : boneMesh(a_, "ribcage")) append(reference, part.mesh);
    placeMiddle("ribcage", mesh, reference);
  }

  struct Head {
    TriMesh skull, neck;
  };
  // The generated head; its small parts low down are C1 and C2.
  Head splitHead() const {
    Head out;
    const Vector3d pivot = a_.landmark("head_pivot");
    for (const TriMesh& part : connectedParts(boneOnly(a_, "head"))) {
      const Eigen::AlignedBox3d box = bounds(part);
      const bool neck = box.center().z() < pivot.z() + 0.055 * a_.length_scale &&
                        box.center().x() < pivot.x() + 0.02 * a_.length_scale;
      append(neck ? out.neck : out.skull, part);
    }
    return out;
  }

  void placeHead() {
    const auto pieces = piecesOf("head");
    if (pieces.empty()) return;
    TriMesh mesh;
    for (const BonePiece* piece : pieces) append(mesh, piece->mesh);
    placeMiddle("head", mesh, splitHead().skull);
  }

  // Of one side or of both; a missing one is the mirror image of the other.
  void placePair(const std::string& name) {
    std::map<std::string, Placed> found;
    for (const std::string side : {"left", "right", ""}) {
      const std::string body = side.empty() ? name : side + "_" + name;
      const auto pieces = piecesOf(body);
      if (pieces.empty()) continue;
      TriMesh mesh;
      for (const BonePiece* piece : pieces) append(mesh, piece->mesh);
      const std::string& where = pieces.front()->where;
      const Vector3d anchor = bodyAnchor(a_, name);
      const TriMesh left = boneOnly(a_, "left_" + name);
      const Placed as_left = place(mesh, left, anchor, where, body);
      const Placed as_right = place(mesh, mirrored(left), mirror(anchor), where, body);
      const bool is_right = as_right.misfit < as_left.misfit;
      if (side.empty()) {
        const char* guess = is_right ? "right" : "left";
        say(
            fmt::format("{}: its name tells no side; by its shape it is the {} one (surfaces "
                        "{:.0f} % apart, {:.0f} % as the other)",
                        where, guess, 100 * std::min(as_left.misfit, as_right.misfit),
                        100 * std::max(as_left.misfit, as_right.misfit)));
        found[guess] = is_right ? as_right : as_left;
        continue;
      }
      const Placed &as_named = side == "right" ? as_right : as_left,
                   &as_other = side == "right" ? as_left : as_right;
      if (as_other.misfit < kMirrored * as_named.misfit) {
        throw Error(
            fmt::format("{}: has the shape of the other side's {}: it is mirrored, or its "
                        "name says the wrong side; mirror it back (or give left-handed "
                        "--axes), or name it with --map",
                        where, name));
      }
      found[side] = as_named;
    }
    if (found.empty()) return;
    double ratio = 1;
    for (const auto& [side, p] : found) {
      take(side + "_" + name, p);
      ratio *= std::pow(p.ratio, 1.0 / static_cast<double>(found.size()));
    }
    resizeBody(name, ratio, &a_);
    if (found.size() > 1) return;
    const auto& [side, p] = *found.begin();
    const std::string other = side == "left" ? "right" : "left";
    Placed q = p;
    for (Vector3d& v : q.mesh.vertices) v = p.rotation * (v - p.anchor);
    q.mesh = mirroredAcross(q.mesh, Vector3d::UnitY(), 0);
    q.rotation = Matrix3d::Identity();
    q.anchor = Vector3d::Zero();
    placed_[other + "_" + name] = q;
    say(fmt::format("{}_{}: mirror image of the {} one", other, name, side));
  }

  const std::vector<BonePiece>& pieces_;
  const std::optional<Matrix3d>& axes_;
  Anatomy& a_;
  std::vector<std::string>& remarks_;
  std::map<std::string, Placed> placed_;
};

}  // namespace

TriMesh boneOnly(const Anatomy& anatomy, const std::string& body) {
  for (const BonePart& part : boneMesh(anatomy, body)) {
    if (part.tissue == Tissue::kBone) return part.mesh;
  }
  return {};
}

void placeBones(const std::vector<BonePiece>& pieces, const std::optional<Matrix3d>& axes,
                Anatomy* anatomy, std::map<std::string, TriMesh>* meshes,
                std::vector<std::string>* remarks) {
  Placer(pieces, axes, anatomy, remarks).run(meshes);
}

}  // namespace torso::tools
