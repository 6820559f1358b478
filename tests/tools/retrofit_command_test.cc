// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// torso retrofit as a user runs it: what it writes, what it skips, what it says of broken clips.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/tools/clip_texts.h"
#include "tests/tools/command_fixture.h"
#include "tools/motion_file.h"
#include "tools/mujoco_support.h"

namespace torso::tools {
namespace {

using testing::HasSubstr;

class Retrofit : public Command {
 protected:
  // A bow of our own body, 25 degrees at each of the trunk's two joints.
  static std::string bow(size_t frames) {
    const Anatomy tables = Anatomy::load(TORSO_ANATOMY_DIR);
    const std::vector<TestJoint> joints = testPerson(tables);
    BvhStyle style;
    style.rate = 20;
    return bvhText(
        joints, frames,
        [&](size_t joint, size_t frame) -> Eigen::Matrix3d {
          const bool trunk = joints[joint].name == "spine" || joints[joint].name == "chest";
          const double share = 0.5 - 0.5 * std::cos(M_PI * static_cast<double>(frame) /
                                                    static_cast<double>(frames - 1));
          const double angle = trunk ? 25 * M_PI / 180 * share : 0;
          return Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()).toRotationMatrix();
        },
        [](size_t) { return Eigen::Vector3d(0, 0, 1); }, style);
  }
  std::filesystem::file_time_type timeOf(const std::string& name) {
    return std::filesystem::last_write_time(folder_ / name);
  }
};

TEST_F(Retrofit, WritesMotionsThatReloadAndResumes) {
  constexpr size_t kFrames = 10;
  const std::string good = bow(kFrames);
  std::filesystem::create_directory(folder_ / "clips");
  write("clips/bow.bvh", good);
  write("clips/cut.bvh", good.substr(0, good.size() * 9 / 10));
  write("clips/readme.txt", "not a clip");

  const Result first = run("retrofit clips -o out --jobs 2 --json");
  EXPECT_EQ(first.status, 1);
  EXPECT_THAT(first.err, HasSubstr("clips/cut.bvh: "));
  EXPECT_THAT(first.err, HasSubstr("1 failed, 1 went through"));
  const auto rows = nlohmann::json::parse(first.out);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0]["clip"], "bow");
  EXPECT_EQ(rows[0]["frames"], kFrames);
  EXPECT_LT(rows[0]["held_error_mm"]["p95"], 10);
  EXPECT_TRUE(rows[1].contains("error"));

  // The body leans forward by what the clip's joints turn, spread over its vertebrae.
  installHandlers();
  const std::string model = (folder_ / "out/bow.xml").string();
  const ModelPtr m = loadModel(model);
  const DataPtr d = makeData(m.get());
  for (const char* end : {".csv", ".bin"}) {
    const std::string path = (folder_ / "out/bow").string() + end;
    const Motion motion = motionOf(m.get(), readMotion(path), path);
    EXPECT_EQ(motion.rate, 20);
    ASSERT_EQ(motion.frames(), kFrames);
    mju_copy(d->qpos, motion.qpos.data() + (kFrames - 1) * m->nq, m->nq);
    mj_kinematics(m.get(), d.get());
    const mjtNum* ribs = d->xmat + 9 * mj_name2id(m.get(), mjOBJ_BODY, "ribcage");
    EXPECT_NEAR(std::atan2(ribs[2], ribs[8]) * 180 / M_PI, 50, 15);
  }
  EXPECT_EQ(readFile(folder_ / "out/bow.glb").substr(0, 4), "glTF");
  EXPECT_THAT(readFile(folder_ / "out/bow.bvh"), HasSubstr("Frames: 10"));
  EXPECT_THAT(readFile(folder_ / "out/bow_readouts.csv"), HasSubstr("L4/L5_flexion_deg"));
  const std::string summary = readFile(folder_ / "out/summary.csv");
  EXPECT_THAT(summary, HasSubstr("\nbow,clips/bow.bvh,10,20"));
  EXPECT_THAT(summary, HasSubstr("clips/cut.bvh"));

  // Done and newer than its clip: left alone, and yet in the table.
  const auto before = timeOf("out/bow.csv");
  const Result second = run("retrofit clips -o out --json");
  EXPECT_EQ(nlohmann::json::parse(second.out)[0], rows[0]);
  EXPECT_EQ(timeOf("out/bow.csv"), before);
  EXPECT_EQ(readFile(folder_ / "out/summary.csv"), summary);
  // Not if a file of it is gone.
  std::filesystem::remove(folder_ / "out/bow.glb");
  run("retrofit clips/bow.bvh -o out");
  EXPECT_GT(timeOf("out/bow.csv"), before);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/bow.glb"));
}

TEST_F(Retrofit, InterruptedLeavesNothingHalfWritten) {
  write("long.bvh", bow(1500));
  const Result result = run("retrofit long.bvh -o out", "timeout --signal=INT 3");
  EXPECT_NE(result.status, 0);
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "out")) {
    const std::string name = entry.path().filename().string();
    EXPECT_EQ(name, "scene.xml") << "left behind";
  }
}

TEST_F(Retrofit, SaysWhatIsMissing) {
  write("bow.bvh", bow(2));
  EXPECT_THAT(run("retrofit bow.bvh").err, HasSubstr("-o DIR"));
  const Result explained = run("retrofit bow.bvh --explain --write-map map.json");
  EXPECT_EQ(explained.status, 0) << explained.err;
  EXPECT_THAT(explained.out, HasSubstr("left_upper_arm"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "map.json"));
  std::filesystem::create_directory(folder_ / "empty");
  EXPECT_THAT(run("retrofit empty -o out").err, HasSubstr("there is no clip"));
  EXPECT_THAT(run("retrofit gone.bvh -o out").err, HasSubstr("gone.bvh"));
}

}  // namespace
}  // namespace torso::tools
