// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <assimp/config.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <map>
#include <set>

#include "model/median.h"
#include "tools/clip_formats.h"
#include "tools/error.h"

namespace torso::tools {
namespace {

namespace fs = std::filesystem;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// Of a damaged file: more than an hour at 120 Hz is not believed.
constexpr double kMaxFrames = 500000;
// In the names of the nodes into which assimp splits a joint's pivots.
constexpr const char* kPivot = "_$AssimpFbx$_";

Matrix4d matrix(const aiMatrix4x4& a) {
  Matrix4d m;
  m << a.a1, a.a2, a.a3, a.a4, a.b1, a.b2, a.b3, a.b4, a.c1, a.c2, a.c3, a.c4, a.d1, a.d2, a.d3,
      a.d4;
  return m;
}

// Without scale; a mirror image becomes the nearest rotation.
Isometry3d rigid(const Matrix4d& m) {
  Isometry3d X = Isometry3d::Identity();
  X.translation() = m.topRightCorner<3, 1>();
  Matrix3d R = m.topLeftCorner<3, 3>();
  for (int k = 0; k < 3; k++) {
    const double norm = R.col(k).norm();
    if (norm > 0) R.col(k) /= norm;
  }
  if (R.allFinite()) X.linear() = Quaterniond(R).normalized().toRotationMatrix();
  return X;
}

struct Node {
  const aiNode* node;
  int parent;  // among nodes, -1 for the scene's root
  int joint = -1;
};

// The keys that hold at a time, and how far it is from the first to the second.
template <typename Key>
std::pair<unsigned, double> keyAt(const Key* keys, unsigned count, double time) {
  if (count == 0 || time <= keys[0].mTime) return {0, 0};
  const Key* after = std::upper_bound(keys, keys + count, time,
                                      [](double t, const Key& key) { return t < key.mTime; });
  if (after == keys + count) return {count - 1, 0};
  const Key* before = after - 1;
  return {static_cast<unsigned>(before - keys),
          (time - before->mTime) / (after->mTime - before->mTime)};
}

Vector3d valueAt(const aiVectorKey* keys, unsigned count, double time) {
  const auto [k, share] = keyAt(keys, count, time);
  const auto at = [&](unsigned i) {
    return Vector3d(keys[i].mValue.x, keys[i].mValue.y, keys[i].mValue.z);
  };
  return share > 0 ? Vector3d(at(k) + share * (at(k + 1) - at(k))) : at(k);
}

Quaterniond valueAt(const aiQuatKey* keys, unsigned count, double time) {
  const auto [k, share] = keyAt(keys, count, time);
  const auto at = [&](unsigned i) {
    const aiQuaternion& q = keys[i].mValue;
    return Quaterniond(q.w, q.x, q.y, q.z).normalized();
  };
  return share > 0 ? at(k).slerp(share, at(k + 1)) : at(k);
}

// A node's place in its parent.
Matrix4d localAt(const aiNode& node, const aiNodeAnim* channel, double time) {
  if (!channel) return matrix(node.mTransformation);
  aiVector3D scale, position;
  aiQuaternion rotation;
  node.mTransformation.Decompose(scale, rotation, position);
  Vector3d p(position.x, position.y, position.z), s(scale.x, scale.y, scale.z);
  Quaterniond q(rotation.w, rotation.x, rotation.y, rotation.z);
  if (channel->mNumPositionKeys) {
    p = valueAt(channel->mPositionKeys, channel->mNumPositionKeys, time);
  }
  if (channel->mNumRotationKeys) {
    q = valueAt(channel->mRotationKeys, channel->mNumRotationKeys, time);
  }
  if (channel->mNumScalingKeys) {
    s = valueAt(channel->mScalingKeys, channel->mNumScalingKeys, time);
  }
  Matrix4d m = Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = q.toRotationMatrix() * s.asDiagonal();
  m.topRightCorner<3, 1>() = p;
  return m;
}

class SceneReader {
 public:
  SceneReader(const aiScene& scene, const std::string& path) : scene_(scene), path_(path) {}

  std::vector<Clip> read() {
    list(scene_.mRootNode, -1, 0);
    findJoints();
    if (base_.joints.empty()) {
      throw Error(path_ + ": no skeleton: nothing in this file moves or bends a skin");
    }
    readDeclarations();
    base_.path = path_;
    base_.rest = restPose();
    std::vector<Clip> clips;
    for (unsigned k = 0; k < scene_.mNumAnimations; k++) {
      Clip clip = readTake(*scene_.mAnimations[k]);
      if (clip.frames() > 0) clips.push_back(std::move(clip));
    }
    // Takes of a single frame beside others are left-overs of the exporter.
    const auto single = [](const Clip& clip) { return clip.frames() == 1; };
    if (!std::all_of(clips.begin(), clips.end(), single)) {
      clips.erase(std::remove_if(clips.begin(), clips.end(), single), clips.end());
    }
    if (clips.empty()) {
      base_.rate = 30;
      base_.poses =
          jointPoses(worldPoses([](const aiNode& n) { return matrix(n.mTransformation); }));
      clips.push_back(base_);
    }
    if (clips.size() == 1) clips.front().name.clear();
    return clips;
  }

