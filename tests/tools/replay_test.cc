// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// torso run, render and view --motion as a user runs them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <dlfcn.h>

#include "tests/tools/bow_clip.h"
#include "tests/tools/command_fixture.h"
#include "tests/tools/picture.h"
#include "tools/motion_file.h"
#include "tools/mujoco_support.h"

namespace torso::tools {
namespace {

using testing::HasSubstr;

constexpr char kHuman[] = TORSO_MJCF "/human.xml";
constexpr double kRise = 0.3;  // [m]

const mjModel* human() {
  static const ModelPtr m = loadModel(kHuman);
  return m.get();
}

// The standing body at rest rises by kRise in 0.5 s.
Motion rise() {
  const mjModel* m = human();
  Motion motion = {10, qposColumns(m), {}};
  for (int frame = 0; frame <= 5; frame++) {
    std::vector<mjtNum> qpos(m->qpos0, m->qpos0 + m->nq);
    for (int j = 0; j < m->njnt; j++) {
      if (m->jnt_type[j] == mjJNT_FREE) qpos[m->jnt_qposadr[j] + 2] += kRise * frame / 5;
    }
    motion.qpos.insert(motion.qpos.end(), qpos.begin(), qpos.end());
  }
  return motion;
}

class Replay : public Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    write("rise.bin", motionBinary(rise()));
    write("rise.csv", motionCsv(rise()));
  }
  std::string render(const std::string& options) const {
    return std::string("render ") + kHuman +
           " --width 120 --height 160 --azimuth 90 --elevation 0 " + options;
  }
};

// Columns of a time series.
std::vector<double> column(const std::string& csv, const std::string& name) {
  std::istringstream lines(csv);
  std::vector<double> values;
  int wanted = -1;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    std::string cell;
    for (int k = 0; std::getline(cells, cell, ','); k++) {
      if (wanted < 0 && cell == name)
        wanted = k;
      else if (wanted >= 0 && k == wanted && cell != name)
        values.push_back(std::stod(cell));
    }
  }
  return values;
}

TEST_F(Replay, RunMovesAsTheMotionAndMeasures) {
  const auto result = runJson(std::string("run ") + kHuman +
                              " --motion rise.bin --csv series.csv --rate 20 --json");
  EXPECT_NEAR(result["simulated_s"], 0.5, 0.002);
  EXPECT_EQ(result["warnings"], 0);
  const std::string csv = readFile(folder_ / "series.csv");
  const std::vector<double> heights = column(csv, "com_z_m"),
                            energy = column(csv, "kinetic_energy_j");
  ASSERT_EQ(heights.size(), 11u);
  for (std::size_t i = 0; i < heights.size(); i++) {
    EXPECT_NEAR(heights[i] - heights[0], kRise * i / 10, 2e-3);
  }
  double mass = 0;
  for (int b = 0; b < human()->nbody; b++) mass += human()->body_mass[b];
  EXPECT_NEAR(energy[5], 0.5 * mass * std::pow(kRise / 0.5, 2), 0.05);
  // Discs that nothing has moved are at rest; gravity does not act in a replay.
  for (const double pressure : column(csv, "pressure_L4/L5_mpa")) EXPECT_NEAR(pressure, 0, 1e-3);
  EXPECT_NE(run(std::string("run ") + kHuman + " --motion rise.bin --seeds 2").status, 0);
}

TEST_F(Replay, RenderShowsTheTimeAskedFor) {
  ASSERT_EQ(run(render("-o rest.png --lookat 0 0 1 --distance 3.5")).status, 0);
  ASSERT_EQ(
      run(render("-o first.png --motion rise.csv --time 0 --lookat 0 0 1 --distance 3.5")).status,
      0);
  ASSERT_EQ(
      run(render("-o late.png --motion rise.bin --time 0.4 --lookat 0 0 1 --distance 3.5")).status,
      0);
  const std::string rest = readFile(folder_ / "rest.png");
  EXPECT_EQ(readFile(folder_ / "first.png"), rest);
  EXPECT_NE(readFile(folder_ / "late.png"), rest);
}

