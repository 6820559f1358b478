// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>

#include "tools/commands.h"
#include "tools/error.h"
#include "tools/motion_file.h"
#include "tools/mujoco_support.h"
#include "tools/paths.h"

namespace torso::tools {
namespace {

constexpr char kViewer[] = "mujoco-simulate";

bool isSet(const char* variable) {
  const char* value = std::getenv(variable);
  return value && *value;
}

// Replaces this process by the viewer.
void view(const std::string& model, const std::string& motion) {
  // What is broken is told here, not in a window.
  const ModelPtr m = loadModel(model);
  torsoOf(m.get(), model);
  if (!motion.empty()) motionOf(m.get(), readMotion(motion), motion);
  if (!isSet("DISPLAY") && !isSet("WAYLAND_DISPLAY")) {
    throw Error(fmt::format(
        "{}: no display to open a window on (neither DISPLAY nor WAYLAND_DISPLAY is set); make a "
        "picture with 'torso render {} -o picture.png'",
        model, model));
  }
  std::string preload = pluginLibrary();
  if (!motion.empty()) {
    const std::filesystem::path player =
        std::filesystem::path(preload).parent_path() / "libtorso_player.so";
    if (!std::filesystem::exists(player)) {
      throw Error(player.string() + ": not there; install the build again");
    }
    preload += ":" + player.string();
    setenv("TORSO_MOTION", std::filesystem::absolute(motion).c_str(), 1);
  }
  if (isSet("LD_PRELOAD")) preload += fmt::format(":{}", std::getenv("LD_PRELOAD"));
  setenv("LD_PRELOAD", preload.c_str(), 1);
  execlp(kViewer, kViewer, model.c_str(), static_cast<char*>(nullptr));
  if (errno == ENOENT) {
    throw Error(
        fmt::format("{}: MuJoCo's viewer {} is not installed; install the package "
                    "libmujoco-samples",
                    model, kViewer));
  }
  throw Error(fmt::format("{}: cannot start {}: {}", model, kViewer, std::strerror(errno)));
}

}  // namespace

void addView(CLI::App& app) {
  auto model = std::make_shared<std::string>();
  auto motion = std::make_shared<std::string>();
  CLI::App* command =
      app.add_subcommand("view", "Open a model in MuJoCo's own viewer, with the torso plugin.");
  command->footer(
      "The viewer is mujoco-simulate from the package libmujoco-samples, unmodified; the plugin "
      "is\n"
      "loaded into it with LD_PRELOAD. In the viewer, press F1 for help.\n\n"
      "Examples:\n"
      "  torso view mjcf/human.xml\n"
      "  torso view out/walk.xml --motion out/walk.bin");
  command->add_option("MODEL", *model, "MJCF, URDF or MJB file")->required();
  command->add_option("--motion", *motion,
                      "Play this motion (CSV or binary, as torso retrofit writes them) over and "
                      "over, instead of simulating");
  command->callback([model, motion] { view(*model, *motion); });
}

}  // namespace torso::tools