 private:
  void list(const aiNode* node, int parent, int depth) {
    if (depth > 500) throw Error(path_ + ": nodes are nested too deeply");
    const int self = static_cast<int>(nodes_.size());
    nodes_.push_back({node, parent});
    for (unsigned k = 0; k < node->mNumChildren; k++) list(node->mChildren[k], self, depth + 1);
  }
  static std::string name(const aiNode* node) { return node->mName.C_Str(); }
  static bool isPivot(const aiNode* node) { return name(node).find(kPivot) != std::string::npos; }

  // Joints: what moves or bends a skin, what lies between such nodes, and the ends of their bones.
  void findJoints() {
    std::set<std::string> moving;
    for (unsigned k = 0; k < scene_.mNumAnimations; k++) {
      const aiAnimation& take = *scene_.mAnimations[k];
      for (unsigned c = 0; c < take.mNumChannels; c++) {
        const std::string channel = take.mChannels[c]->mNodeName.C_Str();
        moving.insert(channel.substr(0, channel.find(kPivot)));
      }
    }
    for (unsigned k = 0; k < scene_.mNumMeshes; k++) {
      const aiMesh& mesh = *scene_.mMeshes[k];
      for (unsigned b = 0; b < mesh.mNumBones; b++) {
        const std::string bone = mesh.mBones[b]->mName.C_Str();
        moving.insert(bone);
        bind_.emplace(bone, matrix(mesh.mBones[b]->mOffsetMatrix));
      }
    }
    std::vector<bool> is(nodes_.size());
    for (size_t n = 1; n < nodes_.size(); n++) {
      const aiNode* node = nodes_[n].node;
      const int parent = nodes_[n].parent;
      is[n] = moving.count(name(node)) > 0 ||
              (parent > 0 && is[parent] && (node->mNumMeshes == 0 || isPivot(node)));
    }
    for (size_t n = nodes_.size(); n-- > 1;) {  // what carries a joint is one
      if (is[n] && nodes_[n].parent > 0) is[nodes_[n].parent] = true;
    }
    if (moving.count(name(nodes_[0].node))) is[0] = true;
    for (size_t n = 0; n < nodes_.size(); n++) {
      if (!is[n] || isPivot(nodes_[n].node)) continue;
      int parent = nodes_[n].parent;
      while (parent >= 0 && nodes_[parent].joint < 0) parent = nodes_[parent].parent;
      nodes_[n].joint = static_cast<int>(base_.joints.size());
      base_.joints.push_back({name(nodes_[n].node), parent < 0 ? -1 : nodes_[parent].joint, false});
      if (!moving.count(name(nodes_[n].node)) && nodes_[n].node->mNumChildren == 0) {
        base_.joints.back().end = true;
      }
    }
  }

  void readDeclarations() {
    const std::string ext = fs::path(path_).extension().string();
    if (ext == ".fbx" || ext == ".FBX") {
      base_.unit = 0.01;  // FBX counts in centimetres times a factor
      int axis = 1, sign = 1;
      double factor = 1;
      float single = 1;
      if (const aiMetadata* data = scene_.mMetaData) {
        data->Get("UpAxis", axis);
        data->Get("UpAxisSign", sign);
        if (data->Get("UnitScaleFactor", single)) factor = single;
        data->Get("UnitScaleFactor", factor);
      }
      if (std::isfinite(factor) && factor > 0) base_.unit = 0.01 * factor;
      const bool turned = !scene_.mRootNode->mTransformation.IsIdentity();  // assimp made it y
      if (turned || axis < 0 || axis > 2) axis = 1, sign = 1;
      base_.up = Vector3d((sign < 0 ? -1 : 1) * Vector3d::Unit(axis));
    } else {
      base_.unit = 1;
      base_.up = Vector3d::UnitY();
    }
  }

  // World matrices of all nodes.
  template <typename Local>
  std::vector<Matrix4d> worldPoses(const Local& local) const {
    std::vector<Matrix4d> world(nodes_.size());
    for (size_t n = 0; n < nodes_.size(); n++) {
      const Matrix4d own = local(*nodes_[n].node);
      world[n] = nodes_[n].parent < 0 ? own : Matrix4d(world[nodes_[n].parent] * own);
    }
    return world;
  }
  std::vector<Isometry3d> jointPoses(const std::vector<Matrix4d>& world) const {
    std::vector<Isometry3d> poses(base_.joints.size());
    for (size_t n = 0; n < nodes_.size(); n++) {
      if (nodes_[n].joint >= 0) poses[nodes_[n].joint] = rigid(world[n]);
    }
    return poses;
  }

