// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/bone_pieces.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "model/mesh_repair.h"
#include "model/tri_mesh.h"
#include "model/vertebra_frame.h"
#include "tools/bone_names.h"
#include "tools/error.h"
#include "tools/json_file.h"
#include "tools/mesh_file.h"

namespace torso::tools {
namespace {

namespace fs = std::filesystem;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Json = nlohmann::json;

constexpr double kSmallPart = 0.3;  // of the largest part's volume: no vertebra of its own

using Names = std::vector<std::string>;

bool isLevel(const std::string& body) {
  return body.size() > 1 && std::isdigit(static_cast<unsigned char>(body[1]));
}

const std::set<std::string>& knownBodies() {
  static const std::set<std::string> kBodies = [] {
    std::set<std::string> out = {"pelvis", "ribcage", "head", "C2", "spine"};
    for (int i = 1; i <= 5; i++) out.insert("L" + std::to_string(i));
    for (int i = 1; i <= 12; i++) out.insert("T" + std::to_string(i));
    for (int i = 3; i <= 7; i++) out.insert("C" + std::to_string(i));
    for (const char* limb :
         {"clavicle", "scapula", "upper_arm", "lower_arm", "hand", "thigh", "shin", "foot"}) {
      for (const char* side : {"", "left_", "right_"}) out.insert(std::string(side) + limb);
    }
    return out;
  }();
  return kBodies;
}

std::map<std::string, Names> readMap(const std::string& path) {
  std::map<std::string, Names> out;
  if (path.empty()) return out;
  const Json root = readJsonFile(path);
  if (!root.is_object()) throw Error(path + ": must be an object of file names");
  for (const auto& [name, value] : root.items()) {
    Names names;
    for (const Json& item : value.is_array() ? value : Json::array({value})) {
      if (!item.is_string()) {
        throw Error(
            fmt::format("{}: {}: must be the name of a body or a list of names", path, name));
      }
      const std::string body = item.get<std::string>();
      if (!body.empty() && !knownBodies().count(body)) {
        throw Error(
            fmt::format("{}: {}: no body is called '{}'; bodies are L5 .. C3, pelvis, "
                        "ribcage, head, left_scapula, ...",
                        path, name, body));
      }
      if (!body.empty()) names.push_back(body);
    }
    out[name] = names;
  }
  return out;
}

// Vertebrae of one object in their order from below.
std::vector<TriMesh> fromBelow(std::vector<TriMesh> parts, const std::string& where) {
  Vector3d up = Vector3d::Zero();
  std::vector<Vector3d> centres;
  for (const TriMesh& part : parts) {
    try {
      const VertebraPose pose = vertebraPose(part);
      up += pose.up_certainty * pose.frame.linear().col(2);
      centres.push_back(pose.frame.translation());
    } catch (const std::exception& e) {
      throw Error(fmt::format("{}: part with {} faces is no vertebra: {}", where, part.faces.size(),
                              e.what()));
    }
  }
  std::vector<int> order(parts.size());
  for (std::size_t i = 0; i < order.size(); i++) order[i] = static_cast<int>(i);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return up.dot(centres[a]) < up.dot(centres[b]); });
  std::vector<TriMesh> out;
  for (int i : order) out.push_back(parts[i]);
  return out;
}

class PieceReader {
 public:
  PieceReader(const std::string& folder, const std::string& map,
              const std::optional<Matrix3d>& axes, std::vector<std::string>* remarks)
      : folder_(folder), map_path_(map), map_(readMap(map)), axes_(axes), remarks_(*remarks) {}

