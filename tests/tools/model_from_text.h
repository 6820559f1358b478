// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "tools/mujoco_support.h"

namespace torso::tools {

// Model of what stands between <mujoco> and </mujoco>.
inline ModelPtr modelFromText(const std::string& xml) {
  std::string path = testing::TempDir() + "torso_XXXXXX";
  close(mkstemp(path.data()));
  std::ofstream(path) << "<mujoco>" << xml << "</mujoco>";
  ModelPtr m = loadModel(path);
  unlink(path.c_str());
  return m;
}

}  // namespace torso::tools
