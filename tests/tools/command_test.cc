// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Runs the torso command as a user would.

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/tools/command_fixture.h"
#include "tests/tools/picture.h"

namespace torso::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const char kHumanoid[] = "/usr/share/mujoco/model/humanoid/humanoid.xml";

int lines(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

TEST_F(Command, HelpExplainsAndExitsWithZero) {
  const std::string help = run("--help").out;
  for (const std::string name : {"build", "info", "run", "view", "render", "bench", "timestep",
                                 "discs", "calibrate-discs"}) {
    EXPECT_NE(help.find(name), std::string::npos);
    const Result result = run(name + " --help");
    EXPECT_EQ(result.status, 0);
    EXPECT_EQ(result.err, "");
    EXPECT_NE(result.out.find("Examples:\n  torso " + name), std::string::npos) << result.out;
  }
}

TEST_F(Command, WrongUsageExitsWithTwo) {
  for (const std::string arguments : {"",
                                      "frobnicate",
                                      "info",
                                      "run x.xml --seeds 0",
                                      "run x.xml --control wild",
                                      "run x.xml --seconds fast",
                                      "render x.xml",
                                      "render x.xml -o a.png --layers hair",
                                      "render x.xml -o a.png --discs colour",
                                      "render x.xml -o a.png --discs-range 0:1",
                                      "render x.xml -o a.png --discs mises --discs-range 1:1",
                                      "render x.xml -o a.png --discs mises --discs-range 0:1x",
                                      "render x.xml -o a.png --discs mises --discs-range 0:nan",
                                      "render x.xml -o a.png --discs-cut",
                                      "run x.xml --vtu-at 0",
                                      "run x.xml --vtu v --vtu-at -1",
                                      "run x.xml --vtu v --vtu-every 0",
                                      "run x.xml --vtu v --vtu-every 1 --vtu-at 0",
                                      "timestep --rates 10",
                                      "timestep --rates fast",
                                      "timestep --seconds 0"}) {
    const Result result = run(arguments);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_EQ(result.out, "") << arguments;
    EXPECT_NE(result.err, "") << arguments;
  }
}

TEST_F(Command, MissingModelIsNamedInOneLine) {
  for (const std::string arguments : {"info missing.xml", "run missing.xml", "view missing.xml",
                                      "render missing.xml -o a.png", "bench missing.xml"}) {
    const Result result = run(arguments);
    EXPECT_EQ(result.status, 1) << arguments;
    EXPECT_EQ(result.out, "") << arguments;
    EXPECT_EQ(lines(result.err), 1) << result.err;
    const std::string start =
        "torso " + arguments.substr(0, arguments.find(' ')) + ": missing.xml: no such file";
    EXPECT_EQ(result.err.substr(0, start.size()), start);
  }
}

TEST_F(Command, BrokenModelIsExplainedInOneLine) {
  write("broken.xml", "<mujoco>\n<worldbody>\n<geom type='potato'/>\n</worldbody></mujoco>");
  const Result result = run("info broken.xml");
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(lines(result.err), 1) << result.err;
  EXPECT_NE(result.err.find("broken.xml"), std::string::npos);
  EXPECT_NE(result.err.find("potato"), std::string::npos);
  EXPECT_NE(result.err.find("line 3"), std::string::npos);
}

TEST_F(Command, DamagedTorsoDataAreExplained) {
  write("damaged.xml",
        "<mujoco><custom><numeric name='mujoco_torso' data='99 0 0'/></custom><worldbody><body>"
        "<geom size='.1'/></body></worldbody></mujoco>");
  for (const std::string arguments : {"info damaged.xml", "run damaged.xml", "view damaged.xml",
                                      "render damaged.xml -o a.png", "bench damaged.xml"}) {
    const Result result = run(arguments);
    EXPECT_EQ(result.status, 1) << arguments;
    EXPECT_EQ(result.out, "") << arguments;
    EXPECT_EQ(lines(result.err), 1) << result.err;
    EXPECT_NE(result.err.find(": damaged.xml: "), std::string::npos) << result.err;
    EXPECT_NE(result.err.find("format 99"), std::string::npos) << result.err;
  }
}

TEST_F(Command, InfoCountsWhatMujocoCounts) {
  const json info = runJson(std::string("info --json ") + kHumanoid);
  mjModel* m = mj_loadXML(kHumanoid, nullptr, nullptr, 0);
  ASSERT_TRUE(m);
  EXPECT_EQ(info["dof"], m->nv);
  EXPECT_EQ(info["actuators"], m->nu);
  EXPECT_EQ(info["bodies"], m->nbody - 1);
  EXPECT_EQ(info["free_joints"], 1);
  EXPECT_EQ(info["ball_joints"], 0);
  double mass = 0;
  for (int i = 0; i < m->nbody; i++) mass += m->body_mass[i];
  EXPECT_NEAR(info["mass_kg"], mass, 1e-9);
  mj_deleteModel(m);
  EXPECT_EQ(info["discs"], json::array());
  for (const char* key : {"ligament_segments", "facets", "facet_points"}) EXPECT_EQ(info[key], 0);

  const Result text = run(std::string("info ") + kHumanoid);
  EXPECT_EQ(text.status, 0);
  EXPECT_NE(text.out.find("no torso data"), std::string::npos);
}

TEST_F(Command, RunGivesTheSameBitsOnAnyNumberOfThreads) {
  const std::string arguments =
      std::string("run --json --drop 0.5 --control random --seeds 6 --seconds 1 ") + kHumanoid;
  json one = runJson(arguments + " --threads 1");
  json four = runJson(arguments + " --threads 4");
  for (const char* key : {"core_s", "wall_s", "real_time_factor"}) {
    EXPECT_GT(one[key], 0);
    one.erase(key);
    four.erase(key);
  }
  EXPECT_EQ(one, four);
  EXPECT_EQ(one["runs"], 6);
  EXPECT_EQ(one["failed"], 0);
  EXPECT_NE(runJson(arguments + " --seed0 1")["state_hash"], one["state_hash"]);
}

// A ball in free fall under semi-implicit Euler: z_n = z_0 - g h^2 n (n + 1) / 2.
TEST_F(Command, TimeSeriesOfAFallingBallIsThatOfTheIntegrator) {
  write("ball.xml",
        "<mujoco><option timestep='0.01'/><worldbody><geom type='plane' size='1 1 1'/>"
        "<body pos='0 0 3'><freejoint/><geom type='sphere' size='0.1' mass='2'/></body>"
        "</worldbody></mujoco>");
  EXPECT_EQ(run("run ball.xml --drop 4 --seconds 1 --csv ball.csv --rate 50").status, 0);
  std::istringstream csv(readFile(folder_ / "ball.csv"));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line.rfind("time_s,com_x_m,com_y_m,com_z_m,kinetic_energy_j", 0), 0u) << line;
  const auto columns = std::count(line.begin(), line.end(), ',');
  int row = 0;
  for (; std::getline(csv, line); row++) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), columns);
    double t, x, y, z, energy;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf", &t, &x, &y, &z, &energy), 5);
    const int n = 2 * row;
    EXPECT_NEAR(t, n * 0.01, 1e-6);
    EXPECT_NEAR(z, 7 - 9.81 * 1e-4 * n * (n + 1) / 2, 1e-6);
    EXPECT_NEAR(energy, 0.5 * 2 * std::pow(9.81 * 0.01 * n, 2), 1e-4);
  }
  EXPECT_EQ(row, 51);
}

