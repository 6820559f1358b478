/* Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0 */
#ifndef TORSO_TOOLS_MPI_MODULE_H_
#define TORSO_TOOLS_MPI_MODULE_H_

#ifdef __cplusplus
extern "C" {
#endif

/* join the processes that mpirun has started: this one's rank, and how many there are */
void torso_mpiStart(int* rank, int* size);
void torso_mpiSend(int to, const char* text, int size);
/* wait for the next message of a process, and return its size */
int torso_mpiIncoming(int from);
void torso_mpiReceive(int from, char* text, int size);
/* leave them; returns when all have called it */
void torso_mpiStop(void);

#ifdef __cplusplus
}
#endif

#endif /* TORSO_TOOLS_MPI_MODULE_H_ */
