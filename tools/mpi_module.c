/* Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
 *
 * libtorso_mpi.so: what processes.cc needs of MPI. A library of its own, opened only under mpirun,
 * so that nothing else of the project depends on MPI. MPI ends all processes when a call fails. */
#include "tools/mpi_module.h"

#include <mpi.h>

void torso_mpiStart(int* rank, int* size) {
  int provided;
  MPI_Init_thread(NULL, NULL, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, rank);
  MPI_Comm_size(MPI_COMM_WORLD, size);
}

void torso_mpiSend(int to, const char* text, int size) {
  MPI_Send(text, size, MPI_CHAR, to, 0, MPI_COMM_WORLD);
}

int torso_mpiIncoming(int from) {
  MPI_Status status;
  int size;
  MPI_Probe(from, 0, MPI_COMM_WORLD, &status);
  MPI_Get_count(&status, MPI_CHAR, &size);
  return size;
}

void torso_mpiReceive(int from, char* text, int size) {
  MPI_Recv(text, size, MPI_CHAR, from, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
}

void torso_mpiStop(void) { MPI_Finalize(); }
