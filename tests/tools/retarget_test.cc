// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// From a clip to the poses of held bones: against motions of our own body, in which every pose is
// known.

#include "tools/retarget.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "model/limb_lengths.h"
#include "tests/tools/clip_texts.h"
#include "tools/error.h"
#include "tools/mujoco_support.h"
#include "tools/temporary_skeleton.h"

namespace torso::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using testing::HasSubstr;

constexpr size_t kFrames = 31;

const Anatomy& tables() {
  static const Anatomy a = Anatomy::load(TORSO_ANATOMY_DIR);
  return a;
}

double degreesBetween(const Matrix3d& a, const Matrix3d& b) {
  return Eigen::AngleAxisd(a.transpose() * b).angle() * 180 / M_PI;
}

struct Result {
  Performer performer;
  Targets targets;
  HeldMotion motion;
  Matrix3d turn(size_t f, int body) const {
    const auto& q = motion.quaternions[f * motion.bodies.size() + body];
    return Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
  }
  Vector3d place(size_t f, int body) const {
    return Vector3d(motion.positions[f * motion.bodies.size() + body].data());
  }
};

Result solve(const std::string& text) {
  const Clip clip = parseClips(text, "clip.bvh").at(0);
  const Roles roles = findRoles(clip, {}).at(0);
  Result r;
  r.performer = measurePerformer(tables(), clip, roles);
  r.targets = makeTargets(inWorld(clip, r.performer), roles, r.performer);
  r.motion = solveMotion(r.targets, r.performer, clip.name, clip.rate).motion;
  return r;
}

Vector3d way(size_t f) {
  return Vector3d(0.3 * std::sin(0.1 * static_cast<double>(f)), 0.02 * static_cast<double>(f), 1);
}

// Poses of a body of this anatomy in testTurn's motion, and what comes back from its clip.
void expectTruth(const Anatomy& a, const BvhStyle& style, bool arms_out = false) {
  std::vector<TestJoint> joints = testPerson(a);
  const auto turn = [&](size_t j, size_t f) {
    return testTurn(joints[j].name, static_cast<double>(f) / (kFrames - 1));
  };
  const std::vector<Isometry3d> truth = testPoses(joints, kFrames, turn, way);
  std::string text;
  if (arms_out) {
    // The same motion of a rig whose zero pose has the arms out to the sides.
    std::vector<TestJoint> rig = joints;
    const auto out = [&](const std::string& name) {
      const auto [side, part] = splitSide(name);
      const bool arm = part == "upper_arm" || part == "lower_arm" || part == "hand";
      return arm ? turnAbout(Vector3d::UnitX(), side == Side::kLeft ? 80 : -80)
                 : Matrix3d(Matrix3d::Identity());
    };
    for (size_t j = 0; j < rig.size(); j++) {
      const int parent = joints[j].parent;
      if (parent < 0) continue;
      rig[j].place =
          rig[parent].place + out(joints[parent].name) * (joints[j].place - joints[parent].place);
    }
    text = bvhText(
        rig, kFrames,
        [&](size_t j, size_t f) {
          const int parent = joints[j].parent;
          const Matrix3d before =
              parent < 0 ? Matrix3d(Matrix3d::Identity()) : out(joints[parent].name);
          return Matrix3d(before * turn(j, f) * out(joints[j].name).transpose());
        },
        way, style);
  } else {
    text = bvhText(joints, kFrames, turn, way, style);
  }
  const Result r = solve(text);
  EXPECT_NEAR(r.performer.anatomy.stature(), a.stature(), 0.002 * a.stature());
  double apart = 0, turned = 0;
  for (size_t j = 0; j < joints.size(); j++) {
    const auto held = std::find(r.motion.bodies.begin(), r.motion.bodies.end(),
                                joints[j].name == "hips" ? "pelvis" : joints[j].name);
    if (held == r.motion.bodies.end()) continue;
    const int body = static_cast<int>(held - r.motion.bodies.begin());
    EXPECT_TRUE(r.targets.has[body]) << *held;
    for (size_t f = 0; f < kFrames; f++) {
      const Isometry3d& X = truth[f * joints.size() + j];
      // The floor is where the feet stand, so that all is shifted up or down alike.
      const Vector3d shift = truth[0].translation() - r.place(0, kPelvis);
      const double miss = ((X.translation() - r.place(f, body)) - Vector3d(0, 0, shift.z())).norm();
      apart = std::max(apart, miss);
      EXPECT_LT(miss, 0.004) << *held << " " << f;
      turned = std::max(turned, degreesBetween(X.linear(), r.turn(f, body)));
      EXPECT_LT(degreesBetween(X.linear(), r.turn(f, body)), 1.5) << *held << " " << f;
      if (testing::Test::HasFailure()) return;
    }
  }
  for (size_t f = 0; f < kFrames; f++) EXPECT_TRUE(r.motion.flags[f].empty()) << f;
  fmt::print("largest miss {:.2f} mm, {:.2f} degrees\n", 1e3 * apart, turned);
}

TEST(RetargetTest, KnownMotionComesBack) { expectTruth(tables(), {}); }

TEST(RetargetTest, AnotherSizeUnitAndAxes) {
  const Anatomy tall = withLimbs(tables().scaled(1.08, 1.2), {{"thigh", 1.05},
                                                              {"shin", 1.05},
                                                              {"foot", 1.05},
                                                              {"upper_arm", 0.95},
                                                              {"lower_arm", 0.95},
                                                              {"hand", 0.95}});
  BvhStyle style;
  style.unit = 0.0254;
  style.axes = Matrix3d::Identity();  // z up
  expectTruth(tall, style);
}

TEST(RetargetTest, ArmsOutInTheRestPose) { expectTruth(tables(), {}, true); }

