// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// One graft under way: what its steps share. Grafter::run (graft.cc) takes the steps in order; each
// group of them is in the file that its comment names.

#include <tinyxml2.h>

#include <Eigen/Geometry>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "model/anatomy.h"
#include "model/body.h"
#include "model/skeleton.h"
#include "tools/error.h"
#include "tools/graft.h"
#include "tools/graft_host.h"
#include "tools/graft_names.h"

namespace torso::tools {

// Levels of the spine that one actuator bends about one axis of the standing trunk.
struct SpineGroup {
  std::string name;  // of the actuator
  int axis;          // 0 x, 1 y, 2 z
  int first, last;   // of Anatomy::discs
};

class Grafter {
 public:
  Grafter(const Anatomy& anatomy, const GraftOptions& options)
      : table_size_(anatomy), o_(options), host_(options.input) {}

  GraftReport run();

 private:
  using XMLElement = tinyxml2::XMLElement;

  // graft.cc
  void checkOutput() const;
  void writeMap() const;
  void fit();  // scale and place of our torso
  [[noreturn]] void fail(const std::string& what) const { throw Error(o_.input + ": " + what); }
  void note(const char* action, const std::string& kind, const std::string& name,
            const std::string& detail) {
    report_.changes.push_back({action, kind, name, detail});
  }
  std::string ours(const std::string& name) const { return o_.prefix + name; }
  std::string bodyName(const std::string& body) const;     // that our body has in the result
  std::string replacement(int body) const;                 // our body in the place of a removed one
  std::string replacement(const std::string& body) const;  // "" if it is not removed
  Eigen::Isometry3d ourPose(const std::string& body) const { return place_ * bodyFrame(a_, body); }

  // graft_settings.cc: compiler, option, size
  void checkSettings();
  void mergeSettings();
  void freezeInertias();

  // graft_defaults.cc
  void isolateDefaults();
  std::string effectiveClass(const XMLElement* e) const;  // childclass that holds in e's body

  // graft_limbs.cc: what hangs on our bodies
  void takeLimbs();
  void takeCarried();
  void hangLimbs();

  // graft_trunk.cc: what is removed
  void removeTrunk();
  void dropReferences();
  bool dropReferences(XMLElement* list, const std::string& section);

  // graft_keyframes.cc
  void takeKeyframes();
  void writeKeyframes(const mjModel* m);

  // graft_torso.cc: ours
  void writeTorso();
  void adaptTorso();
  void renameClashes();
  XMLElement* ourBody(const std::string& body);  // before renaming

  // graft_actuators.cc: servos of several levels
  void takeTrunkActuators();
  void addGroups();
  void makeGroup(XMLElement* e, const SpineGroup& group, double slope, double offset);
  std::array<double, 2> groupRange(const SpineGroup& group) const;  // [rad]
  std::map<int, SpineGroup> trunkJointGroups(const std::vector<int>& joints) const;
  Eigen::Vector3d localAxis(int joint) const;
  std::string standingSite(const std::string& bone);
  std::string freeName(const std::string& kind, std::string name) const;

  // graft_contacts.cc
  void adaptContactBits();
  void exclude(const std::string& one, const std::string& two, const char* why);
  std::string namedBody(const mjModel* m, int body);
  void excludeOverlaps(const mjModel* m);

  // graft_merge.cc: one document
  XMLElement* firstStatefulActuator() const;
  void merge();

  // graft_files.cc
  using Files = std::map<std::string, std::string>;  // content by name
  void placeFiles(XMLElement* root, const std::string& folder) const;
  void write(const std::string& path, const Files& meshes) const;

  // graft_check.cc: mass, size, limb joints, torso data of the result
  void check(const mjModel* m);

  const Anatomy& table_size_;
  std::optional<Skeleton> bones_;  // at the size of the tables
  const GraftOptions& o_;
  Host host_;
  HostParts parts_;
  Anatomy a_;                    // scaled to the host
  Eigen::Isometry3d place_;      // of our standing body in the host's world
  tinyxml2::XMLDocument torso_;  // ours, until it is merged
  XMLElement* torso_root_ = nullptr;
  XMLElement* kept_ = nullptr;           // parts of the host that will hang on our bodies
  XMLElement* world_ = nullptr;          // worldbody that the trunk was in
  tinyxml2::XMLNode* before_ = nullptr;  // after which element; null: first
  std::array<XMLElement*, 4> limbs_{};   // thighs, upper arms; left, right
  std::vector<std::pair<XMLElement*, std::string>> carried_;  // camera, light or site; our body
  XMLElement* keyframes_ = nullptr;
  std::set<XMLElement*> stateful_;                     // actuators of the host with activation
  std::array<std::map<int, std::string>, 3> driven_;   // by axis and disc: actuator of the group
  std::map<std::string, std::string> standing_sites_;  // by bone
  std::set<MjcfName> removed_;
  std::set<std::pair<std::string, std::string>> excluded_;
  GraftReport report_{};
};

// Folder beside the output that holds our bone meshes.
constexpr const char* kGraftAssets = "torso_assets";

}  // namespace torso::tools
