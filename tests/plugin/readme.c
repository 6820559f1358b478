/* Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0 */
#include <mujoco_torso.h>
#include <stdio.h>

int main(int argc, char** argv) {
  char error[500] = "";
  mjModel* m = mj_loadXML(argc > 1 ? argv[1] : "mjcf/human.xml", NULL, error, sizeof error);
  if (!m) return fprintf(stderr, "%s\n", error), 1;
  mjData* d = mj_makeData(m);
  while (d->time < 1) mj_step(m, d);
  printf("L4/L5: %.3f MPa\n", 1e-6 * torso_discPressure(m, d, torso_discId(m, "L4/L5")));
  mj_deleteData(d);
  mj_deleteModel(m);
  return 0;
}
