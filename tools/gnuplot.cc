// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/gnuplot.h"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>

#include "tools/error.h"

namespace torso::tools {

void runGnuplot(const std::string& command, const std::string& folder, const std::string& script) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  char program[] = "gnuplot";
  std::string file = script;
  char* arguments[] = {program, file.data(), nullptr};
  pid_t child = 0;
  const int failure = posix_spawnp(&child, program, &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure == ENOENT) {
    fmt::print(
        stderr,
        "torso {}: {}: holds the tables and {} but no picture, as there is no gnuplot on this "
        "machine (Debian: apt install gnuplot-nox)\n",
        command, folder, script);
    return;
  }
  int status = 0;
  if (failure || waitpid(child, &status, 0) < 0 || !WIFEXITED(status) || WEXITSTATUS(status)) {
    throw Error(fmt::format("{}/{}: gnuplot failed", folder, script));
  }
}

std::string plotLevels(const LevelPanel& p) {
  return fmt::format(
      "plot '{}' skip 1 using 0:{}:{} with filledcurves lc rgb '#d62728' title '{} range', \\\n"
      "  '' skip 1 using 0:{}:xtic(1) with linespoints lw 2 pt 5 ps 0.8 lc rgb '#d62728' title "
      "'{} mean', \\\n"
      "  '' skip 1 using 0:{} with linespoints lw 2.5 pt 7 ps 1.1 lc rgb '#1f4e9c' title '{}'",
      p.table, p.low, p.high, p.human_title, p.mean, p.human_title, p.ours, p.our_title);
}

}  // namespace torso::tools