TEST_F(Command, RunWithoutActuationIgnoresControls) {
  write("arm.xml",
        "<mujoco><worldbody><body><joint name='j' axis='0 1 0' damping='1'/>"
        "<geom type='capsule' size='0.05' fromto='0 0 0 0 0 -1'/></body></worldbody>"
        "<actuator><motor joint='j' ctrllimited='true' ctrlrange='5 10'/></actuator></mujoco>");
  const auto hash = [&](const std::string& control) {
    return runJson("run --json arm.xml --seconds 1 --control " + control)["state_hash"];
  };
  EXPECT_EQ(hash("none"), hash("none --seed0 5"));
  EXPECT_NE(hash("random"), hash("random --seed0 5"));
  EXPECT_NE(hash("random"), hash("none"));
}

TEST_F(Command, UnstableRunsAreCountedAndExitWithOne) {
  write("unstable.xml",
        "<mujoco><option timestep='0.1'/><worldbody><body pos='0 0 1'><freejoint/>"
        "<geom type='sphere' size='0.1'/></body><body pos='0 0 2'><joint name='s' type='slide' "
        "stiffness='1e9'/><geom type='sphere' size='0.1'/></body></worldbody></mujoco>");
  const Result result = run("run --json unstable.xml --seeds 3 --threads 2");
  EXPECT_EQ(result.status, 1);
  const json j = json::parse(result.out);
  EXPECT_EQ(j["runs"], 3);
  EXPECT_EQ(j["failed"], 3);
  EXPECT_GE(j["warnings"], 3);
  EXPECT_EQ(j["failures"].size(), 3u);
  EXPECT_NE(result.err.find("torso run: unstable.xml: 3 of 3 runs failed"), std::string::npos)
      << result.err;
}

