// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// `torso run --results`: what is left after a kill, and the same bytes however the runs were
// spread.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "tests/tools/command_fixture.h"

namespace torso::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;

const char kRun[] =
    "run /usr/share/mujoco/model/humanoid/humanoid.xml --drop 0.5 --control random --seconds 0.5 ";
// Long enough that a kill finds it at work.
const char kLong[] =
    "run /usr/share/mujoco/model/humanoid/humanoid.xml --drop 0.5 --control random --seconds 10 ";
const char kTorsoRun[] =
    "run " TORSO_MJCF "/torso_held.xml --control random --seconds 0.05 --seeds 4 ";

class Results : public Command {
 protected:
  // result.json of a run without interruption.
  std::string whole(const std::string& arguments) {
    const Result result = run(arguments + " --results whole");
    EXPECT_EQ(result.status, 0) << result.err;
    return readFile(folder_ / "whole/result.json");
  }

  // Starts a program with many seeds, and ends it by a signal when some are done.
  void killWhenSomeAreDone(const std::vector<std::string>& arguments, const std::string& results,
                           int signal = SIGKILL) {
    const pid_t child = fork();
    if (child == 0) {
      std::vector<char*> argv;
      for (const std::string& argument : arguments)
        argv.push_back(const_cast<char*>(argument.data()));
      argv.push_back(nullptr);
      if (chdir(folder_.c_str()) != 0 || !freopen("/dev/null", "w", stdout) ||
          !freopen("/dev/null", "w", stderr)) {
        _exit(126);
      }
      execv(argv[0], argv.data());
      _exit(127);
    }
    for (int i = 0; i < 600 && !fs::exists(folder_ / results / "seed3.json"); i++) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    kill(child, signal);
    int status;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << "it ended by itself, status " << WEXITSTATUS(status);
    ASSERT_TRUE(fs::exists(folder_ / results / "seed3.json"));
    ASSERT_FALSE(fs::exists(folder_ / results / "result.json"));
  }
};

TEST_F(Results, AreWhatJsonPrintsWithoutTheTimes) {
  for (const std::string& arguments : {std::string(kRun) + "--seeds 4 ", std::string(kTorsoRun)}) {
    json printed = runJson(arguments + "--json");
    for (const char* time : {"core_s", "wall_s", "real_time_factor"}) {
      EXPECT_EQ(printed.erase(time), 1u) << time;
    }
    const std::string text = whole(arguments);
    const json result = json::parse(text, nullptr, false);
    EXPECT_EQ(result["result"], printed);
    EXPECT_EQ(result["settings"]["control"], "random");
    EXPECT_EQ(run(arguments + "--threads 3 --results other").status, 0);
    EXPECT_EQ(readFile(folder_ / "other/result.json"), text);
    fs::remove_all(folder_ / "whole");
    fs::remove_all(folder_ / "other");
  }
}

TEST_F(Results, AKilledOrInterruptedRunGoesOn) {
  const std::string text = whole(std::string(kLong) + "--seeds 30");
  for (const int signal : {SIGKILL, SIGINT}) {
    std::vector<std::string> words = {TORSO_COMMAND};
    std::istringstream stream(std::string(kLong) + "--seeds 30 --results killed");
    for (std::string word; stream >> word;) words.push_back(word);
    killWhenSomeAreDone(words, "killed", signal);
    const std::string before = readFile(folder_ / "killed/seed0.json");
    const Result resumed =
        run(std::string(kLong) + "--seeds 30 --results killed --resume --threads 2");
    EXPECT_EQ(resumed.status, 0) << resumed.err;
    EXPECT_EQ(readFile(folder_ / "killed/seed0.json"), before)
        << "which tells its processor time, too";
    EXPECT_EQ(readFile(folder_ / "killed/result.json"), text);
    fs::remove_all(folder_ / "killed");
  }
}

