// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

namespace torso::tools {

inline std::string readFile(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream content;
  content << file.rdbuf();
  return content.str();
}

// Each test runs the command in an empty folder of its own.
class Command : public testing::Test {
 protected:
  struct Result {
    int status;  // of the exit; -1: ended by a signal
    std::string out, err;
  };

  void SetUp() override {
    std::string folder = testing::TempDir() + "torso_XXXXXX";
    ASSERT_TRUE(mkdtemp(folder.data()));
    folder_ = folder;
    // Under AddressSanitizer: what OpenGL drivers leak is not ours.
    setenv("ASAN_OPTIONS", "detect_leaks=0", 0);
  }

  void TearDown() override {
    EXPECT_FALSE(std::filesystem::exists(folder_ / "MUJOCO_LOG.TXT"));
    std::filesystem::remove_all(folder_);
  }

  // prefix: environment for the command, e.g. "env -u DISPLAY"
  Result run(const std::string& arguments, const std::string& prefix = "") {
    const std::string line = "cd " + folder_.string() + " && " + prefix + " " TORSO_COMMAND " " +
                             arguments + " > out.txt 2> err.txt < /dev/null";
    const int status = std::system(line.c_str());
    const Result result = {WIFEXITED(status) ? WEXITSTATUS(status) : -1,
                           readFile(folder_ / "out.txt"), readFile(folder_ / "err.txt")};
    std::filesystem::remove(folder_ / "out.txt");
    std::filesystem::remove(folder_ / "err.txt");
    return result;
  }

  std::string write(const std::string& name, const std::string& content) {
    std::ofstream(folder_ / name) << content;
    return name;
  }

  nlohmann::json runJson(const std::string& arguments) {
    const Result result = run(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.err, "");
    return nlohmann::json::parse(result.out, nullptr, false);
  }

  std::filesystem::path folder_;
};

}  // namespace torso::tools
