// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/paths.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <filesystem>

#include "plugin/mujoco_torso.h"
#include "tools/error.h"

namespace torso::tools {
namespace {

namespace fs = std::filesystem;

std::string dataFolder(const char* installed, const char* in_source) {
  std::error_code error;
  const fs::path executable = fs::read_symlink("/proc/self/exe", error);
  const fs::path beside =
      executable.parent_path().parent_path() / "share" / "mujoco_torso" / installed;
  if (!error && fs::is_directory(beside)) return beside.string();
  const fs::path source = fs::path(TORSO_SOURCE_DIR) / in_source;
  if (fs::is_directory(source)) return source.string();
  throw Error(fmt::format("{}: no such folder, nor is there {}; install the project again",
                          beside.string(), source.string()));
}

}  // namespace

std::string anatomyFolder() { return dataFolder("anatomy", "model/anatomy"); }

std::string mjcfFolder() { return dataFolder("mjcf", "mjcf"); }

std::string tasksFolder() { return dataFolder("tasks", "tasks"); }

std::string pluginLibrary() {
  Dl_info info;
  if (!dladdr(reinterpret_cast<void*>(&torso_version), &info) || !info.dli_fname) {
    throw Error("libmujoco_torso.so: cannot find the file of the loaded library");
  }
  return fs::canonical(info.dli_fname).string();
}

}  // namespace torso::tools
