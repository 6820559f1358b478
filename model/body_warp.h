// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "model/anatomy.h"

namespace torso {

// Carries points of the tables' body into the body of a person whose spine has other curves or
// whose build is another: for what is shaped in the tables' posture, that is landmarks and bones
// other than vertebrae. A smooth map for each body of model/body.h that is no vertebra:
//   pelvis      turns about the S1 endplate as the sacral slope does, and is widened;
//   ribcage     follows its vertebrae near the spine and, in front and at the sides, their mean
//               motion; widened and deepened; meets the costal joints of its vertebrae exactly;
//   clavicle, scapula   go with the thorax;
//   arm, leg    shift with the shoulder and the hip joint, as they hang or stand;
//   head        shifts with C2, so that the gaze stays level.
// All at the size of the tables. Mirror symmetric.
class BodyWarp {
 public:
  struct Growth {  // sizes over the tables', stature apart; 1: as the tables
    double thorax_width = 1, thorax_depth = 1;
    double pelvis_width = 1, ischial_width = 1;  // from the hip joints up; of the ischia
    double head = 1;
  };

  // `tables` and `person` differ in vertebrae, discs, facets, costal joints and sacral slope; the
  // person's landmarks are not read. Both at the size of the tables.
  BodyWarp(const Anatomy& tables, const Anatomy& person, const Growth& growth);

  const Anatomy& tables() const { return tables_; }

  // Place in the person of a point of a body of the tables, both in the standing body [m]. Throws
  // std::runtime_error for a body that is none of the above.
  Eigen::Vector3d operator()(const std::string& body, const Eigen::Vector3d& point) const;

  // How thorax and pelvis as wholes have turned, and how the thorax has grown along its own axes.
  Eigen::Matrix3d thoraxRotation() const { return thorax_turn_; }
  Eigen::Vector3d thoraxGrowth() const { return thorax_growth_; }
  Eigen::Matrix3d pelvisRotation() const { return pelvis_turn_; }

 private:
  struct Anchor {  // a place that must be met, and by how much the rest of the map misses it
    Eigen::Vector3d from, residual;
  };
  struct Level {  // of a vertebra: centre in the tables, in the person, and turn between them
    Eigen::Vector3d from, to;
    double turn;
  };

  Eigen::Vector3d pelvis(const Eigen::Vector3d& p) const;
  Eigen::Vector3d thorax(const Eigen::Vector3d& p) const;  // as a whole
  Eigen::Vector3d ribs(const Eigen::Vector3d& p) const;
  Eigen::Vector3d head(const Eigen::Vector3d& p) const;
  template <typename Map>
  static void addAnchor(std::vector<Anchor>& anchors, const Map& map, const Eigen::Vector3d& from,
                        const Eigen::Vector3d& to);

  Anatomy tables_;
  Growth growth_;
  Eigen::Matrix3d pelvis_turn_, thorax_turn_;
  Eigen::Vector3d thorax_growth_, thorax_from_, thorax_to_;
  std::vector<Level> spine_;  // T12 .. T1
  Eigen::Vector3d c2_from_, c2_to_;
  std::vector<Anchor> pelvis_anchors_, rib_anchors_, head_anchors_;
};

}  // namespace torso
