// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace torso::plugin {

// What torso_lastError returns: why a function of the C interface failed last on this thread.
inline thread_local std::string last_error;

}  // namespace torso::plugin
