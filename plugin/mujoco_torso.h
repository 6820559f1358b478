/* Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0 */
#ifndef MUJOCO_TORSO_H_
#define MUJOCO_TORSO_H_

/* C interface of the torso plugin, in MuJoCo's manner: const mjModel, mutable mjData, SI units,
 * outputs in caller-owned arrays, world frame. Link with libmujoco_torso.so (or dlopen it, or
 * LD_PRELOAD it into any MuJoCo program): loading the library installs it.
 *
 * Functions that take mjData report what the last mj_forward, mj_step1 or mj_step computed. None of
 * them exits or prints; those that can fail say so in their return value and leave a message for
 * torso_lastError (one per thread). */

#include <mujoco/mujoco.h>

#ifdef __cplusplus
extern "C" {
#endif

#define TORSO_VERSION 10 /* 100 * major + 10 * minor + patch: 0.1.0 */
#define TORSO_VERSION_STRING "0.1.0"

/* version of the library at run time, as TORSO_VERSION; and as text */
MJAPI int torso_version(void);
MJAPI const char* torso_versionString(void);

/* Set MuJoCo's global callbacks (mjcb_passive, mjcb_sensor) and the sphere-ellipsoid entry of
 * mjCOLLISIONFUNC. What was there before is kept and called. Loading the library does this already;
 * call it again after a program has overwritten or reset MuJoCo's callbacks. Safe to repeat. */
MJAPI void torso_install(void);
/* put back what torso_install found, where nobody has replaced it since; frees all torso instances
 */
MJAPI void torso_uninstall(void);
MJAPI int torso_isInstalled(void);

/* sizes of the torso data found in a model */
typedef struct torsoInfo_ {
  int ntorso;      /* torsos in the model */
  int ndisc;       /* intervertebral discs */
  int nligament;   /* ligaments (chains) */
  int nligsegment; /* ligament segments (spatial tendons) */
  int nfacet;      /* facets */
  int nfacetpoint; /* facet points, all facets together */
  int nuserdata;   /* mjData.userdata entries that the discs need */
} torsoInfo;

/* 1: the model holds a sound torso, *info is filled; 0: it holds no torso data; -1: the data are
 * damaged, error says where. info and error may be NULL. The first call for a model builds its disc
 * solvers (some milliseconds); the callbacks do the same at a model's first step. */
MJAPI int torso_info(const mjModel* m, torsoInfo* info, char* error, int error_sz);

/* copy the calling thread's last error into buf, return its length; "" if there was none */
MJAPI int torso_lastError(char* buf, int buf_sz);

/* put the discs back to rest shape; mj_resetData does the same */
MJAPI void torso_reset(const mjModel* m, mjData* d);

/* ---- discs, index 0 .. ndisc-1 ---- */

/* index from name, e.g. "L4/L5" (with the torso's prefix, if it has one); -1 if there is none */
MJAPI int torso_discId(const mjModel* m, const char* name);
MJAPI const char* torso_discName(const mjModel* m, int disc);
/* body ids of the disc's lower and upper bone; returns 0, or -1 on error, as do all below */
MJAPI int torso_discBodies(const mjModel* m, int disc, int bodyid[2]);
/* numbers of nodes and of tetrahedra */
MJAPI int torso_discSize(const mjModel* m, int disc, int* nnode, int* ntet);
/* node indices (ntet x 4) */
MJAPI int torso_discTets(const mjModel* m, int disc, int* tet);
/* cell of the annulus that each tetrahedron belongs to, -1 in the nucleus (ntet) */
MJAPI int torso_discCells(const mjModel* m, int disc, int* cell);
/* node positions at rest in the disc frame (nnode x 3) [m] */
MJAPI int torso_discRest(const mjModel* m, int disc, mjtNum* pos);
/* id of the skin that shows the disc in viewers, -1 if it has none or on error */
MJAPI int torso_discSkin(const mjModel* m, int disc);
/* the disc frame, which moves with the lower bone, in the world: origin [m] and axes (row-major,
 * the columns are x forward, y left, z along the disc's axis) */
MJAPI int torso_discFrame(const mjModel* m, const mjData* d, int disc, mjtNum pos[3],
                          mjtNum mat[9]);
/* node positions in the world (nnode x 3) [m] */
MJAPI int torso_discNodes(const mjModel* m, const mjData* d, int disc, mjtNum* xpos);
/* Cauchy stress in the world frame (ntet x 9, symmetric) [Pa], and the stretch of the two fibre
 * families (ntet x 2), 1 in the nucleus. Either may be NULL. Elastic, without the disc's viscosity.
 * Allocates: not for callbacks */
MJAPI int torso_discStress(const mjModel* m, const mjData* d, int disc, mjtNum* stress,
                           mjtNum* stretch);
/* elastic force [N] and moment [Nm] on the upper bone, about point [m], all in the world frame; the
 * lower bone gets the opposite at the same point. point may be NULL */
MJAPI int torso_discWrench(const mjModel* m, const mjData* d, int disc, mjtNum force[3],
                           mjtNum moment[3], mjtNum point[3]);
/* normal force on the upper endplate over its area [Pa], positive in compression; 0 on error */
MJAPI mjtNum torso_discPressure(const mjModel* m, const mjData* d, int disc);
/* pressure in the disc's nucleus above rest [Pa], as a needle in it measures; 0 on error */
MJAPI mjtNum torso_discNucleusPressure(const mjModel* m, const mjData* d, int disc);
/* distance between the endplates relative to rest: at the disc's thinnest column of nodes, on
 * average, and at the thickest */
MJAPI int torso_discThickness(const mjModel* m, const mjData* d, int disc, mjtNum ratio[3]);

/* ---- facets, index 0 .. nfacet-1 ---- */

MJAPI int torso_facetId(const mjModel* m, const char* name);
MJAPI const char* torso_facetName(const mjModel* m, int facet);
/* contact force of all points of a facet on the bone that carries the points, world frame [N] */
MJAPI int torso_facetForce(const mjModel* m, const mjData* d, int facet, mjtNum force[3]);
/* largest distance of a facet's points beyond the band [m]; 0 if all are within it */
MJAPI mjtNum torso_facetViolation(const mjModel* m, const mjData* d, int facet);

/* ---- ligaments ---- */

/* tension of the ligament segment that is tendon number tendonid [N]; 0 while it is slack */
MJAPI mjtNum torso_ligamentTension(const mjModel* m, const mjData* d, int tendonid);

/* ---- rollouts: for any model, with a torso or without ---- */

/* Parts of a state vector; it holds those that are asked for, in this order. */
typedef enum torsoState_ {
  TORSO_STATE_PHYSICS = 1,   /* time (1) [s], qpos (nq), qvel (nv), act (na) */
  TORSO_STATE_USERDATA = 2,  /* userdata (nuserdata), which holds the shapes of the discs */
  TORSO_STATE_WARMSTART = 4, /* qacc_warmstart (nv), from which the constraint solver starts */
  TORSO_STATE_FULL = 7       /* all: with its inputs, everything that the next mj_step depends on */
} torsoState;

/* number of entries of a state vector with the parts spec, an or of torsoState; -1 on error */
MJAPI int torso_stateSize(const mjModel* m, int spec);
/* copy these parts from d to state, or back; what is not asked for stays as it is */
MJAPI int torso_getState(const mjModel* m, const mjData* d, mjtNum* state, int spec);
MJAPI int torso_setState(const mjModel* m, mjData* d, const mjtNum* state, int spec);

/* how a trajectory ended */
typedef enum torsoStatus_ {
  TORSO_OK = 0,         /* all of its steps were done */
  TORSO_CANCELLED = 1,  /* the caller stopped it */
  TORSO_NOT_FINITE = 2, /* a step led to a qpos, qvel or act that is not finite, or huge */
  TORSO_ERROR = 3,      /* a callback or mju_user_error threw an exception */
  TORSO_WARNING = 16 /* TORSO_WARNING + mjtWarning: MuJoCo warned, e.g. of a full contact table */
} torsoStatus;

/* what a status means: a static string */
MJAPI const char* torso_statusText(int status);

/* Called before a step, to set ctrl, xfrc_applied, mocap_pos or any other input in d. */
typedef void (*torsofInput)(const mjModel* m, mjData* d, int trajectory, int step, void* user);
/* Cost of a step, called after it: d is as mj_step leaves it, see sensordata below. May compute
 * what it needs in d (mj_subtreeVel), but not change the state. */
typedef mjtNum (*torsofCost)(const mjModel* m, mjData* d, int trajectory, int step, void* user);

/* A batch of trajectories; arrays are the caller's, row-major. */
typedef struct torsoRollout_ {
  int ntrajectory;
  int nstep; /* steps of each */

  /* start: as after mj_resetData, then the parts initial_spec of initial_state (ninitial x
   * stateSize). One row (ninitial = 1) is for all trajectories, else ninitial = ntrajectory. NULL:
   * none. A start without userdata has its discs at rest, one without warm start starts the solver
   * at zero. */
  const mjtNum* initial_state;
  int ninitial;
  int initial_spec;

  /* inputs; NULL: none, the controls are zero. input, if any, is called after control was set. */
  const mjtNum* control; /* (ntrajectory x nstep x nu) */
  torsofInput input;

  /* results; NULL: not wanted. Rows of steps that a trajectory did not do are not written. */
  mjtNum* state; /* after each step (ntrajectory x nstep x stateSize(state_spec)) */
  int state_spec;
  mjtNum* sensordata;  /* (ntrajectory x nstep x nsensordata). As after mj_step, it belongs to the
                          state before the step; with RK4, to its last stage */
  mjtNum* final_state; /* of each that ended TORSO_OK (ntrajectory x stateSize(TORSO_STATE_FULL)).
                          As initial_state of another rollout it goes on with the same bits as one
                          long rollout */
  torsofCost step_cost;
  mjtNum* cost; /* sum of step_cost over the steps done, in their order (ntrajectory) */
  int* status;  /* (ntrajectory) torsoStatus */
  int* steps;   /* steps done (ntrajectory) */

  void* user;        /* for the callbacks, which any of the threads calls */
  const int* cancel; /* set it to nonzero (atomically, from a callback, thread or signal handler) to
                        cancel: each trajectory is then either done, or ends as TORSO_CANCELLED
                        before its next step. NULL: never */
} torsoRollout;

/* zero sizes, no arrays and callbacks; the parts are TORSO_STATE_FULL at the start, and
 * TORSO_STATE_PHYSICS for state */
MJAPI void torso_defaultRollout(torsoRollout* r);

/* Roll out all trajectories on nthread threads, the calling one included. d: nthread different
 * mjData of this model, scratch. Every trajectory has the same bits whatever nthread is. One that
 * fails ends early and does not touch the others. Returns the number of trajectories that did not
 * end as TORSO_OK, or -1, with nothing done, if an argument is wrong or the torso's data are
 * damaged (torso_lastError says what). Allocates for its threads only, not for trajectories and
 * steps. If the system grants fewer threads, it makes do with those. MuJoCo's warnings go to
 * mju_user_warning, or to the console and MUJOCO_LOG.TXT, as ever; the texts of two at the same
 * moment may mix, for MuJoCo's threads share a buffer. */
MJAPI int torso_rollout(const mjModel* m, mjData* const* d, int nthread, const torsoRollout* r);

#ifdef __cplusplus
}
#endif

#endif /* MUJOCO_TORSO_H_ */
