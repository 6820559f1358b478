// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <iostream>
#include <string>

namespace torso::tools {

// A bar on stderr while it lives, if that is a terminal.
class ProgressBar {
 public:
  ProgressBar() : terminal_(isatty(STDERR_FILENO)) {}
  ~ProgressBar() { clear(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(double share) const {  // of the work done, 0 to 1
    if (!terminal_) return;
    constexpr int kWidth = 40;
    const int filled = static_cast<int>(share * kWidth);
    std::cerr << fmt::format("\r[{:<{}}] {:3.0f} %{}\033[K", std::string(filled, '='), kWidth,
                             100 * share, timeLeft(share))
              << std::flush;
  }

  // Make room for a line of text.
  void clear() const {
    if (terminal_) std::cerr << "\r\033[K" << std::flush;
  }

 private:
  using Clock = std::chrono::steady_clock;

  // Worth telling after 5 s.
  std::string timeLeft(double share) const {
    const double past = std::chrono::duration<double>(Clock::now() - start_).count();
    if (past < 5 || share <= 0) return "";
    const int left = static_cast<int>(past * (1 - share) / share);
    return fmt::format("  {}:{:02} left", left / 60, left % 60);
  }

  const Clock::time_point start_ = Clock::now();
  bool terminal_;
};

}  // namespace torso::tools
