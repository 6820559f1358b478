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

#ifdef __cplusplus
}
#endif

#endif /* MUJOCO_TORSO_H_ */
