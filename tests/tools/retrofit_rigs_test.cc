// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// The same take in two rigs gives the same spine.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "tests/tools/clip_texts.h"
#include "tools/performer.h"
#include "tools/retarget.h"
#include "tools/retrofit.h"

namespace torso::tools {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr size_t kFrames = 31;
constexpr double kRate = 30;  // [Hz]

const Anatomy& tables() {
  static const Anatomy a = Anatomy::load(TORSO_ANATOMY_DIR);
  return a;
}

RetrofitResult spineOf(const std::string& bvh) {
  const Clip clip = parseClips(bvh, "clip.bvh").at(0);
  const Roles roles = findRoles(clip, {}).at(0);
  const Performer performer = measurePerformer(tables(), clip, roles);
  const Targets targets = makeTargets(inWorld(clip, performer), roles, performer);
  const HeldMotion motion = solveMotion(targets, performer, "take", clip.rate).motion;
  const std::string meshes = TORSO_MJCF "/assets";
  const RetrofitModels models(BodyMjcf(performerMjcf(tables(), performer, meshes, meshes), "take"));
  return retrofit(models, motion, RetrofitOptions());
}

Vector3d way(size_t f) { return {0.01 * static_cast<double>(f), 0, 1}; }

Matrix3d turnAt(const std::string& name, size_t f) {
  return testTurn(name, static_cast<double>(f) / (kFrames - 1));
}

// Centimetres, y up, arms at the sides in the rest pose, two joints of the trunk, clavicles.
std::string plainRig() {
  const std::vector<TestJoint> joints = testPerson(tables());
  BvhStyle style;
  style.rate = kRate;
  return bvhText(
      joints, kFrames, [&](size_t j, size_t f) { return turnAt(joints[j].name, f); }, way, style);
}

// Inches, z up, arms out in the rest pose, Mixamo's names, three joints of the trunk over which the
// lower one's turn is spread; root, hips, shoulders and neck one to four centimetres elsewhere.
std::string otherRig() {
  const std::map<std::string, std::string> names = {
      {"hips", "Hips"},         {"spine", "Spine"}, {"spine1", "Spine1"},     {"chest", "Spine2"},
      {"neck", "Neck"},         {"head", "Head"},   {"clavicle", "Shoulder"}, {"upper_arm", "Arm"},
      {"lower_arm", "ForeArm"}, {"hand", "Hand"},   {"thigh", "UpLeg"},       {"shin", "Leg"},
      {"foot", "Foot"}};
  std::vector<TestJoint> person = testPerson(tables());
  for (TestJoint& joint : person) {
    const auto [side, part] = splitSide(joint.name);
    const double left = side == Side::kRight ? -1 : 1;
    if (part == "upper_arm") joint.place += Vector3d(0, 0.010 * left, 0.005);
    if (part == "thigh") joint.place += Vector3d(0.005, 0.010 * left, 0);
    if (part == "hips") joint.place += Vector3d(0, 0, 0.04);
    if (part == "neck") joint.place += Vector3d(-0.01, 0, 0.01);
  }
  // Another joint between "spine" (1) and "chest" (2).
  person.insert(person.begin() + 2,
                {"spine1", 1, (0.5 * (person[1].place + person[2].place)).eval()});
  for (size_t j = 3; j < person.size(); j++) {
    if (person[j].parent >= 2) person[j].parent++;
  }
  person[3].parent = 2;
  const auto out = [&](size_t j) {
    const auto [side, part] = splitSide(person[j].name);
    const bool arm = part == "upper_arm" || part == "lower_arm" || part == "hand";
    return arm ? turnAbout(Vector3d::UnitX(), side == Side::kLeft ? 80 : -80)
               : Matrix3d(Matrix3d::Identity());
  };
  std::vector<TestJoint> rig = person;
  for (size_t j = 1; j < rig.size(); j++) {
    const auto parent = static_cast<size_t>(person[j].parent);
    rig[j].place = rig[parent].place + out(parent) * (person[j].place - person[parent].place);
    if (rig[j].end) continue;
    const auto [side, part] = splitSide(person[j].name);
    const std::string prefix = side == Side::kMiddle ? "" : side == Side::kLeft ? "Left" : "Right";
    rig[j].name = "mixamorig:" + prefix + names.at(part);
  }
  rig[0].name = "mixamorig:Hips";
  const auto turn = [&](size_t j, size_t f) {
    const std::string& name = person[j].name;
    Matrix3d R = turnAt(name, f);
    if (name == "spine" || name == "spine1") {
      const Eigen::AngleAxisd whole(turnAt("spine", f));
      R = Eigen::AngleAxisd(whole.angle() / 2, whole.axis()).toRotationMatrix();
    }
    const int parent = person[j].parent;
    const Matrix3d before =
        parent < 0 ? Matrix3d(Matrix3d::Identity()) : out(static_cast<size_t>(parent));
    return Matrix3d(before * R * out(j).transpose());
  };
  BvhStyle style;
  style.unit = 0.0254;
  style.axes = Matrix3d::Identity();
  style.rate = kRate;
  return bvhText(rig, kFrames, turn, way, style);
}

TEST(RetrofitTest, TheSameTakeInTwoRigsGivesTheSameSpine) {
  const RetrofitResult a = spineOf(plainRig()), b = spineOf(otherRig());
  ASSERT_EQ(a.frames.size(), kFrames);
  ASSERT_EQ(b.frames.size(), kFrames);
  const size_t levels = a.frames[0].pressures.size();
  double sum = 0, worst = 0, motion = 0;
  for (size_t i = 0; i < levels; i++) {
    double level = 0;
    for (size_t f = 0; f < kFrames; f++) {
      level += (a.frames[f].turns[i] - b.frames[f].turns[i]).squaredNorm() / kFrames;
      motion = std::max(motion, a.frames[f].turns[i].norm());
    }
    sum += level / static_cast<double>(levels);
    worst = std::max(worst, level);
  }
  constexpr double kDegrees = 180 / M_PI;
  fmt::print("rms {:.2f} deg, at the worst level {:.2f} deg; levels turn up to {:.1f} deg\n",
             kDegrees * std::sqrt(sum), kDegrees * std::sqrt(worst), kDegrees * motion);
  EXPECT_LT(kDegrees * std::sqrt(sum), 3);
  EXPECT_LT(kDegrees * std::sqrt(worst), 3);
  EXPECT_GT(kDegrees * motion, 4);  // or there would be nothing to differ in
}

}  // namespace
}  // namespace torso::tools