TEST_F(Replay, FilmsAreFilesOrPictures) {
  // Without ffmpeg: a folder of pictures, of which the first one is that of the start.
  const Result pictures = run(render("--motion rise.bin --video a.gif --rate 3"), "env PATH=/none");
  EXPECT_EQ(pictures.status, 0) << pictures.err;
  EXPECT_THAT(pictures.err, HasSubstr("there is no ffmpeg"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "a/frame_00001.png"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a/frame_00002.png"));
  EXPECT_NE(readFile(folder_ / "a/frame_00000.png"), readFile(folder_ / "a/frame_00001.png"));
  EXPECT_THAT(run(render("--motion rise.bin --video a.avi")).err, HasSubstr(".mp4 or .gif"));
  if (std::system("command -v ffmpeg > /dev/null") != 0) GTEST_SKIP() << "ffmpeg is not installed";
  for (const auto& [name, start, magic] :
       {std::tuple{"b.gif", 0, "GIF89a"}, std::tuple{"b.mp4", 4, "ftyp"}}) {
    const Result film = run(render(std::string("--motion rise.bin --rate 2 --video ") + name));
    EXPECT_EQ(film.status, 0) << film.err;
    EXPECT_EQ(readFile(folder_ / name).substr(start, std::strlen(magic)), magic);
  }
}

TEST_F(Replay, TheClipStandsBeside) {
  write("rise.bvh", bowClip(6));
  ASSERT_EQ(run(render("-o alone.png --motion rise.bin")).status, 0);
  const Result result = run(render("-o both.png --motion rise.bin --clip rise.bvh --time 0.2"));
  ASSERT_EQ(result.status, 0) << result.err;
  const auto orange = [](int r, int g, int b) { return r > 2 * g && r > 2 * b && r > 60; };
  EXPECT_EQ(readPng(folder_ / "alone.png").count(orange, 120), 0);
  const Picture both = readPng(folder_ / "both.png");
  EXPECT_GT(both.count(orange, 120), 50);
  EXPECT_EQ(both.count(orange, 60), 0);  // on the right
  EXPECT_THAT(run(render("-o no.png --motion rise.bin --clip gone.bvh")).err,
              HasSubstr("gone.bvh"));
}

TEST_F(Replay, DamagedAndForeignMotionsAreRefused) {
  const std::string whole = readFile(folder_ / "rise.bin");
  write("cut.bin", whole.substr(0, whole.size() - 8));
  write("empty.bin", "");
  Motion foreign = rise();
  foreign.columns[0] = "tail:x";
  write("foreign.bin", motionBinary(foreign));
  for (const auto& [name, message] : {std::pair{"cut.bin", "cut off"},
                                      {"empty.bin", "not a motion"},
                                      {"foreign.bin", "tail:x"},
                                      {"gone.bin", "gone.bin"}}) {
    const std::string model = std::string(" ") + kHuman + " --motion " + name;
    std::vector<std::string> commands = {"render" + model + " -o no.png"};
    if (name == std::string("cut.bin"))
      commands.insert(commands.end(), {"run" + model, "view" + model});
    for (const std::string& command : commands) {
      const Result result = run(command, "env -u DISPLAY -u WAYLAND_DISPLAY");
      EXPECT_EQ(result.status, 1) << command;
      EXPECT_THAT(result.err, HasSubstr(std::string(name) + ": ")) << command;
      EXPECT_THAT(result.err, HasSubstr(message)) << command;
    }
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "no.png"));
  EXPECT_THAT(
      run(std::string("view ") + kHuman + " --motion rise.bin", "env -u DISPLAY -u WAYLAND_DISPLAY")
          .err,
      HasSubstr("no display"));
}

// What `torso view --motion` loads into the viewer.
TEST_F(Replay, PlayerStepsAlongTheMotion) {
  setenv("TORSO_MOTION", (folder_ / "rise.bin").c_str(), 1);
  void* library = dlopen(TORSO_PLAYER, RTLD_NOW | RTLD_LOCAL);
  ASSERT_TRUE(library) << dlerror();
  const auto step = reinterpret_cast<void (*)(const mjModel*, mjData*)>(dlsym(library, "mj_step"));
  ASSERT_TRUE(step);
  const mjModel* m = human();
  const DataPtr d = makeData(m);
  const int steps = static_cast<int>(std::lround(0.25 / m->opt.timestep));
  for (int i = 0; i < steps; i++) step(m, d.get());
  EXPECT_NEAR(d->time, 0.25, 1e-3);
  EXPECT_NEAR(d->qpos[2] - m->qpos0[2], kRise * d->time / 0.5, 1e-6);
}

}  // namespace
}  // namespace torso::tools
