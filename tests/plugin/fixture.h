// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <memory>
#include <string>
#include <vector>

#include "plugin/mujoco_torso.h"

namespace torso {

struct MujocoDeleter {
  void operator()(mjModel* m) const { mj_deleteModel(m); }
  void operator()(mjData* d) const { mj_deleteData(d); }
};
using ModelPtr = std::unique_ptr<mjModel, MujocoDeleter>;
using DataPtr = std::unique_ptr<mjData, MujocoDeleter>;

// A test in which any MuJoCo warning that the test has not taken, and any error, is a failure.
class PluginTest : public ::testing::Test {
 protected:
  PluginTest();
  ~PluginTest() override;
  void TearDown() override;

  // Warnings of all threads since the last call, one per line.
  static std::string takeWarnings();
};

// Text of a file in mjcf/ ("torso.xml"), fit to be loaded from anywhere. Bone meshes are left out,
// which changes nothing in the dynamics and makes loading fast.
std::string modelText(const std::string& file);

// MJCF text without its bone meshes. One element per line, as `torso build` writes.
std::string withoutMeshes(const std::string& text);

// Replaces the first occurrence of `from`, which must exist.
void replaceOnce(std::string* text, const std::string& from, const std::string& to);
// The torso of `text` with its pelvis fixed to the world.
void fixPelvis(std::string* text);

// Loads MJCF text; on failure null, and the message in *error if it is not null, else the test
// fails.
ModelPtr loadText(const std::string& text, std::string* error = nullptr);
// Loads a file of mjcf/ without its bone meshes.
ModelPtr loadModel(const std::string& file);
// The file itself, meshes and all.
std::string modelPath(const std::string& file);

DataPtr makeData(const mjModel* m);
DataPtr copyData(const mjModel* m, const mjData* d);

// Sizes of the torso; the test fails if there is none or it is damaged.
torsoInfo torsoOf(const mjModel* m);

// Uniformly random controls within the actuators' ranges times `share`, the same for a seed.
void randomControls(const mjModel* m, mjData* d, double share, int seed);
// Normally distributed velocities [m/s, rad/s].
void randomVelocities(const mjModel* m, mjData* d, double sigma, int seed);

// Turns off gravity, and contacts other than those of facets.
void leaveInSpace(mjModel* m);

// Names of the entries of the state, of the torso's and of the derived quantities that differ in
// any bit: "" if the two data agree.
std::string differences(const mjModel* m, const mjData* one, const mjData* two);

}  // namespace torso