  std::vector<BonePiece> run() {
    std::error_code error;
    if (!fs::is_directory(folder_, error)) throw Error(folder_ + ": no such folder");
    std::vector<std::string> files;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      if (entry.is_regular_file() && isMeshFile(entry.path().string())) {
        files.push_back(entry.path().string());
      }
    }
    std::sort(files.begin(), files.end());
    if (files.empty()) {
      throw Error(folder_ + ": holds no mesh files (OBJ, STL, PLY, glTF, VTP, ...)");
    }
    for (const std::string& file : files) addFile(file);
    for (const auto& [name, bodies] : map_) {
      if (!used_.count(name)) {
        throw Error(fmt::format("{}: {}: no such file or object in {}", map_path_, name, folder_));
      }
    }
    if (pieces_.empty()) {
      throw Error(
          fmt::format("{}: no file is named after a bone of the torso (L3, lumbar1, ribcage, "
                      "r_scapula, ...); say with --map which is which",
                      folder_));
    }
    return pieces_;
  }

 private:
  void addFile(const std::string& file) {
    const std::string name = fs::path(file).filename().string();
    const std::string stem = fs::path(file).stem().string();
    const auto mapped = [&](const std::string& key) -> const Names* {
      const auto it = map_.find(key);
      if (it == map_.end()) return nullptr;
      used_.insert(key);
      return &it->second;
    };
    const Names* file_map = mapped(name);
    if (file_map && file_map->empty()) return;
    const std::vector<NamedMesh> objects = readMeshFile(file);
    for (const NamedMesh& object : objects) {
      const bool several = objects.size() > 1;
      const std::string where = several ? file + ": " + object.name : file;
      Names bodies;
      std::string side_source = stem;
      if (const Names* names = mapped(name + "/" + object.name)) {
        bodies = *names;
        if (bodies.empty()) continue;
      } else if (file_map) {
        bodies = *file_map;
      } else {
        // An object's own name says more than the file's, if there are several.
        if (several) {
          bodies = bodiesOfName(object.name);
          side_source = object.name;
        }
        if (bodies.empty()) {
          bodies = bodiesOfName(stem);
          side_source = stem;
        }
      }
      if (bodies.empty()) {
        remarks_.push_back(
            where + ": not named after a whole bone of the torso; skipped (--map can name it)");
        continue;
      }
      addObject(object, where, bodies, sideOfName(side_source));
    }
  }

  void addObject(const NamedMesh& object, const std::string& where, Names bodies,
                 const std::string& side) {
    if (bodies.front() == "C2") {
      remarks_.push_back(where + ": C1 and C2 belong to the head; skipped");
      return;
    }
    TriMesh mesh = object.mesh;
    if (axes_) {
      for (Vector3d& v : mesh.vertices) v = *axes_ * v;
      if (axes_->determinant() < 0) {
        for (auto& f : mesh.faces) std::swap(f[1], f[2]);
      }
    }
    MeshRepair repair;
    try {
      mesh = repaired(mesh, &repair);
    } catch (const std::exception& e) {
      throw Error(where + ": " + e.what());
    }
    if (!repair.text().empty()) remarks_.push_back(where + ": repaired: " + repair.text());
    std::vector<TriMesh> parts = {mesh};
    const bool spine = bodies.front() == "spine";
    if (spine || bodies.size() > 1) parts = partsOf(mesh, where, bodies, spine);
    if (spine) {
      if (parts.size() == 1) {
        throw Error(where + ": which vertebra is this? Name it in --map, e.g. {\"" +
                    fs::path(object.file).filename().string() + "\": \"L3\"}");
      }
      bodies = {"L5", "L4", "L3", "L2", "L1"};
      if (parts.size() != bodies.size()) {
        throw Error(
            fmt::format("{}: {} vertebrae in one object; name them from below in --map, e.g. "
                        "{{\"{}\": [\"L5\", \"L4\"]}}",
                        where, parts.size(), fs::path(object.file).filename().string()));
      }
      remarks_.push_back(where + ": five vertebrae, taken for L5 .. L1 from below");
    }
    for (std::size_t i = 0; i < parts.size(); i++) {
      BonePiece piece;
      piece.where = parts.size() > 1 ? where + ": " + bodies[i] : where;
      piece.body = bodies[i];
      piece.side = side;
      if (piece.body.rfind("left_", 0) == 0) piece.side = "left";
      if (piece.body.rfind("right_", 0) == 0) piece.side = "right";
      piece.mesh = parts[i];
      pieces_.push_back(piece);
    }
  }

  // As many parts of a surface as there are bodies: the largest, vertebrae from below, else in the
  // order of `bodies`, the first being the smallest (a clavicle before its scapula).
  std::vector<TriMesh> partsOf(const TriMesh& mesh, const std::string& where, const Names& bodies,
                               bool spine) {
    std::vector<TriMesh> parts = connectedParts(mesh);
    std::sort(parts.begin(), parts.end(),
              [](const TriMesh& a, const TriMesh& b) { return signedVolume(a) > signedVolume(b); });
    const double largest = signedVolume(parts.front());
    std::size_t count = 0;
    while (count < parts.size() && signedVolume(parts[count]) > kSmallPart * largest) count++;
    const bool vertebrae = spine || isLevel(bodies.front());
    if (!vertebrae) count = std::min(parts.size(), bodies.size());
    if (!spine && count != bodies.size()) {
      throw Error(fmt::format("{}: has {} connected parts, not {}; the map must name them all",
                              where, count, bodies.size()));
    }
    if (parts.size() > count) {
      remarks_.push_back(
          fmt::format("{}: {} small parts (discs?) skipped", where, parts.size() - count));
    }
    parts.resize(count);
    if (vertebrae && count > 1) return fromBelow(parts, where);
    std::reverse(parts.begin(), parts.end());
    return parts;
  }

  std::string folder_, map_path_;
  std::map<std::string, Names> map_;
  std::optional<Matrix3d> axes_;
  std::vector<std::string>& remarks_;
  std::set<std::string> used_;
  std::vector<BonePiece> pieces_;
};

}  // namespace

Matrix3d axesMatrix(const std::string& letters) {
  const std::map<char, Vector3d> kLetters = {{'A', Vector3d::UnitX()}, {'P', -Vector3d::UnitX()},
                                             {'L', Vector3d::UnitY()}, {'R', -Vector3d::UnitY()},
                                             {'S', Vector3d::UnitZ()}, {'I', -Vector3d::UnitZ()}};
  Matrix3d M = Matrix3d::Zero();
  for (int i = 0; i < 3 && letters.size() == 3; i++) {
    const auto it = kLetters.find(static_cast<char>(std::toupper(letters[i])));
    if (it != kLetters.end()) M.col(i) = it->second;
  }
  if (std::abs(M.determinant()) != 1) {
    throw Error(
        fmt::format("--axes {}: must be three letters that say where x, y and z point, one "
                    "each of A P (front, back), L R, S I (up, down); e.g. ASR for x front, "
                    "y up, z right",
                    letters));
  }
  return M;
}

std::string axesLetters(const Matrix3d& M) {
  std::string out;
  const char* kNames[] = {"PA", "RL", "IS"};
  for (int i = 0; i < 3; i++) {
    for (int k = 0; k < 3; k++) {
      if (M(k, i) != 0) out += kNames[k][M(k, i) > 0];
    }
  }
  return out;
}

std::vector<BonePiece> readBonePieces(const std::string& folder, const std::string& map,
                                      const std::optional<Matrix3d>& axes,
                                      std::vector<std::string>* remarks) {
  return PieceReader(folder, map, axes, remarks).run();
}

}  // namespace torso::tools