TEST(RetargetTest, SingleFrameIsAPose) {
  const auto joints = testPerson(tables());
  const Result r = solve(bvhText(
      joints, 1, [&](size_t j, size_t) { return testTurn(joints[j].name, 0.2); }, way));
  ASSERT_EQ(r.motion.frames(), 1u);
  EXPECT_LT(r.motion.position_errors[0], 0.003);
}

TEST(RetargetTest, QuaternionsAreContinuous) {
  const auto joints = testPerson(tables());
  // Two turns about the vertical and a somersault.
  const auto turn = [&](size_t j, size_t f) {
    const double s = static_cast<double>(f) / (kFrames - 1);
    return joints[j].parent < 0 ? Matrix3d(turnAbout(Vector3d::UnitZ(), 720 * s) *
                                           turnAbout(Vector3d::UnitY(), 360 * s))
                                : testTurn(joints[j].name, s);
  };
  const Result r = solve(bvhText(joints, kFrames, turn, way));
  const size_t bodies = r.motion.bodies.size();
  for (size_t k = bodies; k < r.motion.quaternions.size(); k++) {
    const Eigen::Map<const Eigen::Vector4d> a(r.motion.quaternions[k - bodies].data()),
        b(r.motion.quaternions[k].data());
    EXPECT_GT(a.dot(b), 0.8);
  }
}

// A person who stands while the hips sway and turn: hips of another width would make feet slide.
TEST(RetargetTest, StandingFeetStandStill) {
  std::vector<TestJoint> joints = testPerson(tables());
  // Narrower hips than ours.
  for (TestJoint& joint : joints) {
    const auto [side, part] = splitSide(joint.name);
    if (part == "thigh" || part == "shin" || part == "foot" || part == "toe_end") {
      joint.place.y() -= (side == Side::kLeft ? 1 : -1) * 0.02;
    }
  }
  const size_t frames = 60;
  // Legs swing with the hips held, then the whole is placed so that the left ankle stays.
  const auto turn = [&](size_t j, size_t f) {
    const double s = std::sin(2 * M_PI * static_cast<double>(f) / 59);
    const std::string& name = joints[j].name;
    if (name == "hips") return turnAbout(Vector3d::UnitZ(), 15 * s);
    if (name == "left_thigh") return turnAbout(Vector3d::UnitZ(), -15 * s);
    return Matrix3d(Matrix3d::Identity());
  };
  const size_t ankle =
      static_cast<size_t>(std::find_if(joints.begin(), joints.end(),
                                       [](const TestJoint& j) { return j.name == "left_foot"; }) -
                          joints.begin());
  const auto free = testPoses(joints, frames, turn, [](size_t) { return Vector3d(0, 0, 1); });
  const auto place = [&](size_t f) {
    return Vector3d(Vector3d(0, 0, 1) + free[ankle].translation() -
                    free[f * joints.size() + ankle].translation());
  };
  const Result r = solve(bvhText(joints, frames, turn, place));
  for (size_t f = 0; f < frames; f++) {
    EXPECT_EQ(r.targets.contact[f][0], 1);
    EXPECT_LT((r.place(f, heldBody(0, kFoot)) - r.place(0, heldBody(0, kFoot))).norm(), 0.002);
  }
  // Its sole is on the floor.
  const double above = tables().landmark("ankle").z() - tables().landmark("sole").z();
  EXPECT_NEAR(r.place(0, heldBody(0, kFoot)).z(), above * r.performer.anatomy.length_scale, 0.01);
}

TEST(RetargetTest, OnlyUpperBodyKeepsLegsAtRest) {
  const std::vector<TestJoint> joints = withoutLegs(testPerson(tables()));
  const Result r = solve(bvhText(
      joints, kFrames,
      [&](size_t j, size_t f) { return testTurn(joints[j].name, static_cast<double>(f) / 30); },
      way));
  EXPECT_FALSE(r.targets.has[heldBody(0, kThigh)]);
  EXPECT_TRUE(r.targets.has[heldBody(0, kUpperArm)]);
  for (size_t f = 0; f < kFrames; f++) {
    EXPECT_LT(degreesBetween(r.turn(f, kPelvis), r.turn(f, heldBody(0, kShin))), 0.1);
    EXPECT_LT(degreesBetween(r.turn(f, kPelvis), testTurn("hips", static_cast<double>(f) / 30)), 2);
  }
}

TEST(RetargetTest, BonesWithoutLengthAreTold) {
  std::vector<TestJoint> joints = testPerson(tables());
  for (TestJoint& joint : joints) joint.place.setZero();
  const std::string text = bvhText(
      joints, 2, [](size_t, size_t) { return Matrix3d(Matrix3d::Identity()); }, way);
  try {
    solve(text);
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("clip.bvh"));
    EXPECT_THAT(e.what(), HasSubstr("length"));
  }
}

// Bodies of the temporary skeleton that the detailed body has too are in the same places at rest.
TEST(TemporarySkeletonTest, RestsAsTheDetailedBody) {
  const ModelPtr m = compileModel(temporarySkeletonMjcf(tables()), "temporary");
  const DataPtr d = makeData(m.get());
  mj_kinematics(m.get(), d.get());
  for (const std::string body : {"pelvis", "head", "ribcage", "left_hand", "right_foot"}) {
    const int id = mj_name2id(m.get(), mjOBJ_BODY, body.c_str());
    ASSERT_GE(id, 0) << body;
    const Vector3d p(d->xpos + 3 * id);
    EXPECT_TRUE(p.isApprox(bodyFrame(tables(), body).translation(), 1e-5)) << body;
  }
}

}  // namespace
}  // namespace torso::tools