TEST_F(Results, MoreSeedsJoinThoseThatAreThere) {
  EXPECT_EQ(run(std::string(kRun) + "--seed0 2 --seeds 2 --results more").status, 0);
  EXPECT_EQ(run(std::string(kRun) + "--seeds 5 --results more --resume --csv c.csv").status, 0);
  EXPECT_EQ(readFile(folder_ / "more/result.json"), whole(std::string(kRun) + "--seeds 5"));
  // Nothing is left to do; only what is to be watched is run again.
  const Result again = run(std::string(kRun) + "--seeds 5 --results more --resume --csv d.csv");
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(readFile(folder_ / "c.csv"), readFile(folder_ / "d.csv"));
  EXPECT_EQ(readFile(folder_ / "more/result.json"), readFile(folder_ / "whole/result.json"));
}

TEST_F(Results, FailedRunsAreKeptToo) {
  write("unstable.xml",
        "<mujoco><option timestep='0.01' integrator='Euler'/><worldbody><body><freejoint/>"
        "<geom size='.1'/></body><body pos='0 0 1'><joint name='j' stiffness='1e9'/>"
        "<geom size='.1'/></body></worldbody><actuator><motor joint='j' gear='1e5'/></actuator>"
        "</mujoco>");
  const std::string arguments = "run unstable.xml --control random --seeds 3 --seconds 1 ";
  const Result first = run(arguments + "--results f");
  ASSERT_EQ(first.status, 1);
  EXPECT_THAT(first.err, HasSubstr("3 of 3 runs failed"));
  const std::string result = readFile(folder_ / "f/result.json");
  const Result again = run(arguments + "--results f --resume");
  EXPECT_EQ(again.status, 1);
  EXPECT_THAT(again.err, HasSubstr("3 of 3 runs failed"));
  EXPECT_EQ(readFile(folder_ / "f/result.json"), result);
}

TEST_F(Results, WrongFoldersAreRefused) {
  const std::string arguments = std::string(kRun) + "--seeds 2 --results r ";
  ASSERT_EQ(run(arguments).status, 0);
  const auto refused = [&](const std::string& line) {
    const Result result = run(line);
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(result.out, "");
    return result.err;
  };
  EXPECT_EQ(refused(arguments),
            "torso run: r: holds results already; add --resume to go on with them, or choose "
            "another folder\n");
  EXPECT_EQ(
      refused(arguments + "--resume --amplitude 0.25"),
      "torso run: r/settings.json: amplitude is 0.5 there, but 0.25 now; results of different "
      "settings cannot be merged\n");
  EXPECT_THAT(refused("run " TORSO_MJCF "/torso_held.xml --seconds 0.5 --results r --resume"),
              HasSubstr("r/settings.json: model is "));
  write("r/seed1.json", "{\"seed\": 1");
  EXPECT_THAT(refused(arguments + "--resume"),
              HasSubstr("r/seed1.json: not a result of torso run"));
  fs::copy(folder_ / "r/seed0.json", folder_ / "r/seed1.json",
           fs::copy_options::overwrite_existing);
  EXPECT_THAT(refused(arguments + "--resume"), HasSubstr("r/seed1.json: holds seed 0"));
  write("r/settings.json", "[]");
  EXPECT_THAT(refused(arguments + "--resume"), HasSubstr("r/settings.json: not the settings"));
  write("file", "");
  EXPECT_THAT(refused(std::string(kRun) + "--results file"), HasSubstr("file: cannot make"));
  EXPECT_EQ(run(std::string(kRun) + "--resume").status, 2);
}

class Mpi : public Results {
 protected:
  void SetUp() override {
    Results::SetUp();
    if (!*MPIRUN) GTEST_SKIP() << "mpirun or MPI's headers are not installed (libopenmpi-dev)";
  }
  static constexpr const char* kMpirun = MPIRUN " --oversubscribe --allow-run-as-root ";

