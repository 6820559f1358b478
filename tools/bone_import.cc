// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/bone_import.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "model/body.h"
#include "model/bone_mesh.h"
#include "model/bone_registration.h"
#include "model/mesh_repair.h"
#include "model/spine_fit.h"
#include "tools/bone_pieces.h"
#include "tools/error.h"
#include "tools/landmark_file.h"

namespace torso::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// A bone this many times as large or small as the tables' is in the wrong unit, or another bone.
constexpr double kLargest = 1.75;
// A shoulder bone that fits so much better mirrored is of the other side.
constexpr double kMirrored = 0.8;

struct Unit {
  const char* name;
  double metres;
};
constexpr Unit kUnits[] = {{"m", 1}, {"cm", 1e-2}, {"mm", 1e-3}};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

TriMesh boneOnly(const Anatomy& a, const std::string& body) {
  for (const BonePart& part : boneMesh(a, body)) {
    if (part.tissue == Tissue::kBone) return part.mesh;
  }
  return {};
}

class Importer {
 public:
  Importer(const Anatomy& tables, const ImportOptions& options) : tables_(tables), o_(options) {}

  ImportedTorso run() {
    if (!o_.axes.empty()) axes_ = axesMatrix(o_.axes);
    if (!o_.landmarks.empty()) given_ = readLandmarkFile(o_.landmarks);
    pieces_ = readBonePieces(o_.folder, o_.map, axes_, &out_.remarks);
    for (const BonePiece& piece : pieces_) {
      if (isVertebra(piece.body)) (levels_[piece.body] = &piece);
    }
    checkTwice();
    findUnit();
    findVertebrae();
    guessAxes();
    Anatomy sized = sizedTables();
    SpineFit fit = fitSpine(sized, found_);
    out_.remarks.insert(out_.remarks.end(), fit.remarks.begin(), fit.remarks.end());
    if (found_.size() > 1) {
      say(fit.common_frame
              ? "vertebrae lie in the files as in a spine: their places to each other were used"
              : "vertebrae do not lie in the files as in a spine: set upon each other along the "
                "standing spine, with discs of the tables' height");
    }
    out_.anatomy = fit.anatomy;
    placeOthers();
    fit.anatomy = out_.anatomy;
    std::map<std::string, TriMesh> vertebrae;
    for (const auto& [level, X] : fit.placement) {
      vertebrae[level] = transformed(meshes_.at(level), X);
    }
    out_.own.facets = fittedFacets(fit, found_, vertebrae);
    out_.own.ligaments = fittedLigaments(fit, found_, vertebrae);
    out_.own.meshes.insert(vertebrae.begin(), vertebrae.end());
    for (const auto& [body, mesh] : out_.own.meshes) out_.imported.push_back(body);
    return out_;
  }

 private:
  void say(const std::string& remark) { out_.remarks.push_back(remark); }

  bool isVertebra(const std::string& body) const {
    for (const Vertebra& v : tables_.vertebrae) {
      if (v.name == body) return true;
    }
    return false;
  }

  void checkTwice() const {
    std::map<std::string, std::string> seen;
    for (const BonePiece& piece : pieces_) {
      // Pelvis and head may come in parts.
      if (piece.body == "pelvis" || piece.body == "head" || piece.body == "ribcage") continue;
      if (piece.body.find("_arm") != std::string::npos ||
          piece.body.find("shin") != std::string::npos) {
        continue;
      }
      const auto [it, fresh] = seen.insert({piece.body, piece.where});
      if (!fresh) {
        throw Error(fmt::format("{}: is {}, as is {}; leave one out, or say with --map what it is",
                                piece.where, piece.body, it->second));
      }
    }
  }

  // Diagonal of the bounding box of a vertebra of the tables, in its own axes.
  static double vertebraSize(const Vertebra& v) {
    const double depth =
        v.spinous_tip_distance * std::cos(v.spinous_declination) + v.upper_endplate_depth / 2;
    const double below = std::max(0.8 * v.body_height_anterior,
                                  v.spinous_tip_distance * std::sin(v.spinous_declination));
    return Vector3d(depth, v.transverse_process_span, below + 0.8 * v.body_height_anterior).norm();
  }

