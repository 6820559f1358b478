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
#include "model/median.h"
#include "model/mesh_repair.h"
#include "model/spine_fit.h"
#include "tools/bone_pieces.h"
#include "tools/bone_placement.h"
#include "tools/error.h"
#include "tools/landmark_file.h"

namespace torso::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Unit {
  const char* name;
  double metres;
};
constexpr Unit kUnits[] = {{"m", 1}, {"cm", 1e-2}, {"mm", 1e-3}};

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
    std::vector<BonePiece> others;
    for (const BonePiece& piece : pieces_) {
      if (isVertebra(piece.body)) continue;
      others.push_back(piece);
      others.back().mesh = inMetres(piece.mesh);
    }
    placeBones(others, file_axes_, &fit.anatomy, &out_.own.meshes, &out_.remarks);
    out_.anatomy = fit.anatomy;
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
      if (r < kLargestRatio && r > 1 / kLargestRatio) continue;
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
};

}  // namespace

ImportedTorso importBones(const Anatomy& tables, const ImportOptions& options) {
  return Importer(tables, options).run();
}

}  // namespace torso::tools
