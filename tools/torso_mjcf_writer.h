// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Internal to torso_mjcf*.cc: what writes the <mujoco> element, a file for each part of it.

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "model/body.h"
#include "model/facet.h"
#include "model/ligament.h"
#include "model/muscle.h"
#include "tools/mjcf.h"
#include "tools/torso_mjcf.h"

namespace torso::tools {

// Viewer groups, one per layer; 0-2 are shown at first, 3-5 hidden.
constexpr int kBoneGroup = 1, kDiscGroup = 1, kLigamentGroup = 1;
constexpr int kMuscleGroup = 2;
constexpr int kCollisionGroup = 3, kFacetGroup = 4, kSiteGroup = 4;

// Stiff enough to hold the band within a millimetre in a 2 m fall, soft enough for 200 Hz.
constexpr char kLimitSolref[] = "0.004 1";
constexpr char kLimitSolimp[] = "0.9 0.99 0.001";

// Of bones with the world and each other.
constexpr double kFriction[3] = {0.8, 0.005, 0.0001};  // MuJoCo's sliding, torsional, rolling
constexpr char kContactSolref[] = "0.01 1";
constexpr char kContactSolimp[] = "0.9 0.95 0.005";

class MjcfWriter {
 public:
  MjcfWriter(const Anatomy& anatomy, const MjcfOptions& options, tinyxml2::XMLElement* root)
      : a_(anatomy), o_(options), root_(root) {}

  void write();

 private:
  // Is the body, of either side, among those that are written?
  bool has(const std::string& body) const {
    return o_.only.empty() || std::find(o_.only.begin(), o_.only.end(), body) != o_.only.end();
  }
  bool detailed() const { return o_.kind == TorsoKind::kDetailed; }
  std::string named(const std::string& name) const { return o_.prefix + name; }
  // Body in which a body of the anatomy is moulded: itself, or a rigid part of the torso.
  std::string host(const std::string& body) const;
  std::vector<std::string> hosts() const;  // all of them, in the order of the MJCF
  Eigen::Isometry3d frame(const std::string& body) const { return bodyFrame(a_, host(body)); }
  Eigen::Vector3d local(const std::string& body, const Eigen::Vector3d& standing) const {
    return frame(body).inverse() * standing;
  }
  Eigen::Quaterniond localRotation(const std::string& body, const Eigen::Matrix3d& standing) const {
    return Eigen::Quaterniond(frame(body).linear().transpose() * standing);
  }

  std::vector<Tissue> tissues(const std::string& body) const {
    if (o_.own && o_.own->meshes.count(body)) return {Tissue::kBone};
    return boneTissues(a_, body);
  }

  void writeOptions();
  void writeDefaults();
  void writeAssets();
  void writeBodies();
  tinyxml2::XMLElement* writeBody(tinyxml2::XMLElement* parent, const std::string& parent_name,
                                  const std::string& body);
  void writeBones(tinyxml2::XMLElement* element, const std::string& body);
  void writeInertial(tinyxml2::XMLElement* element, const std::string& body);
  tinyxml2::XMLElement* facetBody(const std::string& body);
  std::string axesSite(const std::string& body);
  void writeSites();
  void writeContacts();
  void writeTrunkPairs(tinyxml2::XMLElement* contact, const std::string& limb,
                       const std::set<std::string>& excluded) const;
  bool neighbours(const std::string& limb, const std::string& part) const;
  void writeTendons();
  void writeEqualities();
  void writeActuators();
  void writeMuscleActuators();
  void writeSensors();
  void writeCustom();
  void writeSkins(tinyxml2::XMLElement* asset);

  const Anatomy& a_;
  const MjcfOptions& o_;
  tinyxml2::XMLElement* root_;
  std::map<std::string, tinyxml2::XMLElement*> bodies_, facet_bodies_;
  std::set<std::string> axes_;  // bodies that have an axesSite
  std::vector<Facet> facets_;
  std::vector<LigamentSegment> ligaments_;
  std::vector<MuscleLine> muscles_;
  std::vector<Disc> levels_;
  std::vector<DiscMesh> discs_;  // of levels_
};

}  // namespace torso::tools
