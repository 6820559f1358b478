// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace torso::tools {

// What stops a command: "<file>: what is wrong and how to mend it". The main program puts
// "torso <command>: " before it and exits with status 1.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace torso::tools
