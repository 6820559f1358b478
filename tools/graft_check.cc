// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
// What must hold of the result.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/grafter.h"

namespace torso::tools {
namespace {

using Eigen::Vector3d;

constexpr double kMassTolerance = 0.01, kLengthTolerance = 0.02;

}  // namespace

void Grafter::check(const mjModel* m) {
  report_.mass_after = mj_getTotalmass(m);
  if (std::abs(report_.mass_after - report_.mass_before) > kMassTolerance * report_.mass_before) {
    fail(fmt::format("the grafted model would weigh {:.3f} kg instead of {:.3f} kg",
                     report_.mass_after, report_.mass_before));
  }
  const torsoInfo info = torsoOf(m, o_.output);
  if (info.ndisc == 0) fail("the grafted model has no discs");
  const DataPtr d = makeData(m);
  mj_fwdPosition(m, d.get());

  // Limb joints: as many, of the same names and types, in the same order.
  const mjModel* h = host_.model.get();
  std::array<Vector3d, 4> centre;
  report_.limb_joints = 0;
  for (const auto& [limbs, first] : {std::pair{parts_.thigh, 0}, {parts_.upper_arm, 2}}) {
    std::vector<int> before, after;
    for (int k = 0; k < 2; k++) {
      const int limb = mj_name2id(m, mjOBJ_BODY, host_.bodyName(limbs[k]).c_str());
      centre[first + k] = Vector3d::Zero();
      for (int j = 0; j < m->body_jntnum[limb]; j++) {
        const mjtNum* x = d->xanchor + 3 * (m->body_jntadr[limb] + j);
        centre[first + k] += Vector3d(x[0], x[1], x[2]) / m->body_jntnum[limb];
      }
      const auto below = [](const mjModel* model, int joint, int ancestor) {
        int b = model->jnt_bodyid[joint];
        while (b > ancestor) b = model->body_parentid[b];
        return b == ancestor;
      };
      for (int j = 0; j < h->njnt; j++) {
        if (below(h, j, limbs[k])) before.push_back(j);
      }
      for (int j = 0; j < m->njnt; j++) {
        if (below(m, j, limb)) after.push_back(j);
      }
    }
    std::sort(before.begin(), before.end());
    std::sort(after.begin(), after.end());
    bool same = before.size() == after.size();
    for (std::size_t i = 0; same && i < before.size(); i++) {
      const char *x = mj_id2name(h, mjOBJ_JOINT, before[i]),
                 *y = mj_id2name(m, mjOBJ_JOINT, after[i]);
      same = h->jnt_type[before[i]] == m->jnt_type[after[i]] &&
             std::string(x ? x : "") == (y ? y : "");
    }
    if (!same) fail("the joints of the limbs would not be those of the humanoid");
    report_.limb_joints += static_cast<int>(after.size());
  }
  report_.hip_to_shoulder_after = 0.5 * (centre[2] + centre[3] - centre[0] - centre[1]).norm();
  if (std::abs(report_.hip_to_shoulder_after / report_.hip_to_shoulder_before - 1) >
      kLengthTolerance) {
    fail(fmt::format("hip to shoulder would be {:.3f} m instead of {:.3f} m",
                     report_.hip_to_shoulder_after, report_.hip_to_shoulder_before));
  }
}

}  // namespace torso::tools
