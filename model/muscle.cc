// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/muscle.h"

#include <cmath>
#include <optional>
#include <stdexcept>

#include "model/body.h"

namespace torso {
namespace {

using Eigen::Vector3d;

// Offsets that no table holds, at the size of the tables [m]. Assumed.
constexpr double kBesideMidline = 0.003;        // of what is at a spinous process
constexpr double kMamillaryBehindFace = 0.007;  // the process over the joint's face
constexpr double kLongissimusAside = 0.022, kIliocostalisAside = 0.042;

struct Place {
  Vector3d position;  // bone's frame, left
  bool on_bone;
};

Vector3d spinousTip(const Vertebra& v) {
  const double d = v.spinous_declination;
  return v.spinous_tip_distance * Vector3d(-std::cos(d), 0, -std::sin(d));
}

// Tip of the left transverse process; behind the rib where there is one.
Vector3d transverseTip(const Anatomy& a, const Vertebra& v) {
  const double height = (v.body_height_anterior + v.body_height_posterior) / 2;
  Vector3d tip(-v.upper_endplate_depth / 2 - 0.004 * a.length_scale, v.transverse_process_span / 2,
               0.08 * height);
  for (const CostalJoint& joint : a.costal_joints) {
    if (joint.level != v.name || !joint.costotransverse) continue;
    tip.x() = joint.position.x() - 0.004 * a.length_scale;
    tip.z() = joint.position.z();
  }
  return tip;
}

std::optional<Place> placeOnVertebra(const Anatomy& a, const std::string& site,
                                     const std::string& level) {
  const double scale = a.length_scale;
  if (site == "mamillary") {
    for (const ArticularFacet& face : a.facets) {
      if (face.level != level) continue;
      return Place{face.position + scale * kMamillaryBehindFace * Vector3d(-1, 0.3, 0), true};
    }
    return std::nullopt;
  }
  if (level == "S1") return std::nullopt;
  const Vertebra& v = a.vertebra(level);
  const Vector3d aside = scale * kBesideMidline * Vector3d::UnitY();
  const Vector3d spinous = spinousTip(v), transverse = transverseTip(a, v);
  const Vector3d root(-v.upper_endplate_depth / 2 - v.canal_depth, 0,
                      -0.3 * v.body_height_posterior);
  if (site == "spinous_tip") return Place{spinous + aside, true};
  if (site == "lamina") return Place{root + 2 * aside, true};
  if (site == "transverse_tip") return Place{transverse, true};
  if (site == "accessory") {
    return Place{{transverse.x() - 0.004 * scale, 0.55 * transverse.y(), transverse.z()}, true};
  }
  if (site == "transverse_front") {
    return Place{{transverse.x() + 0.006 * scale, 0.6 * transverse.y(), transverse.z()}, true};
  }
  if (site == "body_side") return Place{{0, 0.42 * v.lower_endplate_width, 0}, true};
  if (site == "disc_side") {
    return Place{{0, v.lower_endplate_width / 2, -v.body_height_posterior / 2}, true};
  }
  if (site == "longissimus" || site == "iliocostalis") {
    const double y = scale * (site == "longissimus" ? kLongissimusAside : kIliocostalisAside);
    return Place{{spinous.x(), y, v.region == Region::kLumbar ? spinous.z() : 0}, false};
  }
  return std::nullopt;
}

MusclePoint pointOf(const Anatomy& a, const Muscle& muscle, const std::string& site) {
  const auto colon = site.find(':');
  if (colon == std::string::npos) {
    const auto carrier = a.landmark_carriers.find(site);
    if (carrier != a.landmark_carriers.end()) {
      return {pairedName(a, Side::kLeft, carrier->second), a.landmark(site),
              a.muscle_ends.count(site) > 0};
    }
  } else {
    const std::string level = site.substr(colon + 1);
    if (const auto place = placeOnVertebra(a, site.substr(0, colon), level)) {
      return {bodyOfLevel(a, level), a.boneFrame(level) * place->position, place->on_bone};
    }
  }
  throw std::runtime_error("anatomy: muscles.csv, " + muscle.name + ": no site is called '" + site +
                           "'");
}

std::string otherSide(const std::string& body) {
  return splitSide(body).first == Side::kLeft ? "right_" + splitSide(body).second : body;
}

}  // namespace

std::vector<MuscleLine> makeMuscles(const Anatomy& anatomy) {
  std::vector<MuscleLine> lines;
  for (const Muscle& muscle : anatomy.muscles) {
    MuscleLine left{muscle.name + "_left", muscle.group, muscle.section, {}};
    for (const std::string& site : muscle.sites) {
      left.points.push_back(pointOf(anatomy, muscle, site));
    }
    MuscleLine right{muscle.name + "_right", muscle.group, muscle.section, left.points};
    for (MusclePoint& p : right.points) {
      p = {otherSide(p.body), mirror(p.position), p.on_bone};
    }
    lines.push_back(left);
    lines.push_back(right);
  }
  return lines;
}

std::vector<MuscleLine> makeMuscles(const Anatomy& anatomy, const Skeleton& skeleton) {
  std::vector<MuscleLine> lines = makeMuscles(anatomy);
  for (std::size_t i = 0; i < lines.size(); i += 2) {  // left, then right
    for (std::size_t k = 0; k < lines[i].points.size(); k++) {
      MusclePoint& p = lines[i].points[k];
      if (!p.on_bone || !skeleton.has(p.body)) continue;
      p.position = skeleton.whole(p.body).nearest(p.position).point;
      lines[i + 1].points[k].position = mirror(p.position);
    }
  }
  return lines;
}

}  // namespace torso
