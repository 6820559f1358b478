// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// torso bones --plot as a user runs it.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "tests/tools/command_fixture.h"
#include "tests/tools/picture.h"

namespace torso::tools {
namespace {

namespace fs = std::filesystem;

struct Sheet {
  std::string file;
  int rows, columns;
  double filled;  // least part of a view's pixels that shows something
};

// A rectangle of a picture against the colour of the picture's corner.
struct Part {
  const Picture& picture;
  int left, top, width, height;

  bool drawn(int x, int y) const {
    const auto a = picture.at(left + x, top + y), b = picture.at(0, 0);
    return std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]) > 6;
  }
  int count(int from, int to) const {
    int n = 0;
    for (int y = 0; y < height; y++) {
      for (int x = from; x < to; x++) n += drawn(x, y);
    }
    return n;
  }
  int border() const {
    int n = 0;
    for (int x = 0; x < width; x++) n += drawn(x, 0) + drawn(x, height - 1);
    for (int y = 0; y < height; y++) n += drawn(0, y) + drawn(width - 1, y);
    return n;
  }
};

int bluePixels(const Picture& picture) {
  return picture.count([](int r, int g, int b) { return b > r + 60 && b > g + 20; }, picture.width);
}

TEST_F(Command, BonesPlotDrawsFivePictures) {
  // The measures of one bone only: the pictures do not depend on them.
  const Result result = run("bones --only C5 --plot new/pictures");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("published measures inside"), std::string::npos);

  const Sheet sheets[] = {{"skeleton.png", 1, 3, 0.08},
                          {"vertebrae.png", 3, 3, 0.1},
                          {"lumbar.png", 1, 2, 0.15},
                          {"shoulder.png", 1, 2, 0.25},
                          {"skull.png", 1, 3, 0.4}};
  std::set<std::string> files, expected;
  for (const auto& entry : fs::directory_iterator(folder_ / "new/pictures")) {
    files.insert(entry.path().filename());
  }
  for (const Sheet& sheet : sheets) expected.insert(sheet.file);
  EXPECT_EQ(files, expected);

  for (const Sheet& sheet : sheets) {
    const Picture picture = readPng(folder_ / "new/pictures" / sheet.file);
    ASSERT_GE(picture.width, 800) << sheet.file;
    const int width = picture.width / sheet.columns, height = picture.height / sheet.rows;
    for (int i = 0; i < sheet.rows * sheet.columns; i++) {
      SCOPED_TRACE(sheet.file + ", view " + std::to_string(i));
      const Part view = {picture, i % sheet.columns * width, i / sheet.columns * height, width,
                         height};
      EXPECT_EQ(view.border(), 0) << "something is cut off";
      EXPECT_GT(view.count(0, width), sheet.filled * width * height);
    }
    // The light background is plain, the bones are not.
    EXPECT_GT(picture.at(0, 0)[2], 230) << sheet.file;
    EXPECT_GT(picture.colours(), 100u) << sheet.file;
    // Facet ellipsoids and discs are in one of them; cartilage is not that blue.
    EXPECT_EQ(bluePixels(picture) > 10000, sheet.file == "lumbar.png") << sheet.file;
    EXPECT_EQ(bluePixels(picture) == 0, sheet.file != "lumbar.png") << sheet.file;
  }
}

TEST_F(Command, BonesPlotShowsTheSkeletonFromFrontSideAndBack) {
  ASSERT_EQ(run("bones --only C5 --plot .").status, 0);
  const Picture picture = readPng(folder_ / "skeleton.png");
  const int width = picture.width / 3;
  const Part front = {picture, 0, 0, width, picture.height};
  const Part side = {picture, width, 0, width, picture.height};
  const Part back = {picture, 2 * width, 0, width, picture.height};
  // Left and right are mirror images, seen from the front and from the back, not from the side.
  const auto symmetry = [&](const Part& view) {
    return static_cast<double>(view.count(0, width / 2)) / view.count(width / 2, width);
  };
  EXPECT_NEAR(symmetry(front), 1, 0.01);
  EXPECT_NEAR(symmetry(back), 1, 0.01);
  EXPECT_GT(std::abs(symmetry(side) - 1), 0.05);
  // The outline is the same from both sides but for perspective, and less wide from the side.
  EXPECT_NEAR(static_cast<double>(front.count(0, width)) / back.count(0, width), 1, 0.02);
  EXPECT_LT(side.count(0, width), 0.8 * front.count(0, width));
}

TEST_F(Command, BonesPlotNamesAFolderItCannotWriteInto) {
  write("file", "");
  const Result result = run("bones --only C5 --plot file/pictures");
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(result.err.find("torso bones: file/pictures: "), 0u) << result.err;
}

}  // namespace
}  // namespace torso::tools
