// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <iostream>
#include <string>

namespace torso::tools {

// A bar on stderr while it lives, if that is a terminal.
class ProgressBar {
 public:
  ProgressBar() : terminal_(isatty(STDERR_FILENO)) {}
  ~ProgressBar() {
    if (terminal_) std::cerr << "\r\033[K" << std::flush;
  }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(double share) const {  // of the work done, 0 to 1
    if (!terminal_) return;
    constexpr int kWidth = 40;
    const int filled = static_cast<int>(share * kWidth);
    std::cerr << fmt::format("\r[{:<{}}] {:3.0f} %", std::string(filled, '='), kWidth, 100 * share)
              << std::flush;
  }

 private:
  bool terminal_;
};

}  // namespace torso::tools