  // Runs a line of mpirun's.
  Result mpirun(const std::string& line) {
    const std::string command =
        "cd " + folder_.string() + " && " + kMpirun + line + " > out.txt 2> err.txt < /dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, readFile(folder_ / "out.txt"),
            readFile(folder_ / "err.txt")};
  }
};

TEST_F(Mpi, ProcessesGiveTheBytesOfOne) {
  for (const std::string& arguments : {std::string(kRun) + "--seeds 7 ", std::string(kTorsoRun)}) {
    const std::string text = whole(arguments);
    for (const std::string n : {"2", "3"}) {
      const Result result =
          mpirun("-n " + n + " " TORSO_COMMAND " " + arguments + "--results mpi" + n);
      EXPECT_EQ(result.status, 0) << result.err;
      EXPECT_EQ(readFile(folder_ / ("mpi" + n) / "result.json"), text) << n << " processes";
      fs::remove_all(folder_ / ("mpi" + n));
    }
    fs::remove_all(folder_ / "whole");
  }
}

TEST_F(Mpi, WithoutAFolderTheFirstPrintsForAll) {
  const std::string arguments = std::string(kRun) + "--seeds 5 --json";
  json one = runJson(arguments);
  const Result result = mpirun("-n 2 " TORSO_COMMAND " " + arguments + " --csv c.csv");
  ASSERT_EQ(result.status, 0) << result.err;
  json two = json::parse(result.out, nullptr, false);
  for (const char* time : {"core_s", "wall_s", "real_time_factor"}) {
    one.erase(time);
    EXPECT_EQ(two.erase(time), 1u);
  }
  EXPECT_EQ(one, two);
  EXPECT_TRUE(fs::exists(folder_ / "c.csv"));
}

TEST_F(Mpi, AKilledJobGoesOn) {
  std::vector<std::string> words;
  std::istringstream stream(std::string(kMpirun) + "-n 2 " TORSO_COMMAND " " + kLong +
                            "--seeds 30 --results killed");
  for (std::string word; stream >> word;) words.push_back(word);
  killWhenSomeAreDone(words, "killed");
  const Result resumed = mpirun("-n 2 " TORSO_COMMAND " " + std::string(kLong) +
                                "--seeds 30 --results killed --resume");
  EXPECT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_EQ(readFile(folder_ / "killed/result.json"), whole(std::string(kLong) + "--seeds 30"));
}

// As on machines that have no folder in common.
TEST_F(Mpi, EachMayKeepItsOwnFolder) {
  const auto both = [&](const std::string& options) {
    const std::string arguments = std::string(kRun) + options;
    const Result result = mpirun("-n 1 " TORSO_COMMAND " " + arguments + " --results a : -n 1 " +
                                 TORSO_COMMAND " " + arguments + " --results b");
    EXPECT_EQ(result.status, 0) << result.err;
  };
  both("--seeds 4");
  EXPECT_TRUE(fs::exists(folder_ / "a/seed0.json"));
  EXPECT_FALSE(fs::exists(folder_ / "a/seed1.json"));
  EXPECT_TRUE(fs::exists(folder_ / "b/seed1.json"));
  both("--seeds 6 --resume");
  EXPECT_EQ(readFile(folder_ / "a/result.json"), whole(std::string(kRun) + "--seeds 6"));
}

TEST_F(Mpi, ErrorsEndAllProcesses) {
  const std::string command = TORSO_COMMAND " " + std::string(kRun);
  const Result differ = mpirun("-n 1 " + command + ": -n 1 " + command + "--amplitude 0.25");
  EXPECT_NE(differ.status, 0);
  EXPECT_THAT(differ.err, HasSubstr("process 1: amplitude is 0.25 there, but 0.5 now"));
  const Result missing = mpirun("-n 2 " TORSO_COMMAND " run missing.xml");
  EXPECT_NE(missing.status, 0);
  EXPECT_THAT(missing.err, HasSubstr("torso run: missing.xml: no such file"));
}

}  // namespace
}  // namespace torso::tools
