// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <png.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>
#include <vector>

namespace torso::tools {

struct Picture {
  int width = 0, height = 0;
  std::vector<png_byte> rgb;  // rows from the top

  std::array<int, 3> at(int x, int y) const {
    const png_byte* pixel = &rgb[3 * (y * width + x)];
    return {pixel[0], pixel[1], pixel[2]};
  }
  std::size_t colours() const {
    std::set<std::array<int, 3>> seen;
    for (std::size_t i = 0; i < rgb.size(); i += 3) seen.insert({rgb[i], rgb[i + 1], rgb[i + 2]});
    return seen.size();
  }
  // Pixels of which is(r, g, b) is true, left of column `end`.
  template <typename Is>
  int count(Is is, int end) const {
    int n = 0;
    for (int y = 0; y < height; y++) {
      for (int x = 0; x < std::min(end, width); x++) {
        const auto [r, g, b] = at(x, y);
        n += is(r, g, b);
      }
    }
    return n;
  }
  // Pixels that are much more red than green and blue.
  int redPixels() const {
    return count([](int r, int g, int b) { return r > 2 * g + 20 && r > 2 * b + 20; }, width);
  }
};

// Empty if the file is not a PNG.
inline Picture readPng(const std::filesystem::path& path) {
  Picture picture;
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&image, path.c_str())) return picture;
  image.format = PNG_FORMAT_RGB;
  picture.rgb.resize(PNG_IMAGE_SIZE(image));
  if (png_image_finish_read(&image, nullptr, picture.rgb.data(), 0, nullptr)) {
    picture.width = static_cast<int>(image.width);
    picture.height = static_cast<int>(image.height);
  }
  return picture;
}

}  // namespace torso::tools
