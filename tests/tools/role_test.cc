// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Which joint is what, in rigs of different makers.

#include "tools/role.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/tools/clip_texts.h"
#include "tools/error.h"

namespace torso::tools {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using testing::HasSubstr;
using Rename = std::function<std::string(const std::string&)>;

const Anatomy& anatomy() {
  static const Anatomy a = Anatomy::load(TORSO_ANATOMY_DIR);
  return a;
}

Clip clipOf(const std::vector<TestJoint>& joints,
            const std::vector<TestJoint>& plain = testPerson(anatomy())) {
  const size_t frames = 12;
  return parseClips(bvhText(
                        joints, frames,
                        [&](size_t j, size_t f) {
                          return j < plain.size() ? testTurn(plain[j].name, f / 12.0)
                                                  : Matrix3d(Matrix3d::Identity());
                        },
                        [](size_t) { return Vector3d(0, 0, 1); }),
                    "clip.bvh")
      .at(0);
}

Roles rolesOf(const Clip& clip, const PartMap& map = {}) { return findRoles(clip, map).at(0); }

std::string failure(const Clip& clip, const PartMap& map = {}) {
  try {
    findRoles(clip, map);
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

// By the order of testPerson.
void expectPerson(const Clip& clip, const Roles& r, const Rename& rename) {
  const auto named = [&](int joint, const std::string& plain) {
    ASSERT_GE(joint, 0) << plain;
    EXPECT_EQ(clip.joints[joint].name, rename(plain));
  };
  named(r.hips, "hips");
  named(r.head, "head");
  named(r.chest(), "chest");
  for (int k = 0; k < 2; k++) {
    const std::string side = k ? "right_" : "left_";
    named(r.upper_arm[k], side + "upper_arm");
    named(r.lower_arm[k], side + "lower_arm");
    named(r.hand[k], side + "hand");
    named(r.thigh[k], side + "thigh");
    named(r.shin[k], side + "shin");
    named(r.foot[k], side + "foot");
  }
}

// A maker's words for hips, spine, chest, neck, head, clavicle, upper arm, lower arm, hand, thigh,
// shin, foot; "@" is the side.
struct Maker {
  const char* name;
  std::array<const char*, 12> words;
  const char *left, *right;
};

const Maker kMakers[] = {
    {"Mixamo",
     {"mixamorig:Hips", "mixamorig:Spine", "mixamorig:Spine1", "mixamorig:Neck", "mixamorig:Head",
      "mixamorig:@Shoulder", "mixamorig:@Arm", "mixamorig:@ForeArm", "mixamorig:@Hand",
      "mixamorig:@UpLeg", "mixamorig:@Leg", "mixamorig:@Foot"},
     "Left",
     "Right"},
    {"Max",
     {"Hips", "Chest", "Chest2", "Neck", "Head", "@Collar", "@Shoulder", "@Elbow", "@Wrist", "@Hip",
      "@Knee", "@Ankle"},
     "Left",
     "Right"},
    {"Daz",
     {"hip", "abdomen", "chest", "neck", "head", "@Collar", "@Shldr", "@ForeArm", "@Hand", "@Thigh",
      "@Shin", "@Foot"},
     "l",
     "r"},
    {"Character Studio",
     {"Bip01 Pelvis", "Bip01 Spine", "Bip01 Spine1", "Bip01 Neck", "Bip01 Head", "Bip01 @ Clavicle",
      "Bip01 @ UpperArm", "Bip01 @ Forearm", "Bip01 @ Hand", "Bip01 @ Thigh", "Bip01 @ Calf",
      "Bip01 @ Foot"},
     "L",
     "R"},
    {"MakeHuman",
     {"root", "spine05", "spine01", "neck01", "head", "clavicle.@", "upperarm01.@", "lowerarm01.@",
      "wrist.@", "upperleg01.@", "lowerleg01.@", "foot.@"},
     "L",
     "R"},
    {"Unreal",
     {"pelvis", "spine_01", "spine_02", "neck_01", "head", "clavicle_@", "upperarm_@", "lowerarm_@",
      "hand_@", "thigh_@", "calf_@", "foot_@"},
     "l",
     "r"}};

Rename renamer(const Maker& maker) {
  return [&maker](const std::string& plain) {
    static const char* const kPlain[] = {"hips", "spine",    "chest",     "neck",
                                         "head", "clavicle", "upper_arm", "lower_arm",
                                         "hand", "thigh",    "shin",      "foot"};
    const auto [side, part] = splitSide(plain);
    for (size_t k = 0; k < 12; k++) {
      if (part != kPlain[k]) continue;
      std::string name = maker.words[k];
      const size_t at = name.find('@');
      if (at != std::string::npos)
        name.replace(at, 1, side == Side::kLeft ? maker.left : maker.right);
      return name;
    }
    return plain;
  };
}

TEST(RoleTest, MakersNames) {
  for (const Maker& maker : kMakers) {
    SCOPED_TRACE(maker.name);
    const Rename rename = renamer(maker);
    const Clip clip = clipOf(testPerson(anatomy(), rename));
    const Roles roles = rolesOf(clip);
    expectPerson(clip, roles, rename);
    for (const RecognisedPart& p : roles.recognised) EXPECT_EQ(p.sureness, "sure") << p.part;
  }
}

// Without names the tree, the lengths and the toes must do, and it says that it is less sure.
TEST(RoleTest, UnnamedJoints) {
  std::map<std::string, std::string> names;
  const Rename rename = [&](const std::string& plain) {
    return names.emplace(plain, fmt::format("bone{:02}", names.size())).first->second;
  };
  const Clip clip = clipOf(testPerson(anatomy(), rename));
  const Roles roles = rolesOf(clip);
  expectPerson(clip, roles, rename);
  for (const RecognisedPart& p : roles.recognised) {
    if (p.part != "left_thigh" && p.part != "right_hand") continue;
    EXPECT_EQ(p.sureness, "likely") << p.part;
  }
}

TEST(RoleTest, MissingPartsAndManySpineJoints) {
  std::vector<TestJoint> joints = testPerson(anatomy());
  // No clavicles, no neck: their children go to their parents.
  const auto drop = [&](const std::string& name) {
    for (size_t j = 0; j < joints.size(); j++) {
      if (joints[j].name != name) continue;
      const int parent = joints[j].parent;
      joints.erase(joints.begin() + static_cast<long>(j));
      for (TestJoint& other : joints) {
        if (other.parent == static_cast<int>(j)) other.parent = parent;
        if (other.parent > static_cast<int>(j)) other.parent--;
      }
      return;
    }
  };
  for (const char* name : {"neck", "left_clavicle", "right_clavicle"}) drop(name);
  const Rename same = [](const std::string& n) { return n; };
  Clip clip = clipOf(joints, joints);
  Roles roles = rolesOf(clip);
  expectPerson(clip, roles, same);
  EXPECT_TRUE(roles.neck.empty());
  EXPECT_TRUE(roles.clavicle[0].empty());
  drop("spine");
  clip = clipOf(joints, joints);
  roles = rolesOf(clip);
  expectPerson(clip, roles, same);
  EXPECT_EQ(roles.trunk.size(), 1u);
}

TEST(RoleTest, OnlyUpperBodyIsSaid) {
  const std::vector<TestJoint> joints = withoutLegs(testPerson(anatomy()));
  const Clip clip = clipOf(joints, joints);
  const Roles roles = rolesOf(clip);
  EXPECT_TRUE(roles.hasArms());
  EXPECT_FALSE(roles.hasLegs());
  EXPECT_EQ(clip.joints[roles.hips].name, "hips");
}

TEST(RoleTest, SeveralPersonsInOneFile) {
  std::vector<TestJoint> joints = testPerson(anatomy());
  const size_t count = joints.size();
  for (size_t j = 0; j < count; j++) {
    TestJoint other = joints[j];
    other.name = "b_" + other.name;
    if (other.parent >= 0) other.parent += static_cast<int>(count);
    other.place.x() += 2;
    joints.push_back(other);
  }
  const Clip clip = clipOf(joints);
  const std::vector<Roles> roles = findRoles(clip, {});
  ASSERT_EQ(roles.size(), 2u);
  EXPECT_EQ(clip.joints[roles[0].hips].name, "hips");
  EXPECT_EQ(clip.joints[roles[1].hips].name, "b_hips");
  expectPerson(clip, roles[1], [](const std::string& n) { return "b_" + n; });
}

TEST(RoleTest, MapCorrectsAndIsWrittenAsRead) {
  const Clip clip = clipOf(testPerson(anatomy()));
  PartMap map;
  map.path = "map.json";
  map.bodies = {{"hips", {"spine"}}, {"trunk", {"chest"}}, {"head", {}}};
  const Roles roles = rolesOf(clip, map);
  EXPECT_EQ(clip.joints[roles.hips].name, "spine");
  EXPECT_EQ(roles.head, -1);
  EXPECT_EQ(roles.recognised[0].sureness, "given");
  map.bodies = {{"hips", {"nose"}}};
  EXPECT_THAT(failure(clip, map), HasSubstr("no joint 'nose'"));
  // What was recognised, given back, is the same.
  const Roles found = rolesOf(clip);
  const Roles again = rolesOf(clip, mapOf(clip, found));
  expectPerson(clip, again, [](const std::string& n) { return n; });
  EXPECT_EQ(again.trunk, found.trunk);
  EXPECT_EQ(again.clavicle, found.clavicle);
}

TEST(RoleTest, AnimalsAndThingsAreRefused) {
  // The person on all fours in the rest pose, with arms as long as legs.
  std::vector<TestJoint> joints = testPerson(anatomy());
  const auto front = [](const std::string& part) {
    return part == "clavicle" || part == "upper_arm" || part == "lower_arm" || part == "hand" ||
           part == "hand_end";
  };
  std::map<std::string, Vector3d> places;
  for (TestJoint& joint : joints) {
    const auto [side, part] = splitSide(joint.name);
    const double y = side == Side::kMiddle ? 0 : side == Side::kLeft ? 0.1 : -0.1;
    if (side == Side::kMiddle) joint.place = Vector3d(joint.place.z(), 0, 0);
    if (part == "thigh" || front(part)) joint.place = Vector3d(front(part) ? 0.5 : 0, y, -0.05);
    const std::map<std::string, double> depth = {
        {"clavicle", 0},    {"upper_arm", 0.1}, {"lower_arm", 0.4}, {"hand", 0.75},
        {"hand_end", 0.85}, {"shin", 0.4},      {"foot", 0.8},      {"toe_end", 0.85}};
    if (depth.count(part)) joint.place = Vector3d(front(part) ? 0.5 : 0, y, -0.05 - depth.at(part));
  }
  const size_t frames = 4;
  const Clip clip =
      parseClips(bvhText(
                     joints, frames, [](size_t, size_t) { return Matrix3d(Matrix3d::Identity()); },
                     [](size_t) { return Vector3d(0, 0, 1); }),
                 "dog.bvh")
          .at(0);
  EXPECT_THAT(failure(clip), HasSubstr("four legs"));
  std::vector<TestJoint> chain = {{"a", -1, Vector3d::Zero()},
                                  {"b", 0, Vector3d(0, 0, 1)},
                                  {"c", 1, Vector3d(0, 0, 2)},
                                  {"end", 2, Vector3d(0, 0, 3), true}};
  EXPECT_THAT(failure(clipOf(chain, chain)), HasSubstr("no arms and no legs"));
}

}  // namespace
}  // namespace torso::tools
