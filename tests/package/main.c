/* Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0 */
/* Prints the number of discs of a model; fails if there is none. */
#include <mujoco_torso.h>
#include <stdio.h>

int main(int argc, char** argv) {
  char error[500] = "";
  mjModel* m = argc > 1 ? mj_loadXML(argv[1], NULL, error, sizeof error) : NULL;
  torsoInfo info;
  if (!m || torso_info(m, &info, error, sizeof error) != 1) {
    fprintf(stderr, "%s\n", error);
    return 1;
  }
  printf("%d discs\n", info.ndisc);
  mj_deleteModel(m);
  return 0;
}
