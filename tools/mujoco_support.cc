// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/mujoco_support.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <mutex>
#include <utility>

#include "tools/error.h"

namespace torso::tools {
namespace {

thread_local long thread_warnings = 0;
std::mutex warnings_mutex;
std::vector<std::string> warnings;

void onError(const char* message) { throw Error(std::string("MuJoCo: ") + message); }

void onWarning(const char* message) {
  thread_warnings++;
  const std::lock_guard<std::mutex> lock(warnings_mutex);
  if (std::find(warnings.begin(), warnings.end(), message) == warnings.end()) {
    warnings.emplace_back(message);
  }
}

// MuJoCo's messages have line breaks; ours are one line each.
std::string oneLine(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  for (std::size_t i; (i = text.find('\n')) != std::string::npos;) text.replace(i, 1, "; ");
  return text;
}

}  // namespace

void installHandlers() {
  mju_user_error = onError;
  mju_user_warning = onWarning;
}

long threadWarnings() { return thread_warnings; }

std::vector<std::string> takeWarnings() {
  const std::lock_guard<std::mutex> lock(warnings_mutex);
  return std::exchange(warnings, {});
}

std::string firstWarning(const mjData* d) {
  for (int i = 0; i < mjNWARNING; i++) {
    if (d->warning[i].number) return mju_warningText(i, d->warning[i].lastinfo);
  }
  return "";
}

// MuJoCo 2.2.2 keeps the model that it parsed last in a global variable.
static std::mutex parser_mutex;

ModelPtr loadModel(const std::string& path) {
  if (!std::filesystem::exists(path))
    throw Error(path + ": no such file; give the path of a model");
  if (!std::filesystem::is_regular_file(path)) throw Error(path + ": not a file");
  char error[1000] = "";
  ModelPtr m;
  const std::lock_guard<std::mutex> lock(parser_mutex);
  try {
    if (std::filesystem::path(path).extension() == ".mjb") {
      m.reset(mj_loadModel(path.c_str(), nullptr));
      if (!m) throw Error("not a binary model of this MuJoCo version");
    } else {
      m.reset(mj_loadXML(path.c_str(), nullptr, error, sizeof(error)));
      if (!m) throw Error(*error ? error : "not a model");
      if (*error) mju_warning(error);
    }
  } catch (const Error& e) {
    throw Error(path + ": MuJoCo cannot load this model: " + oneLine(e.what()));
  }
  return m;
}

ModelPtr compileModel(const std::string& mjcf, const std::string& name) {
  struct Files {
    mjVFS vfs;
    ~Files() { mj_deleteVFS(&vfs); }
  };
  const auto files = std::make_unique<Files>();  // large
  mj_defaultVFS(&files->vfs);
  const std::string file = name + ".xml";
  const int size = static_cast<int>(mjcf.size());
  if (mj_makeEmptyFileVFS(&files->vfs, file.c_str(), size) != 0) {
    throw Error(name + ": the model is too large");
  }
  const int slot = mj_findFileVFS(&files->vfs, file.c_str());
  std::copy(mjcf.begin(), mjcf.end(), static_cast<char*>(files->vfs.filedata[slot]));
  char error[1000] = "";
  ModelPtr m;
  const std::lock_guard<std::mutex> lock(parser_mutex);
  try {
    m.reset(mj_loadXML(file.c_str(), &files->vfs, error, sizeof(error)));
    if (!m) throw Error(*error ? error : "not a model");
  } catch (const Error& e) {
    throw Error(name + ": MuJoCo cannot load this model: " + oneLine(e.what()));
  }
  return m;
}

DataPtr makeData(const mjModel* m) {
  DataPtr d(mj_makeData(m));
  if (!d) throw Error("not enough memory for the simulation state");
  return d;
}

torsoInfo torsoOf(const mjModel* m, const std::string& path) {
  torsoInfo info = {};
  char error[1000] = "";
  const int found = torso_info(m, &info, error, sizeof(error));
  if (found < 0) {
    throw Error(fmt::format("{}: damaged torso data: {}", path, oneLine(error)));
  }
  return found ? info : torsoInfo{};
}

std::string nameOf(const mjModel* m, mjtObj type, int id) {
  const char* name = mj_id2name(m, type, id);
  return name && *name ? name : fmt::format("{} {}", mju_type2Str(type), id);
}

int keyframeId(const mjModel* m, const std::string& key, const std::string& path) {
  if (key.empty()) return -1;
  const int id = mj_name2id(m, mjOBJ_KEY, key.c_str());
  if (id >= 0) return id;
  std::string known;
  for (int i = 0; i < m->nkey; i++) {
    if (key == std::to_string(i)) return i;
    known += fmt::format("{}{}", i ? ", " : "", nameOf(m, mjOBJ_KEY, i));
  }
  throw Error(fmt::format("{}: no keyframe '{}'; the model has: {}", path, key,
                          known.empty() ? "none" : known));
}

}  // namespace torso::tools
