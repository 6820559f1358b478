// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <string>
#include <vector>

namespace torso::tools {

// Pictures to a film. With ffmpeg: an MP4 or GIF file, by the ending of its name. Without it:
// frame_00000.png and so on in a folder of that name less its ending.
class Video {
 public:
  // Throws Error if the name ends otherwise, or if it cannot be written there.
  Video(const std::string& path, double rate, int width, int height);
  ~Video();
  Video(const Video&) = delete;
  Video& operator=(const Video&) = delete;

  // rgb: as Renderer::pixels gives it. Throws Error.
  void add(const std::vector<unsigned char>& rgb);
  // Closes it; the path of what was written. Without this call nothing is left of a film.
  std::string finish();

 private:
  std::string path_, part_, folder_;  // part_: the film while it grows
  int width_, height_, frames_ = 0;
  std::FILE* pipe_ = nullptr;  // null: no ffmpeg
};

}  // namespace torso::tools
