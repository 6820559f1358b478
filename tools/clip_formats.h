// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Readers of single formats, for clip.cc. As parseClips, but the clips need not be valid yet.

#include <string>
#include <vector>

#include "tools/clip.h"

namespace torso::tools {

// Biovision BVH. Our own reader: assimp 5.2 knows one ROOT per file, ends names at the first blank,
// drops the position channels of joints with fewer than six channels, confuses joints of one name,
// and keeps single precision only. Position channels replace the joint's OFFSET, as in Blender and
// MotionBuilder. The zero pose is the rest pose.
Clip parseBvh(const std::string& content, const std::string& path);

// FBX (binary and ASCII) and glTF (.gltf, .glb) through assimp. The nodes into which it splits an
// FBX joint's pivots become one joint; nodes that neither move nor carry others are left out.
std::vector<Clip> parseWithAssimp(const std::string& content, const std::string& path);

}  // namespace torso::tools
