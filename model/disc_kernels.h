// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The inner loops of the fast disc solver: up to 8 discs of equal topology, one per SIMD lane.
// Internal to DiscBatch, its tests and its benchmark.
//
// This header is included by translation units compiled for other instruction sets than the rest of
// the program. It therefore declares plain data only: an inline function of a shared header,
// compiled for AVX in one unit, could be the copy that the linker keeps for all.

namespace torso {

constexpr int kLanes = 8;

// Arrays of floats have 8 lanes innermost and are 64-byte aligned. Nodes are numbered in the order
// of elimination: free nodes first, then the lower, then the upper attached nodes.
struct DiscGroupView {
  int nnode, nfree, nlower, ntet;
  const int* tets;             // (ntet x 4) offset of the node's first float: 24 x node
  const float* inverse_edges;  // (ntet x 9) [1/m], row major
  const float* weight;         // (ntet) 2 mu V [Nm]
  const float* ratio;          // (1) kappa / 2 mu
  const float* rest;           // (attached node x 3) rest position [m]
  const float* response;       // (nfree x 3 x 6) DiscElasticity::response
  const float* limit;          // (1) largest displacement that is believed [m]

  // Cholesky factor L of the rest Hessian in 3x3 blocks.
  const int* column;      // (nfree + 1) first block below the diagonal of each block column
  const int* row;         // (block) offset of the block's row in x: 24 x node
  const float* diagonal;  // (nfree x 6) 1/l00, l10, 1/l11, l20, l21, 1/l22
  const float* below;     // (block x 9) row major
};

struct DiscKernels {
  const char* name;

  // Free part of the displacements u (nnode x 3 x 8) from the state (nfree x 3 x 8), moved by the
  // response to the change of the bones' pose since (6 x 8).
  void (*predict)(const DiscGroupView&, const double* state, const float* pose_change, float* u);
  // Local step: internal forces f (nnode x 3 x 8) [N] at displacements u.
  void (*forces)(const DiscGroupView&, const float* u, float* f);
  // Wrench (6 x 8) on the upper bone in frame M: half the difference of the forces on the two
  // endplates. correction (6 x 8) is the work of the residual on the response to the bones' motion:
  // what a full correction with the rest Hessian adds to the wrench.
  void (*wrench)(const DiscGroupView&, const float* u, const float* f, float* wrench,
                 float* correction);
  // Solves with the rest Hessian for the free part of f, in place: the correction d. work (8) is
  // f d [J], change (8) the largest component of d.
  void (*solve)(const DiscGroupView&, float* f, float* work, float* change);
  // What the curvature of the volume term along a correction (nnode x 3 x 8, zero on attached
  // nodes) at u has above the rest Hessian's (8) [J].
  void (*stiffening)(const DiscGroupView&, const float* u, const float* correction, float* out);
  // Adds factor (8) times the correction to the free part of u, no component more than `largest`
  // (8).
  void (*apply)(const DiscGroupView&, const float* factor, const float* largest,
                const float* correction, float* u);
  void (*store)(const DiscGroupView&, const float* u, double* state);
  // The local step of one tet alone, for tests: F and stress / 2 mu are (9 x 8), row major; ratio
  // is (8).
  void (*stress)(const float* F, const float* ratio, float* stress);
};

extern const DiscKernels kDiscKernelsPortable;
extern const DiscKernels kDiscKernelsAvx2;
extern const DiscKernels kDiscKernelsAvx512;

// What the kernels do with a deformation gradient F (9, row major) that their series does not
// converge for (crushed, inverted or blown-up tets): the same law from a singular value
// decomposition, in double. stress = F - R + ratio (F - P).
void discStressBySvd(const float* F, float ratio, float* stress);

}  // namespace torso
