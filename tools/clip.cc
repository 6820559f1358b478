// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/clip.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tools/clip_formats.h"
#include "tools/error.h"

namespace torso::tools {
namespace {

namespace fs = std::filesystem;
using Eigen::Isometry3d;

std::string extension(const std::string& path) {
  std::string ext = fs::path(path).extension().string();
  for (char& c : ext) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ext;
}

void check(const Clip& clip) {
  for (size_t k = 0; k < clip.poses.size(); k++) {
    if (clip.poses[k].matrix().allFinite()) continue;
    throw Error(fmt::format("{}: frame {}, joint '{}': not a finite number; export the clip again",
                            clip.path, k / clip.joints.size() + 1,
                            clip.joints[k % clip.joints.size()].name));
  }
  for (size_t k = 0; k < clip.rest.size(); k++) {
    if (clip.rest[k].matrix().allFinite()) continue;
    throw Error(fmt::format("{}: rest pose, joint '{}': not a finite number", clip.path,
                            clip.joints[k].name));
  }
}

}  // namespace

bool isClipFile(const std::string& path) {
  const std::string ext = extension(path);
  return ext == ".bvh" || ext == ".fbx" || ext == ".gltf" || ext == ".glb";
}

std::vector<Clip> parseClips(const std::string& content, const std::string& path) {
  if (!isClipFile(path)) {
    throw Error(path + ": not a motion capture file; known are .bvh, .fbx, .gltf and .glb");
  }
  if (content.empty()) throw Error(path + ": the file is empty");
  std::vector<Clip> clips;
  if (extension(path) == ".bvh") {
    clips.push_back(parseBvh(content, path));
  } else {
    clips = parseWithAssimp(content, path);
  }
  const std::string stem = fs::path(path).stem().string();
  for (Clip& clip : clips) {
    clip.name = clip.name.empty() ? stem : stem + "_" + clip.name;
    for (char& c : clip.name) {  // it becomes a file's name
      if (c == '/' || c == '|' || c == ' ' || c == '\\' ||
          std::iscntrl(static_cast<unsigned char>(c)))
        c = '_';
    }
    check(clip);
  }
  return clips;
}

std::vector<Clip> readClips(const std::string& path) {
  std::error_code error;
  std::ifstream file(path, std::ios::binary);
  if (!fs::is_regular_file(path, error) || !file) throw Error(path + ": cannot be opened");
  std::ostringstream content;
  content << file.rdbuf();
  return parseClips(content.str(), path);
}

Clip resampled(const Clip& clip, double rate) {
  const size_t frames = clip.frames(), joints = clip.joints.size();
  if (frames < 2 || std::abs(rate / clip.rate - 1) < 1e-6) return clip;
  Clip out = clip;
  out.rate = rate;
  out.poses.clear();
  const double last = static_cast<double>(frames - 1);
  for (double k = 0; k * clip.rate / rate <= last + 1e-6; k++) {
    const double at = std::min(last, k * clip.rate / rate);
    const size_t from = std::min(static_cast<size_t>(at), frames - 2);
    const double share = at - static_cast<double>(from);
    for (size_t j = 0; j < joints; j++) {
      const Isometry3d& a = clip.poses[from * joints + j];
      const Isometry3d& b = clip.poses[(from + 1) * joints + j];
      Isometry3d X = Isometry3d::Identity();
      X.translation() = (1 - share) * a.translation() + share * b.translation();
      X.linear() = Eigen::Quaterniond(a.linear())
                       .slerp(share, Eigen::Quaterniond(b.linear()))
                       .toRotationMatrix();
      out.poses.push_back(X);
    }
  }
  return out;
}

}  // namespace torso::tools