  // Size of a piece over that of the tables' bone, as if the file were in metres; 0 if a piece of a
  // bone that is more.
  double sizeRatio(const BonePiece& piece) {
    const double size = bounds(piece.mesh).diagonal().norm();
    if (isVertebra(piece.body)) return size / vertebraSize(tables_.vertebra(piece.body));
    if (piece.body == "pelvis" || piece.body == "head" || piece.body == "lower_arm" ||
        piece.body == "shin") {
      return 0;
    }
    const bool sided = splitSide(piece.body).first != Side::kMiddle;
    const std::string body = sided || piece.body == "ribcage" ? piece.body : "left_" + piece.body;
    return size / bounds(reference(body)).diagonal().norm();
  }

  const TriMesh& reference(const std::string& body) {
    auto it = references_.find(body);
    if (it == references_.end()) it = references_.emplace(body, boneOnly(tables_, body)).first;
    return it->second;
  }

  void findUnit() {
    std::vector<std::pair<double, const BonePiece*>> ratios;
    for (const BonePiece& piece : pieces_) {
      const double ratio = sizeRatio(piece);
      if (ratio > 0) ratios.push_back({ratio, &piece});
    }
    const Unit* unit = nullptr;
    if (!o_.unit.empty()) {
      for (const Unit& u : kUnits) {
        if (o_.unit == u.name) unit = &u;
      }
      if (!unit) throw Error("--unit " + o_.unit + ": must be mm, cm or m");
    } else {
      std::vector<double> all;
      for (const auto& [ratio, piece] : ratios) all.push_back(ratio);
      const double middle = all.empty() ? 1 : median(all);
      for (const Unit& u : kUnits) {
        if (!unit ||
            std::abs(std::log(middle * u.metres)) < std::abs(std::log(middle * unit->metres))) {
          unit = &u;
        }
      }
      say(fmt::format("unit: {} (guessed: bones are {:.2f} times as large as the tables'{})",
                      unit->name, middle * unit->metres,
                      all.size() < 2 ? "; a single bone to go by" : ""));
    }
    metres_ = unit->metres;
    for (const auto& [ratio, piece] : ratios) {
      const double r = ratio * metres_;
      if (r < kLargest && r > 1 / kLargest) continue;
      throw Error(fmt::format(
          "{}: {} would be {:.4g} m from end to end in {}, {:.3g} times the tables'; give the "
          "right --unit, or scale the file, or name the bone with --map",
          piece->where, piece->body, bounds(piece->mesh).diagonal().norm() * metres_, unit->name,
          r));
    }
  }

  TriMesh inMetres(const TriMesh& mesh) const {
    TriMesh out = mesh;
    for (Vector3d& v : out.vertices) v *= metres_;
    return out;
  }

  GivenLandmarks givenFor(const std::string& level) {
    const auto it = given_.find(level);
    if (it == given_.end()) return {};
    GivenLandmarks out = it->second;
    const Matrix3d M = axes_ ? *axes_ : Matrix3d::Identity();
    for (auto& [name, l] : out) {
      l = {metres_ * (M * l.centre), M * l.normal, metres_ * l.width, metres_ * l.height};
    }
    return out;
  }

  void findVertebrae() {
    for (const auto& [level, landmarks] : given_) {
      if (!levels_.count(level)) {
        throw Error(fmt::format("{}: {}: there is no mesh of this level in {}", o_.landmarks, level,
                                o_.folder));
      }
    }
    for (const auto& [level, piece] : levels_) {
      meshes_[level] = inMetres(piece->mesh);
      findOne(level, axes_ ? std::optional<Vector3d>(Vector3d::UnitZ()) : std::nullopt);
    }
    if (axes_) return;
    // A vertebra that stands on its head among others that do not was mistaken.
    Vector3d up = Vector3d::Zero();
    for (const auto& [level, l] : found_) up += l.up_certainty * l.frame.linear().col(2);
    if (up.norm() < 0.7 * static_cast<double>(found_.size())) up.setZero();
    for (const auto& [level, piece] : levels_) {
      if (up.dot(found_.at(level).frame.linear().col(2)) < 0) findOne(level, up);
    }
  }

