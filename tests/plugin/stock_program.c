/* Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
 *
 * A program that knows MuJoCo only. Runs a model with its controls at zero and says what it saw:
 *   stock_program MODEL SECONDS [LIBRARY to dlopen first] */
#include <dlfcn.h>
#include <mujoco/mujoco.h>
#include <stdio.h>
#include <stdlib.h>

static int warnings = 0;
static void onWarning(const char* message) {
  warnings++;
  fprintf(stderr, "warning: %s\n", message);
}

/* largest distance between the two anchors of a weld: how far the bones have parted [m] */
static mjtNum largestShift(const mjModel* m, const mjData* d) {
  mjtNum largest = 0;
  for (int i = 0; i < m->neq; i++) {
    if (m->eq_type[i] != mjEQ_WELD) continue;
    const int body1 = m->eq_obj1id[i], body2 = m->eq_obj2id[i];
    const mjtNum* anchor = m->eq_data + mjNEQDATA * i;
    mjtNum p1[3], p2[3];
    mju_rotVecMat(p1, anchor + 3, d->xmat + 9 * body1);
    mju_rotVecMat(p2, anchor, d->xmat + 9 * body2);
    mju_addTo3(p1, d->xpos + 3 * body1);
    mju_addTo3(p2, d->xpos + 3 * body2);
    largest = mju_max(largest, mju_dist3(p1, p2));
  }
  return largest;
}

int main(int argc, char** argv) {
  char error[1000] = "";
  if (argc < 3) return 2;
  if (argc > 3 && !dlopen(argv[3], RTLD_NOW)) {
    fprintf(stderr, "%s\n", dlerror());
    return 3;
  }
  mju_user_warning = onWarning;
  mjModel* m = mj_loadXML(argv[1], NULL, error, sizeof error);
  if (!m) {
    printf("error %s\n", error);
    return 1;
  }
  mjData* d = mj_makeData(m);
  mjtNum shift = 0, userdata = 0, sensors = 0;
  while (d->time < atof(argv[2])) {
    mj_step(m, d);
    shift = mju_max(shift, largestShift(m, d));
  }
  for (int i = 0; i < m->nuserdata; i++) userdata += mju_abs(d->userdata[i]);
  for (int i = 0; i < m->nsensordata; i++) sensors += mju_abs(d->sensordata[i]);
  printf("warnings %d\nshift_mm %.3f\nuserdata %g\nsensors %g\n", warnings, 1e3 * shift, userdata,
         sensors);
  mj_deleteData(d);
  mj_deleteModel(m);
  return 0;
}
