// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The torso's numeric in a model: header of the data, and the place where the plugin notes which
// Instance belongs to the model, so that a callback finds it in O(1) and a reloaded model, which
// has a fresh note, is never mistaken for the one that had its address before.

#include <mujoco/mujoco.h>

#include <cstring>

namespace torso::plugin {

inline constexpr const char* kNoteName = "mujoco_torso";
inline constexpr int kNoteSize = 3;  // format, note, first entry of userdata

// Id of the first numeric called (prefix)mujoco_torso, or -1.
inline int noteNumeric(const mjModel* m) {
  const std::size_t n = std::strlen(kNoteName);
  for (int i = 0; i < m->nnumeric; i++) {
    const char* name = m->names + m->name_numericadr[i];
    const std::size_t length = std::strlen(name);
    if (length >= n && std::strcmp(name + length - n, kNoteName) == 0) return i;
  }
  return -1;
}

}  // namespace torso::plugin
