// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <iostream>
#include <string>

namespace torso::tools {

// A bar on stderr, where that is a terminal.
inline void showProgress(double share) {
  if (!isatty(STDERR_FILENO)) return;
  constexpr int kWidth = 40;
  const int filled = static_cast<int>(share * kWidth);
  std::cerr << fmt::format("\r[{:<{}}] {:3.0f} %", std::string(filled, '='), kWidth, 100 * share)
            << std::flush;
}

// Takes the bar away.
inline void endProgress() {
  if (isatty(STDERR_FILENO)) std::cerr << "\r\033[K" << std::flush;
}

}  // namespace torso::tools
