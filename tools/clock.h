// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ctime>

namespace torso::tools {

// Processor time of the calling thread [s]: what a step costs one core, also while other programs
// share the machine.
inline double threadSeconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace torso::tools