  // The pose in which the skin was bound, where there is one; other joints keep their place to the
  // one that carries them.
  std::vector<Isometry3d> restPose() const {
    const auto world = worldPoses([](const aiNode& n) { return matrix(n.mTransformation); });
    std::vector<Matrix4d> rest(nodes_.size());
    for (size_t n = 0; n < nodes_.size(); n++) {
      rest[n] = matrix(nodes_[n].node->mTransformation);
      if (nodes_[n].parent >= 0) rest[n] = rest[nodes_[n].parent] * rest[n];
      const auto bone = bind_.find(name(nodes_[n].node));
      if (bone == bind_.end()) continue;
      const Matrix4d bound = bone->second.inverse();
      if (bound.allFinite()) rest[n] = bound;
    }
    // Bones of a skin that is not all of the skeleton would be in another place than the rest.
    const bool whole = bind_.size() >= base_.joints.size() / 2;
    return jointPoses(whole ? rest : world);
  }

  Clip readTake(const aiAnimation& take) const {
    Clip clip = base_;
    clip.name = take.mName.C_Str();
    std::map<std::string, const aiNodeAnim*> channels;
    double first = INFINITY, last = -INFINITY;
    // Its own rate: the step between keys that most keys have; those of a channel count by its
    // median step, for exporters drop and add single keys.
    std::map<long, size_t> steps;  // keys by step, in 1/1000 tick
    for (unsigned c = 0; c < take.mNumChannels; c++) {
      const aiNodeAnim& channel = *take.mChannels[c];
      channels[channel.mNodeName.C_Str()] = &channel;
      const auto visit = [&](const auto* keys, unsigned count) {
        if (count == 0) return;
        first = std::min(first, keys[0].mTime);
        last = std::max(last, keys[count - 1].mTime);
        std::vector<double> own;
        for (unsigned k = 1; k < count; k++) own.push_back(keys[k].mTime - keys[k - 1].mTime);
        if (own.empty()) return;
        const double step = median(own);
        if (step > 0 && step < 1e9) steps[std::lround(1e3 * step)] += own.size();
      };
      visit(channel.mPositionKeys, channel.mNumPositionKeys);
      visit(channel.mRotationKeys, channel.mNumRotationKeys);
    }
    if (!(first <= last)) return clip;
    const double ticks = take.mTicksPerSecond > 0 ? take.mTicksPerSecond : 25;
    double frames = 1, step = 0;
    clip.rate = 30;
    if (!steps.empty() && last > first) {
      const auto usual =
          std::max_element(steps.begin(), steps.end(),
                           [](const auto& a, const auto& b) { return a.second < b.second; });
      // Times are rounded, to milliseconds in glTF: a whole number of steps in all.
      const double count =
          std::max(1.0, std::round((last - first) / std::max(1e-3 * usual->first, 1e-9)));
      step = (last - first) / count;
      clip.rate = ticks / step;
      frames = count + 1;
    }
    if (!(frames <= kMaxFrames && std::isfinite(clip.rate))) {
      throw Error(
          fmt::format("{}: take '{}': the times of its keys make no sense", path_, clip.name));
    }
    std::map<const aiNode*, const aiNodeAnim*> of;
    for (const Node& n : nodes_) {
      const auto found = channels.find(name(n.node));
      if (found != channels.end()) of[n.node] = found->second;
    }
    for (double f = 0; f < frames; f++) {
      const auto poses = jointPoses(worldPoses([&](const aiNode& n) {
        const auto found = of.find(&n);
        return localAt(n, found == of.end() ? nullptr : found->second, first + f * step);
      }));
      clip.poses.insert(clip.poses.end(), poses.begin(), poses.end());
    }
    return clip;
  }

  const aiScene& scene_;
  const std::string& path_;
  std::vector<Node> nodes_;               // parents before children
  std::map<std::string, Matrix4d> bind_;  // by bone: from the mesh to the bone
  Clip base_;                             // what all takes share
};

}  // namespace

std::vector<Clip> parseWithAssimp(const std::string& content, const std::string& path) {
  Assimp::Importer importer;
  // assimp 5.2 keeps the nodes of an FBX joint's pivots, but puts the whole of the joint's motion,
  // pivots included, on the last of them: both together would turn it twice.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
  // Points and lines without a mesh are no reason to refuse a skeleton.
  const std::string ext = fs::path(path).extension().string();
  if (ext == ".glb" && content.size() >= 12) {  // assimp leaves out what is not there
    std::uint32_t size;                         // third word of the header, little-endian
    std::memcpy(&size, content.data() + 8, sizeof size);
    if (size > content.size()) {
      throw Error(
          fmt::format("{}: the file is cut short: {} bytes of {}", path, content.size(), size));
    }
  }
  std::error_code error;
  const aiScene* scene = ext == ".gltf" && fs::is_regular_file(path, error)
                             ? importer.ReadFile(path, 0)  // finds the buffers beside it
                             : importer.ReadFileFromMemory(content.data(), content.size(), 0,
                                                           ext.empty() ? "" : ext.c_str() + 1);
  if (!scene || !scene->mRootNode) {
    std::string why = importer.GetErrorString();
    why = why.substr(0, why.find('\n'));
    throw Error(fmt::format(
        "{}: cannot be read; it is cut short, damaged or of another format ({})", path, why));
  }
  return SceneReader(*scene, path).read();
}

}  // namespace torso::tools
