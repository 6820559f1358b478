/* Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
 *
 * Rolls out random controls from one start on several threads, and says which sequence cost least:
 *   rollout MODEL [TRAJECTORIES [STEPS [THREADS]]]
 * The cost is the mean squared speed of the joints. Compile: cc rollout.c -lmujoco_torso -lmujoco
 */
#include <mujoco_torso.h>
#include <stdio.h>
#include <stdlib.h>

static mjtNum squaredSpeed(const mjModel* m, mjData* d, int trajectory, int step, void* user) {
  (void)trajectory;
  (void)step;
  (void)user;
  return mju_dot(d->qvel, d->qvel, m->nv) / m->nv;
}

int main(int argc, char** argv) {
  const int ntrajectory = argc > 2 ? atoi(argv[2]) : 8;
  const int nstep = argc > 3 ? atoi(argv[3]) : 60;
  const int nthread = argc > 4 ? atoi(argv[4]) : 2;
  char error[500] = "";
  mjModel* m = argc > 1 ? mj_loadXML(argv[1], NULL, error, sizeof error) : NULL;
  if (!m || ntrajectory < 1 || nstep < 1 || nthread < 1) {
    fprintf(stderr, "%s\n",
            *error ? error : "usage: rollout MODEL [TRAJECTORIES [STEPS [THREADS]]]");
    return 1;
  }
  int i, k, failed;
  mjData** d = malloc(nthread * sizeof *d);
  mjtNum* control = malloc(((size_t)ntrajectory * nstep * m->nu + 1) * sizeof *control);
  mjtNum* cost = malloc(ntrajectory * sizeof *cost);
  int* status = malloc(ntrajectory * sizeof *status);
  for (i = 0; i < nthread; i++) d[i] = mj_makeData(m);
  for (i = 0; i < ntrajectory; i++) {
    const int n = nstep * m->nu;
    for (k = 0; k < n; k++) control[(size_t)i * n + k] = 0.02 * i;
  }

  torsoRollout r;
  torso_defaultRollout(&r);
  r.ntrajectory = ntrajectory;
  r.nstep = nstep;
  r.control = control;
  r.step_cost = squaredSpeed;
  r.cost = cost;
  r.status = status;
  failed = torso_rollout(m, d, nthread, &r);
  if (failed < 0) {
    torso_lastError(error, sizeof error);
    fprintf(stderr, "%s\n", error);
    return 1;
  }
  for (i = 0; i < ntrajectory; i++) {
    printf("control %.2f: mean squared speed %.6g, %s\n", 0.02 * i, cost[i] / nstep,
           torso_statusText(status[i]));
  }

  for (i = 0; i < nthread; i++) mj_deleteData(d[i]);
  mj_deleteModel(m);
  free(d);
  free(control);
  free(cost);
  free(status);
  return failed ? 1 : 0;
}