  void findOne(const std::string& level, const std::optional<Vector3d>& up) {
    const BonePiece& piece = *levels_.at(level);
    try {
      const VertebraPrior prior = vertebraPrior(tables_, level);
      found_[level] = findLandmarks(meshes_.at(level), prior, givenFor(level), up);
    } catch (const std::exception& e) {
      throw Error(fmt::format("{}: {}: {} (--landmarks)", piece.where, level, e.what()));
    }
  }

  // Nearest matrix of 0, 1 and -1 that turns file axes into standing axes.
  void guessAxes() {
    if (axes_) {
      file_axes_ = Matrix3d::Identity();  // the meshes have been turned
      return;
    }
    std::map<std::string, int> votes;
    for (const auto& [level, l] : found_) {
      const Matrix3d R = l.frame.linear().transpose();
      Matrix3d best = Matrix3d::Identity();
      double most = -4;
      for (const Matrix3d& turn : axisTurns()) {
        const double agreement = turn.cwiseProduct(R).sum();
        if (agreement > most) {
          most = agreement;
          best = turn;
        }
      }
      votes[axesLetters(best)]++;
    }
    if (votes.empty()) return;
    const auto most = std::max_element(votes.begin(), votes.end(),
                                       [](auto& a, auto& b) { return a.second < b.second; });
    if (3 * most->second < 2 * static_cast<int>(found_.size())) {
      say("axes: the vertebrae are each turned their own way");
      return;
    }
    file_axes_ = axesMatrix(most->first);
    double certainty = 1;
    for (const auto& [level, l] : found_) certainty = std::min(certainty, l.up_certainty);
    say(fmt::format(
        "axes: {} (guessed from {} of {} vertebrae; how sure which end is up: {:.0f} %)",
        most->first, most->second, found_.size(), 100 * certainty));
  }

  // Tables at the person's size: the middle one of the sizes of the spine and of each other bone.
  Anatomy sizedTables() {
    std::vector<double> sizes;
    if (!found_.empty()) sizes.push_back(spineScale(tables_, found_));
    for (const BonePiece& piece : pieces_) {
      const double ratio = isVertebra(piece.body) ? 0 : metres_ * sizeRatio(piece);
      if (ratio > 0) sizes.push_back(ratio);
    }
    const double guessed = sizes.empty() ? 1 : median(sizes);
    const double length = o_.stature > 0 ? o_.stature / tables_.stature() : guessed;
    const double mass = o_.mass > 0 ? o_.mass / tables_.mass() : length * length;
    if (!(length > 0.5 && length < 2 && mass > 0.2 && mass < 5)) {
      throw Error(fmt::format("--stature, --mass: a body of {:.3g} m and {:.3g} kg is out of range",
                              length * tables_.stature(), mass * tables_.mass()));
    }
    return tables_.scaled(length, mass);
  }

  // Bones that are no vertebrae, from the trunk outwards.
  void placeOthers() {
    for (const char* name : {"pelvis", "ribcage", "head"}) placeMiddle(name);
    for (const char* name :
         {"clavicle", "scapula", "upper_arm", "lower_arm", "hand", "thigh", "shin", "foot"}) {
      placePair(name);
    }
    for (const auto& [body, placed] : placed_) {
      const auto [side, name] = splitSide(body);
      Vector3d to = bodyAnchor(out_.anatomy, name);
      if (side == Side::kRight) to = mirror(to);
      TriMesh mesh = placed.mesh;
      for (Vector3d& v : mesh.vertices) v = placed.rotation * (v - placed.anchor) + to;
      out_.own.meshes[body] = mesh;
    }
  }

