// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Loaded into MuJoCo's viewer with LD_PRELOAD, beside the plugin: its mj_step takes the place of
// MuJoCo's and shows the motion in the file that the environment variable TORSO_MOTION names, again
// and again. A step of the viewer goes on by the model's time step; forces and contacts are those
// of the pose.

#include <mujoco/mujoco.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <stdexcept>

#include "tools/motion_file.h"

namespace {

using torso::tools::Motion;

// The motion for the model that was last played; null if there is none for it.
const Motion* motionFor(const mjModel* m) {
  static const mjModel* model = nullptr;
  static std::unique_ptr<Motion> motion;
  if (m == model) return motion.get();
  model = m;
  motion.reset();
  try {
    const char* path = std::getenv("TORSO_MOTION");
    if (!path) throw std::runtime_error("TORSO_MOTION is not set");
    motion =
        std::make_unique<Motion>(torso::tools::motionOf(m, torso::tools::readMotion(path), path));
  } catch (const std::exception& e) {
    std::fprintf(stderr, "torso view: %s\n", e.what());
  }
  return motion.get();
}

}  // namespace

extern "C" __attribute__((visibility("default"))) void mj_step(const mjModel* m, mjData* d) {
  const Motion* motion = motionFor(m);
  d->time += m->opt.timestep;
  if (motion) {
    torso::tools::motionAt(m, *motion, d->time, d->qpos);
    mju_zero(d->qvel, m->nv);
  }
  mj_forward(m, d);
}
