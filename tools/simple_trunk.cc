// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/simple_trunk.h"

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "model/body.h"

namespace torso::tools {
namespace {

struct TrunkJoint {
  Region region;
  const char *parent, *child, *disc;
};
constexpr TrunkJoint kJoints[] = {{Region::kLumbar, "pelvis", "abdomen", "L4/L5"},
                                  {Region::kThoracic, "abdomen", "ribcage", "T12/L1"},
                                  {Region::kCervical, "ribcage", "neck", "C7/T1"}};

constexpr double kArmature = 0.01;  // [kg m^2], assumed, as of hips and shoulders (joints.csv)

// Levels of the servos of a region; C2/C3 is the head joint's.
std::vector<const Disc*> levelsOf(const Anatomy& a, Region region) {
  std::vector<const Disc*> levels;
  for (const Disc& disc : a.discs) {
    if (disc.region == region && disc.upper != a.c2.name) levels.push_back(&disc);
  }
  return levels;
}

bool sternal(const std::string& level) {
  return std::find(std::begin(kSternalLevels), std::end(kSternalLevels), level) !=
         std::end(kSternalLevels);
}

// Flexion stiffness of a disc that calibration aims at [Nm/rad].
double flexionStiffness(const Anatomy& a, Region region) {
  for (const DiscTest& test : a.disc_tests) {
    if (test.fit && test.region == region && test.quantity == DiscTest::Quantity::kFlexion) {
      return test.value * a.mass_scale * a.length_scale * a.length_scale;
    }
  }
  throw std::runtime_error("anatomy: no flexion test of " + regionName(region) + " discs");
}

}  // namespace

Anatomy withSimpleTrunk(const Anatomy& anatomy) {
  Anatomy a = anatomy;
  for (const TrunkJoint& j : kJoints) {
    const std::vector<const Disc*> levels = levelsOf(anatomy, j.region);
    const auto bending =
        static_cast<double>(std::count_if(levels.begin(), levels.end(), [](const Disc* disc) {
          return !(sternal(disc->lower) && sternal(disc->upper));
        }));
    BallJoint joint;
    joint.name = regionName(j.region);
    joint.parent = j.parent;
    joint.child = j.child;
    joint.position = anatomy.disc(j.disc).frame.translation();
    joint.limit = 0;
    joint.stiffness = flexionStiffness(anatomy, j.region) / bending;
    joint.damping = 0;
    joint.armature = kArmature * a.mass_scale * a.length_scale * a.length_scale;
    for (Servo& s : a.servos) {
      if (s.joint != joint.name) continue;
      const bool flexion = s.motion == "flexion";
      const Motion motion = flexion                         ? kFlexion
                            : s.motion == "lateral_bending" ? kLateralBending
                                                            : kAxialRotation;
      s.min = s.max = 0;
      for (const Disc* disc : levels) {
        const RangeOfMotion& rom = anatomy.range_of_motion.at(disc->name);
        s.max += rom[motion].mean;
        s.min -= rom[flexion ? kExtension : motion].mean;
      }
      joint.limit = std::max({joint.limit, s.max, -s.min});
      joint.damping = s.kv / bending;  // which MuJoCo integrates implicitly
      s.kp /= bending;
      s.kv = 0;
    }
    joint.slack = joint.limit;
    a.joints.push_back(joint);
  }
  return a;
}

std::string simpleTrunkBody(const Anatomy& anatomy, const std::string& body) {
  const std::string name = splitSide(body).second;
  if (name == "clavicle" || name == "scapula") return "ribcage";
  if (body == "L5") return "pelvis";  // below the joint
  for (const Vertebra& v : anatomy.vertebrae) {
    if (v.name != body) continue;
    return v.region == Region::kLumbar     ? "abdomen"
           : v.region == Region::kThoracic ? "ribcage"
                                           : "neck";
  }
  return body;
}

}  // namespace torso::tools
