// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// A motion capture clip as its file has it: a tree of named joints and where they are in each
// frame, before anything is understood of it.

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

namespace torso::tools {

struct ClipJoint {
  std::string name;
  int parent = -1;   // index of an earlier joint, -1 for a root
  bool end = false;  // the end of a bone: no joint, it does not turn against its parent
};

struct Clip {
  std::string path,
      name;         // name: of the file without extension; and of the take, if it has several
  double rate = 0;  // frames per second [Hz]
  std::vector<ClipJoint> joints;
  // In the world of the file, in its unit and axes. Rest: the pose in which the file was rigged,
  // which need not be one that anybody can take.
  std::vector<Eigen::Isometry3d> rest;   // joints
  std::vector<Eigen::Isometry3d> poses;  // frames x joints, row-major
  // What the file declares; its writer may not have meant it.
  std::optional<double> unit;         // [m]
  std::optional<Eigen::Vector3d> up;  // a unit vector along an axis of the file

  size_t frames() const { return joints.empty() ? 0 : poses.size() / joints.size(); }
  const Eigen::Isometry3d& pose(size_t frame, int joint) const {
    return poses[frame * joints.size() + static_cast<size_t>(joint)];
  }
};

// True for a file name that ends like one that readClips knows: .bvh, .fbx, .gltf, .glb.
bool isClipFile(const std::string& path);

// The takes of a file, at least one, each with at least one joint and one frame and all numbers
// finite. A file with a skeleton but no motion gives one clip of one frame. Throws Error "<path>:
// ..." for a file that cannot be read, is cut short, has no skeleton or a number that is none.
std::vector<Clip> readClips(const std::string& path);

// The same from the content of a file; `path` tells the format and is put into messages. A .gltf
// must hold its buffers itself.
std::vector<Clip> parseClips(const std::string& content, const std::string& path);

// At so many frames per second [Hz]: positions linearly, rotations by slerp, between the frames of
// the clip; the first frame is kept. As it is if it has one frame or this rate. Requires rate > 0.
Clip resampled(const Clip& clip, double rate);

}  // namespace torso::tools