TEST_F(Command, DropNeedsAFreeBody) {
  write("fixed.xml",
        "<mujoco><worldbody><body><joint/><geom size='.1'/></body></worldbody></mujoco>");
  const Result result = run("run fixed.xml --drop 1");
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("fixed.xml: no free body"), std::string::npos) << result.err;
}

TEST_F(Command, ACrateThatLiesStillIsOnTheFloorAndOneThatFallsIsNot) {
  write("post.xml",
        "<mujoco><worldbody><geom type='plane' size='1 1 1'/><body pos='0 0 1' euler='0 30 0'>"
        "<freejoint/><geom type='box' size='0.1 0.1 1'/></body></worldbody></mujoco>");
  EXPECT_EQ(runJson("run --json post.xml --drop 0.1 --seconds 3")["bodies_on_floor"], 1);
  EXPECT_EQ(runJson("run --json post.xml --drop 20 --seconds 1")["bodies_on_floor"], 0);
  EXPECT_EQ(runJson("run --json post.xml --seconds 0.1")["bodies_on_floor"], 0);
}

TEST_F(Command, CtrlCLeavesWholeFilesAndResults) {
  const pid_t child = fork();
  if (child == 0) {
    fs::current_path(folder_);
    if (!std::freopen("out.txt", "w", stdout) || !std::freopen("err.txt", "w", stderr)) _exit(9);
    execl(TORSO_COMMAND, "torso", "run", kHumanoid, "--json", "--seconds", "5", "--seeds", "100000",
          "--csv", "series.csv", static_cast<char*>(nullptr));
    _exit(9);
  }
  std::this_thread::sleep_for(std::chrono::seconds(2));
  kill(child, SIGINT);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGINT) << status;
  const json j = json::parse(readFile(folder_ / "out.txt"), nullptr, false);
  EXPECT_GT(j["runs"], 0);
  EXPECT_LT(j["runs"], 100000);
  EXPECT_EQ(j["failed"], 0);
  EXPECT_EQ(readFile(folder_ / "series.csv").back(), '\n');
  for (const auto& entry : fs::directory_iterator(folder_)) {
    EXPECT_NE(entry.path().extension(), ".tmp");
  }
}

TEST_F(Command, RenderWritesAPictureOfTheSizeAskedFor) {
  const Result result = run(std::string("render -o a.png --width 320 --height 200 ") + kHumanoid);
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out + result.err, "");
  const Picture picture = readPng(folder_ / "a.png");
  EXPECT_EQ(picture.width, 320);
  EXPECT_EQ(picture.height, 200);
  EXPECT_GT(picture.colours(), 100u);
}

