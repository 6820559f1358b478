// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// torso stats: what it tells of a retrofitted bow, against what retrofit itself wrote of it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "model/csv.h"
#include "tests/tools/bow_clip.h"
#include "tests/tools/command_fixture.h"

namespace torso::tools {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class Stats : public Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    write("bow.bvh", bowClip(24));
    ASSERT_EQ(run("retrofit bow.bvh -o out").status, 0);
  }
  std::filesystem::file_time_type timeOf(const std::string& name) {
    return std::filesystem::last_write_time(folder_ / name);
  }
};

TEST_F(Stats, AgreeWithTheReadOutsAndAreKept) {
  const std::string command = "stats out --every 6 --json";
  const json first = runJson(command + " --plot figures");
  EXPECT_EQ(first["clips"], json({"bow"}));
  EXPECT_NEAR(first["seconds"], 24 / 20.0, 1e-9);
  // The outer 5 % of 24 frames: the least and the largest one.
  const CsvTable read((folder_ / "out/bow_readouts.csv").string());
  for (const json& level : first["whole"]["levels"]) {
    const auto range = [&](const std::string& motion) {
      std::vector<double> angles;
      for (int i = 0; i < read.rows(); i++) {
        angles.push_back(read.number(i, level["disc"].get<std::string>() + motion));
      }
      std::sort(angles.begin(), angles.end());
      return angles[22] - angles[1];
    };
    // The read-outs have 4 digits.
    EXPECT_NEAR(level["flexion_extension_deg"], range("_flexion_deg"), 5e-4);
    EXPECT_NEAR(level["axial_rotation_deg"], range("_axial_rotation_deg") / 2, 5e-4);
    EXPECT_EQ(level["collisions"], 0);
  }
  EXPECT_GT(first["whole"]["levels"][0]["flexion_extension_deg"], 1);

  // A spine without discs sinks together in the lumbar region, which bears most; one without
  // ligaments is held by its discs.
  const auto gap = [&](const char* kind, int level) {
    return first[kind]["levels"][level]["gap_mean_mm"].get<double>();
  };
  EXPECT_EQ(first["without_discs"]["levels"][1]["disc"], "L4/L5");
  EXPECT_LT(gap("without_discs", 1), gap("whole", 1) - 1);
  EXPECT_NEAR(gap("without_ligaments", 1), gap("whole", 1), 0.5);
  for (const char* name : {"rom.csv", "gaps.csv", "l5.csv", "stats.gp"}) {
    EXPECT_TRUE(std::filesystem::exists(folder_ / "figures" / name)) << name;
  }

  // What was solved again is not solved a third time, and can be rendered or viewed.
  const std::string kept = "out/without_discs/bow.bin";
  const auto before = timeOf(kept);
  EXPECT_EQ(runJson(command), first);
  EXPECT_EQ(timeOf(kept), before);
  // But for other frames.
  EXPECT_EQ(runJson("stats out --every 12 --json")["without_discs"]["frames"], 2);
  EXPECT_GT(timeOf(kept), before);
}

// Discs that are led through the motion bear what retrofit says they bear.
TEST_F(Stats, ReplayHasThePressuresOfTheReadOuts) {
  ASSERT_EQ(run("run out/bow.xml --motion out/bow.bin --csv replay.csv --rate 20").status, 0);
  const CsvTable read((folder_ / "out/bow_readouts.csv").string());
  const CsvTable replay((folder_ / "replay.csv").string());
  ASSERT_EQ(replay.rows(), read.rows());
  for (const std::string level : {"L4/L5", "T7/T8", "C5/C6"}) {
    for (const int i : {6, 12, 23}) {
      EXPECT_NEAR(replay.number(i, "pressure_" + level + "_mpa"),
                  read.number(i, level + "_pressure_mpa"), 3e-3)
          << level << ", frame " << i;
    }
  }
}

TEST_F(Stats, SaysWhatIsMissing) {
  std::filesystem::create_directory(folder_ / "empty");
  EXPECT_THAT(run("stats empty").err, HasSubstr("empty: no clip in it"));
  EXPECT_THAT(run("stats gone").err, HasSubstr("gone: no such folder"));
  // A clip whose motion is damaged is told, the other one counts.
  for (const char* end : {".xml", ".bin", ".json"}) {
    std::filesystem::copy(folder_ / (std::string("out/bow") + end),
                          folder_ / (std::string("out/cut") + end));
  }
  std::string mark = readFile(folder_ / "out/cut.json");
  const std::string name = "\"clip\": \"bow\"";
  write("out/cut.json", mark.replace(mark.find(name), name.size(), "\"clip\": \"cut\""));
  const std::string motion = readFile(folder_ / "out/bow.bin");
  write("out/cut.bin", motion.substr(0, motion.size() / 2));
  const Result result = run("stats out --only-whole --json");
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, HasSubstr("out/cut.bin: "));
  EXPECT_EQ(json::parse(result.out)["clips"], json({"bow"}));
}

}  // namespace
}  // namespace torso::tools
