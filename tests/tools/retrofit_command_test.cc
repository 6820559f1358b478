// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// torso retrofit as a user runs it: what it writes, what it skips, what it says of broken clips.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <sstream>

#include "tests/tools/bow_clip.h"
#include "tests/tools/command_fixture.h"
#include "tools/motion_file.h"
#include "tools/mujoco_support.h"

namespace torso::tools {
namespace {

using testing::HasSubstr;

class Retrofit : public Command {
 protected:
  std::filesystem::file_time_type timeOf(const std::string& name) {
    return std::filesystem::last_write_time(folder_ / name);
  }
};

TEST_F(Retrofit, WritesMotionsThatReloadAndResumes) {
  constexpr size_t kFrames = 10;
  const std::string good = bowClip(kFrames);
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
  EXPECT_LT(rows[0]["reached_error_mm"]["median"], 3);
  EXPECT_LT(rows[0]["largest_own_jump_deg"], 1);
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
  // As many cells in each row.
  std::istringstream lines(summary);
  std::string header, row;
  std::getline(lines, header);
  while (std::getline(lines, row)) {
    if (row.find('"') == std::string::npos) {
      EXPECT_EQ(std::count(row.begin(), row.end(), ','),
                std::count(header.begin(), header.end(), ','));
    }
  }

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

  // The folder may move: all that its models need is in it.
  std::filesystem::rename(folder_ / "out", folder_ / "moved");
  EXPECT_EQ(readFile(folder_ / "moved/bow.xml").find("file=\"/"), std::string::npos);
  EXPECT_EQ(run("info moved/bow.xml").status, 0);
}

TEST_F(Retrofit, InterruptedLeavesNothingHalfWritten) {
  write("long.bvh", bowClip(1500));
  const Result result = run("retrofit long.bvh -o out", "timeout --signal=INT 3");
  EXPECT_NE(result.status, 0);
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "out")) {
    const std::string name = entry.path().filename().string();
    EXPECT_TRUE(name == "scene.xml" || name == "assets") << name << " was left behind";
  }
}

// Clips that a user may have lying about, in one batch: each is told by its name and what to do,
// and the good one goes through.
TEST_F(Retrofit, BadClipsAreToldAndStopNothing) {
  std::filesystem::create_directory(folder_ / "bad");
  const std::string good = bowClip(2);
  const auto replaced = [&good](const std::string& from, const std::string& to) {
    std::string text = good;
    return text.replace(text.find(from), from.size(), to);
  };
  const std::size_t motion = good.find("Frame Time");
  const std::size_t first = good.find('\n', motion) + 1;
  std::string thin = good;  // all bones without length
  for (std::size_t at = 0; (at = thin.find("OFFSET", at)) != std::string::npos; at++) {
    thin.replace(at, thin.find('\n', at) - at, "OFFSET 0 0 0");
  }
  const std::string rows = good.substr(first);
  const std::vector<std::array<std::string, 3>> clips = {
      {"nothing.bvh", "", "empty"},
      {"no_frames.bvh", replaced("Frames: 2", "Frames: 0"), "empty"},
      {"cut.bvh", good.substr(0, good.size() * 9 / 10), "cut short"},
      {"nan.bvh", good.substr(0, first) + "nan" + rows.substr(rows.find(' ')), "frame 1"},
      {"thin.bvh", thin, "length"},
      {"no_skeleton.bvh", "HIERARCHY\nMOTION\nFrames: 1\nFrame Time: 0.1\n", "no skeleton"},
      {"tail.bvh",
       "HIERARCHY\nROOT tail\n{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nEnd "
       "Site\n{\nOFFSET 0 1 0\n}\n}\nMOTION\nFrames: 1\nFrame Time: 0.1\n0 0 0\n",
       "no arms and no legs"},
      {"picture.glb", "\x89PNG and so on", "picture.glb"}};
  for (const auto& [name, text, message] : clips) write("bad/" + name, text);
  write("bad/one_frame.bvh",
        replaced("Frames: 2", "Frames: 1").substr(0, first + rows.find('\n') + 1));
  const Result result = run("retrofit bad -o out --json");
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, HasSubstr(std::to_string(clips.size()) + " failed, 1 went through"));
  std::istringstream lines(result.err);
  std::map<std::string, std::string> told;
  for (std::string line; std::getline(lines, line);) {
    for (const auto& clip : clips) {
      if (line.find("bad/" + clip[0] + ": ") != std::string::npos) told[clip[0]] = line;
    }
  }
  for (const auto& [name, text, message] : clips) EXPECT_THAT(told[name], HasSubstr(message));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/one_frame.glb"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/thin.glb"));
}

// As a power cut would: what is done stays, the rest is done by the same command.
TEST_F(Retrofit, AKilledBatchGoesOn) {
  std::filesystem::create_directory(folder_ / "clips");
  write("clips/a.bvh", bowClip(2));
  write("clips/b.bvh", bowClip(3000));
  const std::string line = "cd " + folder_.string() +
                           " && " TORSO_COMMAND
                           " retrofit clips -o out >/dev/null 2>&1 & pid=$!; for i in $(seq 600); "
                           "do [ -e " +
                           (folder_ / "out/a.json").string() +
                           " ] && break; sleep 0.1; done; kill -KILL $pid; wait $pid";
  EXPECT_NE(std::system(("sh -c '" + line + "' >/dev/null 2>&1").c_str()), 0);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/b.json"));
  const auto before = timeOf("out/a.csv");
  write("clips/b.bvh", bowClip(3));  // for the test's time
  const Result result = run("retrofit clips -o out");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(timeOf("out/a.csv"), before);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/b.json"));
}

TEST_F(Retrofit, ProcessesShareTheClips) {
  if (!*MPIRUN) GTEST_SKIP() << "mpirun or MPI's headers are not installed (libopenmpi-dev)";
  std::filesystem::create_directory(folder_ / "clips");
  for (const char* name : {"a", "b", "c"}) write(std::string("clips/") + name + ".bvh", bowClip(2));
  write("clips/d.bvh", "");
  const std::string line = "cd " + folder_.string() +
                           " && " MPIRUN " --oversubscribe --allow-run-as-root -n 2 " TORSO_COMMAND
                           " retrofit clips -o out --json > out.txt 2> err.txt < /dev/null";
  EXPECT_NE(std::system(line.c_str()), 0);  // for clip d
  EXPECT_THAT(readFile(folder_ / "err.txt"), HasSubstr("1 failed, 3 went through"));
  const auto rows = nlohmann::json::parse(readFile(folder_ / "out.txt"), nullptr, false);
  ASSERT_EQ(rows.size(), 4u);
  for (int i = 0; i < 3; i++)
    EXPECT_EQ(rows[i]["clip"], std::string(1, static_cast<char>('a' + i)));
  const std::string summary = readFile(folder_ / "out/summary.csv");
  for (const char* name : {"\na,", "\nb,", "\nc,", "clips/d.bvh: "}) {
    EXPECT_THAT(summary, HasSubstr(name));
  }
}

TEST_F(Retrofit, SaysWhatIsMissing) {
  write("bow.bvh", bowClip(2));
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