TEST_F(Command, LayersShowAndHide) {
  write("layers.xml",
        "<mujoco><worldbody><light pos='0 0 9'/><body pos='0 0 1'>"
        "<geom type='sphere' size='0.5' group='1' rgba='0 1 0 1'/>"
        "<geom type='sphere' size='0.6' group='3' rgba='1 0 0 1'/></body></worldbody></mujoco>");
  const auto red = [&](const std::string& options) {
    const Result result = run("render layers.xml -o a.png --width 100 --height 100 " + options);
    EXPECT_EQ(result.status, 0) << result.err;
    return readPng(folder_ / "a.png").redPixels();
  };
  EXPECT_EQ(red(""), 0);
  const int whole = red("--show collision");
  // A sphere seen whole in a square picture: its disc is most of it, and within the frame.
  EXPECT_GT(whole, 5500);
  EXPECT_LT(whole, 8000);
  EXPECT_EQ(red("--show geom:3"), whole);
  EXPECT_EQ(red("--layers bones"), 0);
  EXPECT_EQ(red("--layers bones,collision"), whole);
  EXPECT_EQ(red("--layers bones,collision --hide geom:3"), 0);
  const Result wrong = run("render layers.xml -o a.png --show hair");
  EXPECT_EQ(wrong.status, 1);
  EXPECT_NE(wrong.err.find("'hair'; layers: bones, "), std::string::npos) << wrong.err;
}

TEST_F(Command, RenderRefusesWhatItCannotDo) {
  const Result camera = run(std::string("render -o a.png --camera moon ") + kHumanoid);
  EXPECT_EQ(camera.status, 1);
  EXPECT_NE(camera.err.find("no camera 'moon'; the model has: back, side"), std::string::npos)
      << camera.err;
  const Result key = run(std::string("render -o a.png --keyframe moon ") + kHumanoid);
  EXPECT_EQ(key.status, 1);
  EXPECT_NE(key.err.find("no keyframe 'moon'; the model has: none"), std::string::npos) << key.err;
  const Result folder = run(std::string("render -o no/such/a.png ") + kHumanoid);
  EXPECT_EQ(folder.status, 1);
  EXPECT_NE(folder.err.find("no/such/a.png: cannot write"), std::string::npos) << folder.err;
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(Command, RunWritesFrames) {
  const Result result =
      run(std::string("run --drop 1 --seconds 0.5 --render frames --frames 3 --width 64 "
                      "--height 64 ") +
          kHumanoid);
  EXPECT_EQ(result.status, 0) << result.err;
  for (const char* name : {"seed0_000000ms.png", "seed0_000250ms.png", "seed0_000500ms.png"}) {
    EXPECT_EQ(readPng(folder_ / "frames" / name).width, 64) << name;
  }
  EXPECT_NE(readFile(folder_ / "frames/seed0_000000ms.png"),
            readFile(folder_ / "frames/seed0_000500ms.png"));
}

TEST_F(Command, DiscsComparesADiscWithPublishedTests) {
  const Result result = run("discs --level L4/L5 --json");
  ASSERT_EQ(result.status, 0) << result.err;
  const auto discs = nlohmann::json::parse(result.out)["discs"];
  ASSERT_EQ(discs.size(), 1u);
  EXPECT_EQ(discs[0]["name"], "L4/L5");
  int compression = 0;
  for (const auto& test : discs[0]["tests"]) {
    EXPECT_FALSE(test["source"].get<std::string>().empty());
    if (test["quantity"] != "compression") continue;
    EXPECT_GT(test["ours"], 200);  // N/mm
    EXPECT_LT(test["ours"], 4000);
    compression++;
  }
  EXPECT_EQ(compression, 1);
  const Result table = run("discs --level L4/L5");
  for (const char* word : {"compression", "axial_torsion", "N/mm", "pressure", "Markolf 1972"}) {
    EXPECT_NE(table.out.find(word), std::string::npos) << table.out;
  }
}

TEST_F(Command, DiscsNamesTheLevelsThereAre) {
  for (const std::string command : {"discs", "calibrate-discs"}) {
    const Result result = run(command + " --level L6/S1");
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(result.out, "");
    EXPECT_NE(result.err.find("no disc is called 'L6/S1'; there are L5/S1, L4/L5"),
              std::string::npos)
        << result.err;
  }
}

TEST_F(Command, ViewSaysWhatIsMissing) {
  const Result display = run(std::string("view ") + kHumanoid, "env -u DISPLAY -u WAYLAND_DISPLAY");
  EXPECT_EQ(display.status, 1);
  EXPECT_EQ(display.out, "");
  EXPECT_EQ(lines(display.err), 1);
  EXPECT_NE(display.err.find("no display"), std::string::npos) << display.err;

  const Result viewer = run(std::string("view ") + kHumanoid, "env DISPLAY=:77 PATH=/nowhere");
  EXPECT_EQ(viewer.status, 1);
  EXPECT_NE(viewer.err.find("package libmujoco-samples"), std::string::npos) << viewer.err;
}

TEST_F(Command, ViewStartsTheViewerWithThePlugin) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a library with a sanitizer cannot be loaded into a program without";
#endif
  fs::create_directory(folder_ / "bin");
  write("bin/mujoco-simulate", "#!/bin/sh\nprintf '%s\\n%s\\n' \"$LD_PRELOAD\" \"$1\"\n");
  fs::permissions(folder_ / "bin/mujoco-simulate", fs::perms::owner_all);
  const Result result = run(std::string("view ") + kHumanoid,
                            "env DISPLAY=:77 PATH=" + folder_.string() + "/bin:/bin");
  EXPECT_EQ(result.status, 0) << result.err;
  std::istringstream out(result.out);
  std::string library, model;
  std::getline(out, library);
  std::getline(out, model);
  EXPECT_EQ(model, kHumanoid);
  EXPECT_NE(library.find("libmujoco_torso.so"), std::string::npos) << library;
  EXPECT_TRUE(fs::exists(library)) << library;
}

