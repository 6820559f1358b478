// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <string>
#include <vector>

#include "plugin/mujoco_torso.h"

namespace torso::tools {

struct Deleter {
  void operator()(mjModel* m) const { mj_deleteModel(m); }
  void operator()(mjData* d) const { mj_deleteData(d); }
};
using ModelPtr = std::unique_ptr<mjModel, Deleter>;
using DataPtr = std::unique_ptr<mjData, Deleter>;

// Route MuJoCo's errors and warnings here, instead of to the console and MUJOCO_LOG.TXT: an error
// becomes an exception Error (MuJoCo on x86-64 Linux carries unwind tables), a warning is kept.
// Call once, before any other use of MuJoCo.
void installHandlers();

// Warnings given so far by the calling thread.
long threadWarnings();
// Take the warnings of all threads since the last call, each text once, in order of appearance.
std::vector<std::string> takeWarnings();

// What MuJoCo has warned of in d since its reset, the first kind of warning; "" if nothing.
std::string firstWarning(const mjData* d);

// Load a model from MJCF, URDF or MJB. Thread-safe. Throws Error "<path>: ..." if it cannot.
ModelPtr loadModel(const std::string& path);
// The same from the text of an MJCF file that includes no other; messages begin with `name`.
ModelPtr compileModel(const std::string& mjcf, const std::string& name);
// Throws Error if there is not enough memory.
DataPtr makeData(const mjModel* m);

// The torso data of a model loaded from path; all zero if there are none. Throws Error "<path>:
// ..." if they are damaged.
torsoInfo torsoOf(const mjModel* m, const std::string& path);

// Name of an object, or "<type> <id>" if it has none.
std::string nameOf(const mjModel* m, mjtObj type, int id);

// Keyframe by name or number; -1 for "". Throws Error that lists the keyframes there are.
int keyframeId(const mjModel* m, const std::string& key, const std::string& path);

}  // namespace torso::tools
