// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The humanoid that gets our torso: its MJCF, what MuJoCo makes of it, and which body is what.

#include <tinyxml2.h>

#include <Eigen/Geometry>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "tools/graft_map.h"
#include "tools/mujoco_support.h"

namespace torso::tools {

struct Host {
  std::string path, folder;                   // folder: of the file, absolute
  tinyxml2::XMLDocument document;             // includes expanded
  std::vector<std::string> included;          // paths of the files that were
  tinyxml2::XMLElement* root;                 // <mujoco>
  ModelPtr model;                             // compiled from the file
  DataPtr data;                               // at qpos0, kinematics computed
  std::vector<tinyxml2::XMLElement*> bodies;  // by body id; null for the world

  explicit Host(const std::string& path);

  std::string bodyName(int body) const { return nameOf(model.get(), mjOBJ_BODY, body); }
  Eigen::Isometry3d pose(int body) const;  // in the world at qpos0
  // Mean of the anchors of a body's joints in the world at qpos0, its origin if it has none [m].
  Eigen::Vector3d jointCentre(int body) const;
  bool isBelow(int body, int ancestor) const;  // in its subtree, or itself
};

// Appends the bodies below an element in the order of MuJoCo's ids.
void listBodies(tinyxml2::XMLElement* parent, std::vector<tinyxml2::XMLElement*>& bodies);

// Parts of the trunk that our torso replaces.
enum class TrunkPart { kPelvis, kWaist, kChest, kNeck, kHead, kLeftClavicle, kRightClavicle };

struct HostParts {
  int root;                                      // child of the world, ancestor of all parts
  std::array<int, 2> thigh, upper_arm;           // left, right: kept with what hangs on them
  std::map<int, TrunkPart> trunk;                // all other bodies below root: removed
  std::array<Eigen::Vector3d, 2> hip, shoulder;  // joint centres in the world at qpos0 [m]
  std::vector<RecognisedPart> recognised;        // one each of bodyMapParts().names
};

// Recognises the parts that the map does not give: a pair of limbs is two children of one body that
// mirror each other by name or by size; which are legs, and which side is left, follows from names,
// or else from masses and from where the feet point. Throws Error that names the file, the part
// that is missing and the map's entry that would give it.
HostParts recognise(const Host& host, const PartMap& map);

// Axes of a standing trunk from its four joint centres: columns forward, left, up.
Eigen::Matrix3d trunkAxes(const std::array<Eigen::Vector3d, 2>& hip,
                          const std::array<Eigen::Vector3d, 2>& shoulder);

}  // namespace torso::tools
