// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/files.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

#include "tools/error.h"

namespace torso::tools {

namespace {

// Ctrl-C and the like wait while it lives.
class Uninterrupted {
 public:
  Uninterrupted() {
    sigset_t signals;
    sigemptyset(&signals);
    for (int s : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, s);
    pthread_sigmask(SIG_BLOCK, &signals, &before_);
  }
  ~Uninterrupted() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  Uninterrupted(const Uninterrupted&) = delete;
  Uninterrupted& operator=(const Uninterrupted&) = delete;

 private:
  sigset_t before_;
};

std::string temporaryName(const std::string& path) {
  return fmt::format("{}.{}.tmp", path, getpid());
}

void writeTemporary(const std::string& path, std::string_view content) {
  std::ofstream file(temporaryName(path), std::ios::binary);
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
  file.close();
  if (!file) throw Error(fmt::format("{}: cannot write: {}", path, std::strerror(errno)));
  if (std::filesystem::is_directory(path)) {
    throw Error(fmt::format("{}: cannot write: there is a folder of that name", path));
  }
}

void renameTemporary(const std::string& path) {
  std::error_code error;
  std::filesystem::rename(temporaryName(path), path, error);
  if (error) throw Error(fmt::format("{}: cannot write: {}", path, error.message()));
}

}  // namespace

std::string readFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream content;
  content << file.rdbuf();
  if (!file) throw Error(path + ": cannot read");
  return content.str();
}

void writeFile(const std::string& path, std::string_view content) {
  const Uninterrupted uninterrupted;
  try {
    writeTemporary(path, content);
    renameTemporary(path);
  } catch (...) {
    std::error_code error;
    std::filesystem::remove(temporaryName(path), error);
    throw;
  }
}

void writeFiles(const std::map<std::string, std::string>& files) {
  const Uninterrupted uninterrupted;
  try {
    for (const auto& [path, content] : files) {
      makeFolder(std::filesystem::absolute(path).parent_path().string());
      writeTemporary(path, content);
    }
    for (const auto& [path, content] : files) renameTemporary(path);
  } catch (...) {
    std::error_code error;
    for (const auto& [path, content] : files) {
      std::filesystem::remove(temporaryName(path), error);
    }
    throw;
  }
}

void checkFolder(const std::string& path) {
  std::filesystem::path at = std::filesystem::absolute(path);
  std::error_code error;
  while (!std::filesystem::exists(at, error) && at.has_relative_path()) at = at.parent_path();
  if (!std::filesystem::is_directory(at, error)) {
    throw Error(fmt::format("{}: cannot make this folder: {} is a file", path, at.string()));
  }
  if (access(at.c_str(), W_OK | X_OK) != 0) {
    throw Error(fmt::format("{}: cannot write into this folder: {}", path, std::strerror(errno)));
  }
}

void makeFolder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) throw Error(fmt::format("{}: cannot make this folder: {}", path, error.message()));
}

}  // namespace torso::tools
