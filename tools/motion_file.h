// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Motions of a MuJoCo model as files: its joint positions, frame by frame.

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

namespace torso::tools {

struct Motion {
  double rate = 0;                   // frames per second [Hz]
  std::vector<std::string> columns;  // (nq) "L4:x", ":y", ":z", ":qw" .. ":qz" of a free joint;
                                     // ":qw" .. of a ball joint; the bare name of others
  std::vector<double> qpos;          // (frames x nq) [m], unit quaternions, [rad]

  std::size_t frames() const { return columns.empty() ? 0 : qpos.size() / columns.size(); }
};

// Names of a model's entries of qpos; a joint without a name is called "joint <id>".
std::vector<std::string> qposColumns(const mjModel* m);

// Text: a comment with the rate, a head line "time_s,<columns>", a row for each frame, every number
// bit for bit. Binary: one line of JSON (format, rate, frames, columns), then the numbers as 8-byte
// little-endian floats, row by row.
std::string motionCsv(const Motion& motion);
std::string motionBinary(const Motion& motion);

// Reads either, whatever the file's name. Throws Error "<path>: ..." if it is none of them, damaged
// or has numbers that are not finite.
Motion readMotion(const std::string& path);

// The same motion with the columns of a model, joints that it lacks at qpos0. Throws Error "<path>:
// ..." if a joint of the motion is not in the model.
Motion motionOf(const mjModel* m, const Motion& motion, const std::string& path);

// qpos (nq) at a time [s] between two frames, which is brought into the motion's duration by
// repeating it. motion: of motionOf.
void motionAt(const mjModel* m, const Motion& motion, double time, mjtNum* qpos);
// Time from the first to the last frame [s].
double duration(const Motion& motion);

}  // namespace torso::tools
