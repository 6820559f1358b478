// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/tools/humanoid_texts.h"
#include "tools/error.h"
#include "tools/graft.h"
#include "tools/mujoco_support.h"
#include "tools/paths.h"

namespace torso::tools {

constexpr const char* kMujocoHumanoid = "/usr/share/mujoco/model/humanoid/humanoid.xml";

// Each test grafts in an empty folder of its own.
class GraftFixture : public testing::Test {
 protected:
  void SetUp() override {
    installHandlers();
    std::string folder = testing::TempDir() + "graft_XXXXXX";
    ASSERT_TRUE(mkdtemp(folder.data()));
    folder_ = folder;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static const Anatomy& anatomy() {
    static const Anatomy a = Anatomy::load(anatomyFolder());
    return a;
  }
  static std::string readFile(const std::string& path) {
    std::ostringstream content;
    content << std::ifstream(path).rdbuf();
    return content.str();
  }
  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  std::string write(const std::string& name, const std::string& content) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << content;
    return at(name);
  }
  GraftOptions options(const std::string& input, const std::string& output = "out.xml") const {
    GraftOptions o;
    o.input = input;
    o.output = at(output);
    o.meshes = mjcfFolder() + "/assets";
    return o;
  }
  GraftReport graftTo(const std::string& input, const std::string& output = "out.xml") const {
    return graft(anatomy(), options(input, output));
  }
  // The message of the error, which must be one line and leave the folder as it was.
  std::string errorOf(const GraftOptions& o) const {
    const std::vector<std::string> before = files();
    std::string message = "no error";
    try {
      graft(anatomy(), o);
    } catch (const Error& e) {
      message = e.what();
    }
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_EQ(files(), before) << message;
    return message;
  }
  // Paths and contents.
  std::vector<std::string> files() const {
    std::vector<std::string> all;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_)) {
      const std::string path = entry.path().string();
      all.push_back(path + (entry.is_regular_file() ? "\n" + readFile(path) : ""));
    }
    std::sort(all.begin(), all.end());
    return all;
  }

  std::filesystem::path folder_;
};

inline int idOf(const mjModel* m, mjtObj type, const std::string& name) {
  const int found = mj_name2id(m, type, name.c_str());
  EXPECT_GE(found, 0) << name;
  return found;
}

// Lets the humanoid fall from `height` [m], with other random controls every 60 steps.
inline void drop(const mjModel* m, mjData* d, double height, int steps) {
  for (int j = 0; j < m->njnt; j++) {
    if (m->jnt_type[j] == mjJNT_FREE) d->qpos[m->jnt_qposadr[j] + 2] += height;
  }
  unsigned random = 1;
  for (int i = 0; i < steps; i++) {
    for (int u = 0; i % 60 == 0 && u < m->nu; u++) {
      random = random * 1664525u + 1013904223u;
      const mjtNum* range = m->actuator_ctrlrange + 2 * u;
      d->ctrl[u] = range[0] + (range[1] - range[0]) * (random >> 8) / double(1 << 24);
    }
    mj_step(m, d);
  }
}

// A form of humanoid that tests graft.
struct HumanoidForm {
  std::string name, text;  // text: MJCF
};
inline void PrintTo(const HumanoidForm& form, std::ostream* out) { *out << form.name; }

inline std::vector<HumanoidForm> humanoidForms() {
  std::ostringstream mujoco;
  mujoco << std::ifstream(kMujocoHumanoid).rdbuf();
  return {{"mujoco", mujoco.str()},
          {"waist_down", waistDownHumanoid()},
          {"pelvis_up", pelvisUpHumanoid()},
          {"plain", plainHumanoid()}};
}

}  // namespace torso::tools
