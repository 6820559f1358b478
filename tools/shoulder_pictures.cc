// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/shoulder_pictures.h"

#include <algorithm>
#include <cmath>

#include "tools/error.h"
#include "tools/files.h"
#include "tools/renderer.h"

namespace torso::tools {
namespace {

constexpr double kDegree = EIGEN_PI / 180;
constexpr int kWidth = 300, kHeight = 330;  // of one picture [pixels]

struct View {
  double azimuth, elevation;  // of the camera [deg]
};
constexpr View kBehind = {10, -4}, kSide = {-90, -4}, kFront = {180, -4}, kAbove = {0, -75};

void pose(const mjModel* m, mjData* d, const ShoulderPose& pose) {
  mj_resetData(m, d);
  for (std::size_t k = 0; k < kShoulderJoints.size(); k++) {
    const int joint = mj_name2id(m, mjOBJ_JOINT, kShoulderJoints[k]);
    if (joint < 0) throw Error(std::string("shoulder pictures: no joint ") + kShoulderJoints[k]);
    std::copy(pose.joints[k].begin(), pose.joints[k].end(), d->qpos + m->jnt_qposadr[joint]);
  }
  mj_forward(m, d);
}

// A row of pictures for each view, a column for each pose.
std::string strip(mjModel* m, const std::vector<ShoulderPose>& poses,
                  const std::vector<View>& views) {
  mjvOption option;
  mjv_defaultOption(&option);
  setVisible(option, "ligaments", false);
  const DataPtr d = makeData(m);
  Renderer renderer(m, kWidth, kHeight);
  const int rows = static_cast<int>(views.size()), columns = static_cast<int>(poses.size());
  std::vector<unsigned char> rgb(static_cast<std::size_t>(3) * kWidth * columns * kHeight * rows);
  for (int column = 0; column < columns; column++) {
    pose(m, d.get(), poses[column]);
    for (int row = 0; row < rows; row++) {
      mjvCamera camera;
      mjv_defaultCamera(&camera);
      camera.azimuth = views[row].azimuth;
      camera.elevation = views[row].elevation;
      camera.distance = 0.85;
      // Between the scapula and the head of the humerus.
      const int scapula = mj_name2id(m, mjOBJ_BODY, "left_scapula");
      const int ribcage = mj_name2id(m, mjOBJ_BODY, "ribcage");
      mju_copy3(camera.lookat, d->xpos + 3 * ribcage);
      camera.lookat[1] = 0.6 * d->xpos[3 * scapula + 1];
      camera.lookat[2] -= 0.05;
      const std::vector<unsigned char> cell = renderer.pixels(d.get(), option, camera);
      const std::size_t first = static_cast<std::size_t>(rows - 1 - row) * kHeight;  // from below
      for (int y = 0; y < kHeight; y++) {
        std::copy_n(cell.begin() + 3 * y * kWidth, 3 * kWidth,
                    rgb.begin() + 3 * ((first + y) * columns * kWidth + column * kWidth));
      }
    }
  }
  return encodePng(rgb, kWidth * columns, kHeight * rows);
}

}  // namespace

void writeShoulderPictures(const std::string& folder, mjModel* human,
                           const ShoulderReport& report) {
  std::vector<ShoulderPose> arm = {report.rest};
  for (double elevation = 30 * kDegree; elevation < kArmRaised + 0.1; elevation += 30 * kDegree) {
    arm.push_back(*std::min_element(report.raising.begin(), report.raising.end(),
                                    [&](const ShoulderPose& a, const ShoulderPose& b) {
                                      return std::abs(a.elevation - elevation) <
                                             std::abs(b.elevation - elevation);
                                    }));
  }
  writeFile(folder + "/arm.png", strip(human, arm, {kBehind, kSide, kFront}));
  std::vector<ShoulderPose> girdle = {report.rest};
  for (const auto& [motion, poses] : report.girdle) girdle.push_back(poses.back());
  writeFile(folder + "/girdle.png", strip(human, girdle, {kBehind, kSide, kAbove}));
}

}  // namespace torso::tools