  struct Placed {
    TriMesh mesh;  // [m], file axes
    Matrix3d rotation;
    Vector3d anchor;  // of the body, in the mesh
    double ratio;     // size over the generated bone
    double misfit;
  };

  std::vector<Matrix3d> starts() const {
    return file_axes_ ? std::vector<Matrix3d>{*file_axes_} : axisTurns();
  }

  Placed place(const TriMesh& mesh, const TriMesh& reference, const Vector3d& anchor,
               const std::string& where, const std::string& body) const {
    const Registration r = registerBone(mesh, reference, starts());
    const Vector3d at = r.rotation.transpose() * (anchor - r.translation) / r.scale;
    const double ratio = 1 / r.scale;
    if (ratio > kLargest || ratio < 1 / kLargest) {
      throw Error(
          fmt::format("{}: {} is {:.3g} times as large as it should be; check --unit, or "
                      "name the bone with --map",
                      where, body, ratio));
    }
    return {mesh, r.rotation, at, ratio, r.misfit};
  }

  void report(const std::string& body, const Placed& p) {
    say(
        fmt::format("{}: laid over the generated bone: {:.2f} times as large, surfaces {:.0f} % of "
                    "its size apart",
                    body, p.ratio, 100 * p.misfit));
  }

  void placeMiddle(const std::string& body) {
    TriMesh mesh;
    std::string where, sides;
    bool whole = false;
    for (const BonePiece& piece : pieces_) {
      if (piece.body != body) continue;
      append(mesh, inMetres(piece.mesh));
      where = piece.where;
      sides += piece.side + " ";
      whole = whole || piece.side.empty();
    }
    if (mesh.faces.empty()) return;
    TriMesh ref = boneOnly(out_.anatomy, body);
    if (body == "pelvis") {
      const bool left = sides.find("left") != std::string::npos;
      const bool right = sides.find("right") != std::string::npos;
      if (!left && !right && !pelvisIsWhole(mesh)) {
        say(where + ": a sacrum without hip bones; the generated pelvis is kept");
        return;
      }
      if (left != right) {
        // Half a pelvis: the other half is its mirror image, in the plane of the sacrum.
        mesh = completedPelvis(mesh, where);
      }
    }
    const Placed p = place(mesh, ref, bodyAnchor(out_.anatomy, body), where, body);
    report(body, p);
    resizeBody(body, p.ratio, &out_.anatomy);
    placed_[body] = p;
  }

  // A sacrum alone is as wide as it is tall; a pelvis twice as wide.
  bool pelvisIsWhole(const TriMesh& mesh) const {
    return bounds(mesh).diagonal().norm() > 0.75 * bounds(reference_("pelvis")).diagonal().norm();
  }
  TriMesh reference_(const std::string& body) const { return boneOnly(out_.anatomy, body); }

  TriMesh completedPelvis(const TriMesh&, const std::string& where) {
    TriMesh out;
    // The mid-plane that mirrors the sacrum onto itself: of the axis that points to the side.
    const Matrix3d M = file_axes_ ? *file_axes_ : Matrix3d::Identity();
    const Vector3d out_axis = M.transpose() * Vector3d::UnitY();
    std::optional<double> middle;
    for (const BonePiece& piece : pieces_) {
      if (piece.body == "pelvis" && piece.side.empty()) {
        const Vector3d c = inMetres(piece.mesh).vertices.empty()
                               ? Vector3d::Zero()
                               : (metres_ * bounds(piece.mesh).center()).eval();
        middle = out_axis.dot(c);
      }
    }
    for (const BonePiece& piece : pieces_) {
      if (piece.body != "pelvis") continue;
      const TriMesh m = inMetres(piece.mesh);
      append(out, m);
      if (piece.side.empty()) continue;
      TriMesh other = m;
      // Without a sacrum: the plane at the symphysis, the bone's innermost place.
      double plane = middle.value_or(0);
      if (!middle) {
        plane = out_axis.dot(m.vertices.front());
        const double sign = piece.side == "left" ? 1 : -1;
        for (const Vector3d& v : m.vertices) {
          plane = sign * std::min(sign * plane, sign * out_axis.dot(v));
        }
      }
      for (Vector3d& v : other.vertices) v -= 2 * (out_axis.dot(v) - plane) * out_axis;
      for (auto& f : other.faces) std::swap(f[1], f[2]);
      append(out, other);
      say(where + ": one hip bone only; the other is its mirror image");
    }
    return out;
  }

