// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Readers of motion capture files.

#include "tools/clip.h"

#include <assimp/scene.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <assimp/Exporter.hpp>
#include <assimp/Importer.hpp>

#include "tests/tools/clip_texts.h"
#include "tools/error.h"

namespace torso::tools {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;

// Two bones; the second joint has position channels of its own, in an order of their own.
const char* const kBvh =
    "HIERARCHY\r\nROOT My hips\r\n{\r\n OFFSET 0 0 0\r\n"
    " CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation\r\n"
    " JOINT knee { OFFSET 0 -4 0 CHANNELS 4 Yposition Xrotation Zrotation Yrotation\r\n"
    "  End Site { OFFSET 0 -3 0 } } }\r\n"
    "ROOT second\r\n{ OFFSET 9 0 0 CHANNELS 1 Xrotation End Site { OFFSET 0 1 0 } }\r\n"
    "MOTION\r\nFrames: 2\r\nFrame Time: 0.025\r\n"
    "1 2 3 90 0 0  -5 0 0 0  0\r\n"
    "1 2 3 0 90 90  -4 90 0 0  90\r\n";

std::string failure(const std::string& content, const std::string& path) {
  try {
    parseClips(content, path);
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(BvhTest, RootsNamesChannelsAndTimes) {
  const Clip clip = parseClips(kBvh, "a.bvh").at(0);
  ASSERT_EQ(clip.joints.size(), 5u);
  EXPECT_EQ(clip.joints[0].name, "My hips");
  EXPECT_EQ(clip.joints[3].parent, -1);
  EXPECT_TRUE(clip.joints[2].end);
  EXPECT_DOUBLE_EQ(clip.rate, 40);
  ASSERT_EQ(clip.frames(), 2u);
  const auto at = [&](size_t f, int j) { return Vector3d(clip.pose(f, j).translation()); };
  // Frame 1: turned by 90 degrees about z, so that down is +x; the knee's y replaces its offset's.
  EXPECT_TRUE(at(0, 1).isApprox(Vector3d(1 + 5, 2, 3))) << at(0, 1);
  EXPECT_TRUE(at(0, 2).isApprox(Vector3d(1 + 8, 2, 3)));
  // Frame 2: Ry(90) Rx(90) carries -y to -x (x by hand), then Rx(90) of the knee in that frame.
  EXPECT_TRUE(at(1, 1).isApprox(Vector3d(1 - 4, 2, 3))) << at(1, 1);
  EXPECT_TRUE(at(1, 2).isApprox(Vector3d(1 - 4, 2 + 3, 3))) << at(1, 2);
  EXPECT_TRUE(at(1, 4).isApprox(Vector3d(9, 0, 1)));
  EXPECT_TRUE(clip.rest[2].translation().isApprox(Vector3d(0, -7, 0)));
}

TEST(BvhTest, DamageIsToldWithItsPlace) {
  const std::string text = kBvh;
  EXPECT_THAT(failure(text.substr(0, text.size() - 20), "a.bvh"),
              AllOf(HasSubstr("a.bvh"), HasSubstr("cut short")));
  EXPECT_THAT(failure(text.substr(0, text.find("1 2 3 0")), "a.bvh"), HasSubstr("1 frames of 2"));
  EXPECT_THAT(failure(text.substr(0, text.find("JOINT")), "a.bvh"), HasSubstr("cut short"));
  EXPECT_THAT(failure(text.substr(0, text.find("MOTION")), "a.bvh"), HasSubstr("no MOTION"));
  EXPECT_THAT(failure(replaced(text, "-4 90", "nan 90"), "a.bvh"),
              AllOf(HasSubstr("frame 2"), HasSubstr("'knee'"), HasSubstr("Yposition")));
  EXPECT_THAT(failure(replaced(text, "Frames: 2", "Frames: 0"), "a.bvh"), HasSubstr("empty"));
  EXPECT_THAT(failure(replaced(text, "0.025", "0"), "a.bvh"), HasSubstr("Frame Time"));
  EXPECT_THAT(failure(replaced(text, "Zrotation", "Wrotation"), "a.bvh"), HasSubstr("wrotation"));
  EXPECT_THAT(failure(text + "1 2 3", "a.bvh"), HasSubstr("Frames or CHANNELS"));
  EXPECT_THAT(failure("HIERARCHY\nMOTION\n", "a.bvh"), HasSubstr("no skeleton"));
  EXPECT_THAT(failure("", "a.bvh"), HasSubstr("empty"));
  EXPECT_THAT(failure(text, "a.fbx"), HasSubstr("a.fbx"));
  EXPECT_THAT(failure(text, "a.txt"), HasSubstr(".bvh, .fbx"));
}

TEST(ClipTest, ResamplingKeepsTheWay) {
  const Clip clip = parseClips(kBvh, "a.bvh").at(0);
  const Clip twice = resampled(clip, 80);
  ASSERT_EQ(twice.frames(), 3u);
  EXPECT_DOUBLE_EQ(twice.rate, 80);
  EXPECT_TRUE(twice.pose(2, 2).isApprox(clip.pose(1, 2)));
  const Vector3d middle = 0.5 * (clip.pose(0, 1).translation() + clip.pose(1, 1).translation());
  EXPECT_TRUE(twice.pose(1, 1).translation().isApprox(middle));
}

// assimp splits such a joint into several nodes; here it is one, turned once.
TEST(FbxTest, PivotsAreOneJoint) {
  const Clip clip = parseClips(fbxText(), "a.fbx").at(0);
  ASSERT_EQ(clip.joints.size(), 3u);
  EXPECT_EQ(clip.joints[2].parent, 1);
  EXPECT_NEAR(clip.rate, 30, 0.01);
  EXPECT_DOUBLE_EQ(clip.unit.value(), 0.01);
  ASSERT_EQ(clip.frames(), 4u);
  // PreRotation carries y to z; before it, b's own turn about z carries y to -x.
  for (size_t f = 0; f < 4; f++) {
    const double angle = static_cast<double>(f) * M_PI / 6;
    const Vector3d expected(-10 * std::sin(angle), 10, 10 * std::cos(angle));
    EXPECT_LT((clip.pose(f, 2).translation() - expected).norm(), 1e-3) << f;
  }
  EXPECT_THAT(failure(fbxText().substr(0, 900), "a.fbx"), HasSubstr("a.fbx"));
}

// assimp's own reader and writer are the independent way from a BVH to glTF. (What assimp 5.2
// writes as FBX it cannot read.)
TEST(GltfTest, SameMotionAsTheBvh) {
  const Anatomy a = Anatomy::load(TORSO_ANATOMY_DIR);
  const auto joints = testPerson(a);
  const size_t frames = 7;
  const std::string text = bvhText(
      joints, frames, [&](size_t j, size_t f) { return testTurn(joints[j].name, f / 12.0); },
      [](size_t f) { return Vector3d(0.01 * static_cast<double>(f), 0, 1); });
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFileFromMemory(text.data(), text.size(), 0, "bvh");
  ASSERT_NE(scene, nullptr);
  Assimp::Exporter exporter;
  const aiExportDataBlob* blob = exporter.ExportToBlob(scene, "glb2");
  ASSERT_NE(blob, nullptr);
  const std::string bytes(static_cast<const char*>(blob->data), blob->size);
  const std::string path = "a.glb";
  const Clip clip = parseClips(bytes, path).at(0), expected = parseClips(text, "a.bvh").at(0);
  EXPECT_NEAR(clip.rate, expected.rate, 1e-2 * expected.rate);
  ASSERT_EQ(clip.frames(), expected.frames());
  int compared = 0;
  for (size_t j = 0; j < clip.joints.size(); j++) {
    for (size_t k = 0; k < expected.joints.size(); k++) {
      if (clip.joints[j].name != expected.joints[k].name) continue;
      compared++;
      for (size_t f = 0; f < frames; f++) {
        const Vector3d p = clip.pose(f, static_cast<int>(j)).translation(),
                       q = expected.pose(f, static_cast<int>(k)).translation();
        EXPECT_LT((p - q).norm(), 0.05) << clip.joints[j].name << " " << f;  // of 180
      }
    }
  }
  EXPECT_GE(compared, 18);
  EXPECT_THAT(failure(bytes.substr(0, bytes.size() / 3), path),
              AllOf(HasSubstr(path), HasSubstr("cut short")));
}

}  // namespace
}  // namespace torso::tools
