// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/rest.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/error.h"
#include "tools/mujoco_support.h"

namespace torso::tools {

void stepToRest(const mjModel* m, mjData* d, const Rest& rest, const std::string& name,
                const std::function<void()>& applyLoad) {
  constexpr double kHold = 0.1;  // [s]
  const int hold = static_cast<int>(std::ceil(kHold / m->opt.timestep));
  for (double time = 0; time < rest.longest; time += kHold) {
    for (int i = 0; i < hold; i++) {
      applyLoad();
      mj_step(m, d);
    }
    double speed = 0;
    for (int i = 0; i < m->nv; i++) speed = std::max(speed, std::abs(d->qvel[i]));
    if (speed < rest.speed) break;
  }
  const std::string warning = firstWarning(d);
  if (!warning.empty()) throw Error(fmt::format("{}: {}", name, warning));
}

}  // namespace torso::tools