  // Of one side or of both; a missing one is the mirror image of the other.
  void placePair(const std::string& name) {
    std::map<std::string, Placed> found;
    for (const char* side : {"left", "right", ""}) {
      const std::string body = *side ? std::string(side) + "_" + name : name;
      TriMesh mesh;
      std::string where;
      for (const BonePiece& piece : pieces_) {
        if (piece.body != body) continue;
        append(mesh, inMetres(piece.mesh));
        where = piece.where;
      }
      if (mesh.faces.empty()) continue;
      const Vector3d anchor = bodyAnchor(out_.anatomy, name);
      const TriMesh left = boneOnly(out_.anatomy, "left_" + name), right = mirrored(left);
      const Placed as_left = place(mesh, left, anchor, where, body);
      const Placed as_right = place(mesh, right, mirror(anchor), where, body);
      const bool is_right = as_right.misfit < as_left.misfit;
      if (!*side) {
        const char* guess = is_right ? "right" : "left";
        say(fmt::format(
            "{}: its name tells no side; by its shape it is the {} one (surfaces {:.0f} "
            "% apart, {:.0f} % as the other)",
            where, guess, 100 * std::min(as_left.misfit, as_right.misfit),
            100 * std::max(as_left.misfit, as_right.misfit)));
        found[guess] = is_right ? as_right : as_left;
        continue;
      }
      const bool named_right = std::string(side) == "right";
      const Placed &as_named = named_right ? as_right : as_left,
                   &as_other = named_right ? as_left : as_right;
      if (as_other.misfit < kMirrored * as_named.misfit) {
        throw Error(
            fmt::format("{}: has the shape of the other side's {}; it is mirrored (a "
                        "left-handed system of axes: mirror it back, or give --axes), or "
                        "its name says the wrong side",
                        where, name));
      }
      found[side] = as_named;
    }
    if (found.empty()) return;
    double ratio = 1;
    for (const auto& [side, p] : found) {
      report(side + "_" + name, p);
      ratio *= std::pow(p.ratio, 1.0 / static_cast<double>(found.size()));
    }
    resizeBody(name, ratio, &out_.anatomy);
    for (const auto& [side, p] : found) placed_[side + "_" + name] = p;
    if (found.size() == 1) {
      const auto& [side, p] = *found.begin();
      const std::string other = side == "left" ? "right" : "left";
      // Mirrored in the standing body.
      Placed q = p;
      for (Vector3d& v : q.mesh.vertices) v = mirror(p.rotation * (v - p.anchor));
      for (auto& f : q.mesh.faces) std::swap(f[1], f[2]);
      q.rotation = Matrix3d::Identity();
      q.anchor = Vector3d::Zero();
      placed_[other + "_" + name] = q;
      say(fmt::format("{}_{}: mirror image of the {} one", other, name, side));
    }
  }

  const Anatomy& tables_;
  const ImportOptions& o_;
  ImportedTorso out_;
  std::optional<Matrix3d> axes_;       // given
  std::optional<Matrix3d> file_axes_;  // of the meshes as they are held here
  std::map<std::string, GivenLandmarks> given_;
  std::vector<BonePiece> pieces_;
  std::map<std::string, const BonePiece*> levels_;
  std::map<std::string, TriMesh> references_, meshes_;  // meshes_: of the levels [m]
  double metres_ = 1;                                   // of the file's unit
  SpineLandmarks found_;
  std::map<std::string, Placed> placed_;
};

}  // namespace

ImportedTorso importBones(const Anatomy& tables, const ImportOptions& options) {
  return Importer(tables, options).run();
}

}  // namespace torso::tools