TEST_F(Command, BenchMeasuresAndComparesWithTheFixedModel) {
  write("ball.xml",
        "<mujoco><worldbody><body pos='0 0 3'><freejoint/><geom type='sphere' size='0.1'/></body>"
        "</worldbody></mujoco>");
  write("chain_fixed.xml", readFile(folder_ / "ball.xml"));
  std::string bodies, ends;
  for (int i = 0; i < 40; i++) {
    bodies += "<body pos='0 0 0.1'><joint type='ball'/><geom type='sphere' size='0.02'/>";
    ends += "</body>";
  }
  write("chain.xml", "<mujoco><option><flag contact='disable'/></option><worldbody>" + bodies +
                         ends + "</worldbody></mujoco>");
  const json alone = runJson("bench --json ball.xml --seconds 0.2 --repetitions 3");
  EXPECT_TRUE(alone["ratio_to_fixed_torso"].is_null());
  const json both = runJson("bench --json chain.xml --seconds 0.2 --repetitions 3");
  // 120 degrees of freedom against 6.
  EXPECT_GT(both["ratio_to_fixed_torso"], 3);
  EXPECT_GT(both["step_us"], alone["step_us"]);
  EXPECT_NEAR(both["rtf_600hz"].get<double>(), 1e6 / 600 / both["step_us"].get<double>(), 1e-6);
  EXPECT_NEAR(both["rtf_200hz"].get<double>(), 1e6 / 200 / both["step_200hz_us"].get<double>(),
              1e-6);
  EXPECT_GT(both["threads_2_speedup"], 0);
  // Neither of them has a torso.
  EXPECT_EQ(both["parts_us"]["disc"], 0);
  EXPECT_GT(both["parts_us"]["inertia"], 0);
}

}  // namespace
}  // namespace torso::tools
