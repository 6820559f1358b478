// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/disc_data.h"

#include "plugin/mujoco_torso.h"
#include "tools/error.h"
#include "tools/mujoco_eigen.h"

namespace torso::tools {
namespace {

void check(int status) {
  if (status == 0) return;
  char message[500];
  torso_lastError(message, sizeof(message));
  throw Error(message);
}

}  // namespace

std::vector<DiscData> discData(const mjModel* m, const mjData* d) {
  torsoInfo info = {};
  torso_info(m, &info, nullptr, 0);
  std::vector<DiscData> discs(info.ndisc);
  for (int i = 0; i < info.ndisc; i++) {
    DiscData& disc = discs[i];
    int nnode, ntet;
    check(torso_discSize(m, i, &nnode, &ntet));
    disc.name = torso_discName(m, i);
    disc.nodes.resize(nnode);
    disc.rest.resize(nnode);
    disc.tets.resize(ntet);
    disc.cells.resize(ntet);
    disc.stress.resize(ntet);
    disc.fibre_stretch.resize(ntet);
    mjtNum axes[9];
    check(torso_discNodes(m, d, i, disc.nodes[0].data()));
    check(torso_discRest(m, i, disc.rest[0].data()));
    check(torso_discFrame(m, d, i, disc.origin.data(), axes));
    check(torso_discTets(m, i, disc.tets[0].data()));
    check(torso_discCells(m, i, disc.cells.data()));
    // Symmetric, so that the order of the entries does not matter.
    check(torso_discStress(m, d, i, disc.stress[0].data(), disc.fibre_stretch[0].data()));
    disc.axes = matrix3(axes);
  }
  return discs;
}

}  // namespace torso::tools
