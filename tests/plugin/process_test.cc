// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// The plugin in other programs: linked, opened at run time, preloaded, and absent.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdio.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/plugin/fixture.h"

namespace torso {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

struct Output {
  int status;
  std::string text;  // both streams
};

// The child writes its log, if any, into a folder that is removed with this object.
class ProcessTest : public PluginTest {
 protected:
  ProcessTest() {
    if (!mkdtemp(folder.data())) throw std::runtime_error("no temporary folder");
  }
  ~ProcessTest() override { std::filesystem::remove_all(folder); }

  Output run(const std::string& command) const {
    FILE* pipe = popen(("cd " + folder + " && " + command + " 2>&1").c_str(), "r");
    if (!pipe) throw std::runtime_error("cannot run " + command);
    Output out;
    char buffer[4096];
    for (size_t n; (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) out.text.append(buffer, n);
    const int status = pclose(pipe);
    out.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return out;
  }
  std::string write(const std::string& text) const {
    const std::string path = folder + "/model.xml";
    std::ofstream(path) << text;
    return path;
  }
  static double value(const Output& out, const std::string& key) {
    const std::size_t at = out.text.find(key + " ");
    if (at == std::string::npos) throw std::runtime_error("no " + key + " in: " + out.text);
    return std::stod(out.text.substr(at + key.size()));
  }
  // The torso with its pelvis held, as a file.
  std::string heldTorso() const {
    std::string text = modelText("torso.xml");
    fixPelvis(&text);
    return write(text);
  }
  std::string folder = testing::TempDir() + "process_XXXXXX";
  const std::string stock = STOCK_PROGRAM, preload = "LD_PRELOAD=" PLUGIN_LIBRARY " ";
};

// In stock MuJoCo the welds hold the bones together; the state of the discs is not touched.
TEST_F(ProcessTest, WithoutThePluginTheTorsoStands) {
  const Output out = run(stock + " " + heldTorso() + " 1");
  ASSERT_EQ(out.status, 0) << out.text;
  EXPECT_EQ(value(out, "warnings"), 0) << out.text;
  EXPECT_LT(value(out, "shift_mm"), 20);
  EXPECT_EQ(value(out, "userdata"), 0);
  EXPECT_EQ(value(out, "sensors"), 0);
}

// The whole body as committed, bone meshes and all.
TEST_F(ProcessTest, WithoutThePluginTheBodyLoadsAndFalls) {
  const Output out = run(stock + " " + modelPath("human.xml") + " 1");
  ASSERT_EQ(out.status, 0) << out.text;
  EXPECT_EQ(value(out, "warnings"), 0) << out.text;
  EXPECT_LT(value(out, "shift_mm"), 20);
}

TEST_F(ProcessTest, PreloadedIntoAnUnmodifiedProgram) {
  const Output out = run(preload + stock + " " + heldTorso() + " 0.1");
  ASSERT_EQ(out.status, 0) << out.text;
  EXPECT_EQ(value(out, "warnings"), 0) << out.text;
  EXPECT_GT(value(out, "userdata"), 0);
  EXPECT_GT(value(out, "sensors"), 1) << "forces, moments and pressures";
}

TEST_F(ProcessTest, OpenedAtRunTime) {
  const Output out = run(stock + " " + heldTorso() + " 0.1 " PLUGIN_LIBRARY);
  ASSERT_EQ(out.status, 0) << out.text;
  EXPECT_EQ(value(out, "warnings"), 0) << out.text;
  EXPECT_GT(value(out, "userdata"), 0);
  EXPECT_GT(value(out, "sensors"), 1);
}

TEST_F(ProcessTest, PreloadedPluginRefusesDamage) {
  std::string text = modelText("torso.xml");
  replaceOnce(&text, "nuserdata=\"20000\"", "nuserdata=\"100\"");
  const std::string path = write(text);
  const Output with = run(preload + stock + " " + path + " 0.1");
  EXPECT_EQ(with.status, 1);
  EXPECT_THAT(with.text, HasSubstr("torso data, size: nuserdata is 100, the 23 discs need"));
  EXPECT_EQ(run(stock + " " + path + " 0.01").status, 0) << "stock MuJoCo does not mind";
}

// MuJoCo's own sample program, as installed.
TEST_F(ProcessTest, PreloadedIntoMujocosTestspeed) {
  if (std::string(TESTSPEED).find("NOTFOUND") != std::string::npos) {
    GTEST_SKIP() << "mujoco-testspeed is not installed";
  }
  const Output sound = run(preload + TESTSPEED " " + heldTorso() + " 100");
  EXPECT_EQ(sound.status, 0) << sound.text;
  EXPECT_THAT(sound.text, HasSubstr("Simulation time"));
  // That the plugin is in it shows in what it refuses.
  const Output damaged =
      run(preload + TESTSPEED " " +
          write("<mujoco><custom><numeric name='mujoco_torso' data='2 0 0'/></custom></mujoco>") +
          " 100");
  EXPECT_THAT(damaged.text, HasSubstr("torso data, custom: no tuple 'disc:...' was found"));
}

// The program of the README.
TEST_F(ProcessTest, LinkedIntoTheReadmesProgram) {
  const Output out = run(std::string(README_PROGRAM) + " " + modelPath("human.xml"));
  ASSERT_EQ(out.status, 0) << out.text;
  double pressure = 0;
  ASSERT_EQ(sscanf(out.text.c_str(), "L4/L5: %lf MPa\n", &pressure), 1) << out.text;
  EXPECT_GT(pressure, 0);
  EXPECT_LT(pressure, 5);
  const Output missing = run(std::string(README_PROGRAM) + " /no/such/file.xml");
  EXPECT_EQ(missing.status, 1);
  EXPECT_THAT(missing.text, HasSubstr("/no/such/file.xml"));
}

// The examples in C and in Python: two ways through the same header to the same numbers.
TEST_F(ProcessTest, RolloutExamplesInCAndPythonAgree) {
  const std::string arguments = " " + heldTorso() + " ";
  const Output in_c = run(ROLLOUT_PROGRAM + arguments + "3 20 2");
  ASSERT_EQ(in_c.status, 0) << in_c.text;
  EXPECT_THAT(in_c.text, HasSubstr("control 0.04: mean squared speed "));
  EXPECT_THAT(in_c.text, Not(HasSubstr("nan")));
  EXPECT_EQ(run(ROLLOUT_PROGRAM + arguments + "3 20 1").text, in_c.text);
  if (std::string(PYTHON).find("NOTFOUND") != std::string::npos) {
    GTEST_SKIP() << "python3 is not installed";
  }
  const std::string script = PYTHON " -B " ROLLOUT_SCRIPT " ";
  const Output in_python =
      run(script + PLUGIN_LIBRARY + arguments + "--trajectories 3 --steps 20 --threads 2");
  EXPECT_EQ(in_python.status, 0);
  EXPECT_EQ(in_python.text, in_c.text);
}

TEST_F(ProcessTest, RolloutExamplesSayWhatIsWrong) {
  const Output in_c = run(std::string(ROLLOUT_PROGRAM) + " /no/such/file.xml");
  EXPECT_EQ(in_c.status, 1);
  EXPECT_THAT(in_c.text, HasSubstr("/no/such/file.xml"));
  EXPECT_EQ(run(std::string(ROLLOUT_PROGRAM) + " " + heldTorso() + " 3 0").status, 1);
  if (std::string(PYTHON).find("NOTFOUND") != std::string::npos) {
    GTEST_SKIP() << "python3 is not installed";
  }
  const std::string script = PYTHON " -B " ROLLOUT_SCRIPT " " PLUGIN_LIBRARY " ";
  const Output missing = run(script + "/no/such/file.xml");
  EXPECT_EQ(missing.status, 1);
  EXPECT_THAT(missing.text, HasSubstr("/no/such/file.xml"));
  const Output wrong = run(script + heldTorso() + " --threads 0");
  EXPECT_EQ(wrong.status, 1);
  EXPECT_EQ(wrong.text, "nthread is 0, it must be at least 1\n");
}

}  // namespace
}  // namespace torso
