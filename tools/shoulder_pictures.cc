// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/shoulder_pictures.h"

#include <algorithm>
#include <cmath>

#include "tools/error.h"
#include "tools/files.h"
#include "tools/plate.h"
#include "tools/renderer.h"

namespace torso::tools {
namespace {

constexpr double kDegree = EIGEN_PI / 180;
constexpr int kWidth = 270, kHeight = 300;  // of one picture [pixels]

// What is shown: its height, and its middle beside and above the origin of the rib cage [m].
struct Window {
  double height, left, up;
};
constexpr Window kArm = {0.56, 0.14, 0.02}, kGirdle = {0.42, 0.09, -0.06};
constexpr View kBehind = {-15, 0}, kSide = {-90, 0}, kFront = {180, 0}, kAbove = {0, -89};

// Leaves thorax, girdle and the left upper arm to be seen, the left scapula in a colour of its own.
void showGirdle(mjModel* m) {
  for (int i = 0; i < m->ngeom; i++) {
    const std::string name = nameOf(m, mjOBJ_GEOM, i);
    const bool vertebra = name.size() < 4 && name[0] == 'T';
    const bool shown = vertebra || name == "C7" || name.rfind("ribcage", 0) == 0 ||
                       name == "left_upper_arm" || name.find("_clavicle") != name.npos ||
                       name.find("_scapula") != name.npos;
    if (m->geom_type[i] != mjGEOM_MESH || !shown) m->geom_group[i] = mjNGROUP - 1;
    if (name == "left_scapula") {
      const float colour[4] = {0.93f, 0.70f, 0.42f, 1};
      std::copy_n(colour, 4, m->geom_rgba + 4 * i);
      m->geom_matid[i] = -1;
    }
  }
}

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
                  const std::vector<View>& views, const Window& window) {
  mjvOption option;
  mjv_defaultOption(&option);
  for (const char* layer : {"ligaments", "discs"}) setVisible(option, layer, false);
  std::fill_n(option.sitegroup, mjNGROUP, mjtByte{0});
  preparePlate(m);
  showGirdle(m);
  mjvCamera camera;
  mjv_defaultCamera(&camera);
  camera.distance = window.height / 2 / std::tan(m->vis.global.fovy / 2 * kDegree);
  m->vis.map.znear = static_cast<float>(camera.distance / 2 / m->stat.extent);
  const DataPtr d = makeData(m);
  Renderer renderer(m, kFiner * kWidth, kFiner * kHeight);
  const int rows = static_cast<int>(views.size()), columns = static_cast<int>(poses.size());
  std::vector<unsigned char> rgb(static_cast<std::size_t>(3) * kWidth * columns * kHeight * rows);
  for (int column = 0; column < columns; column++) {
    pose(m, d.get(), poses[column]);
    mju_copy3(camera.lookat, d->xpos + 3 * mj_name2id(m, mjOBJ_BODY, "ribcage"));
    camera.lookat[0] -= 0.07;
    camera.lookat[1] += window.left;
    camera.lookat[2] += window.up;
    for (int row = 0; row < rows; row++) {
      camera.azimuth = views[row].azimuth;
      camera.elevation = views[row].elevation;
      placeLight(m, d.get(), views[row]);
      const std::vector<unsigned char> cell =
          shrink(renderer.pixels(d.get(), option, camera), kWidth, kHeight);
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
  writeFile(folder + "/arm.png", strip(human, arm, {kBehind, kSide, kFront}, kArm));
  std::vector<ShoulderPose> girdle = {report.rest};
  for (const auto& [motion, poses] : report.girdle) girdle.push_back(poses.back());
  writeFile(folder + "/girdle.png", strip(human, girdle, {kBehind, kSide, kAbove}, kGirdle));
}

}  // namespace torso::tools
