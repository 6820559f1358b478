// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Models without a torso pass through the plugin untouched.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tests/plugin/fixture.h"

namespace torso {
namespace {

class ExampleModelsTest : public PluginTest {
 protected:
  ~ExampleModelsTest() override { torso_install(); }

  static DataPtr run(const mjModel* m) {
    DataPtr d = makeData(m);
    randomControls(m, d.get(), 1, 6);
    for (int i = 0; i < 200; i++) mj_step(m, d.get());
    return d;
  }
};

TEST_F(ExampleModelsTest, GiveTheSameBitsWithAndWithoutThePlugin) {
  if (!std::filesystem::exists(MUJOCO_MODEL_DIR)) {
    GTEST_SKIP() << "MuJoCo's example models are not at " MUJOCO_MODEL_DIR;
  }
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(MUJOCO_MODEL_DIR)) {
    if (entry.path().extension() == ".xml") paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  int compared = 0;
  for (const std::string& path : paths) {
    torso_uninstall();
    ASSERT_EQ(mjcb_passive, nullptr);
    char error[500] = "";
    const ModelPtr m(mj_loadXML(path.c_str(), nullptr, error, sizeof error));
    if (!m) continue;  // parts that others include
    const DataPtr without = run(m.get());
    const std::string warnings_without = takeWarnings();

    torso_install();
    ASSERT_EQ(torso_isInstalled(), 1);
    EXPECT_EQ(torso_info(m.get(), nullptr, error, sizeof error), 0) << path;
    const DataPtr with = run(m.get());
    EXPECT_EQ(takeWarnings(), warnings_without) << path;
    EXPECT_EQ(differences(m.get(), without.get(), with.get()), "") << path;

    // Loading, which runs the callbacks too, gives the same model.
    const ModelPtr loaded_with(mj_loadXML(path.c_str(), nullptr, error, sizeof error));
    ASSERT_TRUE(loaded_with) << path << ": " << error;
    takeWarnings();
    const auto bytes = [](const mjModel* model) {
      std::vector<char> buffer(mj_sizeModel(model));
      mj_saveModel(model, nullptr, buffer.data(), static_cast<int>(buffer.size()));
      return buffer;
    };
    EXPECT_TRUE(bytes(m.get()) == bytes(loaded_with.get())) << path;
    compared++;
  }
  EXPECT_GT(compared, 10) << "at " MUJOCO_MODEL_DIR;
}

}  // namespace
}  // namespace torso
