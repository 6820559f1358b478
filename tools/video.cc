// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/video.h"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "tools/error.h"
#include "tools/files.h"
#include "tools/renderer.h"

namespace torso::tools {
namespace {

namespace fs = std::filesystem;

// For the shell, whatever is in it.
std::string shellQuoted(const std::string& text) {
  std::string result = "'";
  for (char c : text) result += c == '\'' ? "'\\''" : std::string(1, c);
  return result + "'";
}

}  // namespace

Video::Video(const std::string& path, double rate, int width, int height)
    : path_(path), width_(width), height_(height) {
  const fs::path file(path);
  const std::string ending = file.extension().string();
  if (ending != ".mp4" && ending != ".gif") {
    throw Error(fmt::format("{}: a film ends in .mp4 or .gif", path));
  }
  const std::string parent = file.parent_path().string();
  if (!parent.empty()) checkFolder(parent);
  if (!parent.empty()) makeFolder(parent);
  if (std::system("command -v ffmpeg >/dev/null 2>&1") != 0) {
    folder_ = (file.parent_path() / file.stem()).string();
    makeFolder(folder_);
    return;
  }
  part_ = (file.parent_path() / (file.stem().string() + ".part" + ending)).string();
  // Rows come from below. H.264 wants even sizes; a GIF a palette of its own.
  const std::string filter = ending == ".gif"
                                 ? "'vflip,split[a][b];[a]palettegen[p];[b][p]paletteuse'"
                                 : "'vflip,pad=ceil(iw/2)*2:ceil(ih/2)*2' -pix_fmt yuv420p -crf 18";
  pipe_ = popen(fmt::format("ffmpeg -y -loglevel error -f rawvideo -pix_fmt rgb24 -s {}x{} -r {} "
                            "-i - -vf {} {}",
                            width, height, rate, filter, shellQuoted(part_))
                    .c_str(),
                "w");
  if (!pipe_) throw Error(path + ": cannot start ffmpeg");
}

Video::~Video() {
  if (!pipe_) return;
  pclose(pipe_);
  std::error_code error;
  fs::remove(part_, error);
}

void Video::add(const std::vector<unsigned char>& rgb) {
  if (!pipe_) {
    writeFile(fmt::format("{}/frame_{:05}.png", folder_, frames_++),
              encodePng(rgb, width_, height_));
  } else if (std::fwrite(rgb.data(), 1, rgb.size(), pipe_) != rgb.size()) {
    throw Error(path_ + ": ffmpeg has ended early");
  }
}

std::string Video::finish() {
  if (!pipe_) return folder_;
  const int status = pclose(pipe_);
  pipe_ = nullptr;
  if (status != 0) throw Error(path_ + ": ffmpeg failed");
  fs::rename(part_, path_);
  return path_;
}

}  // namespace torso::tools
