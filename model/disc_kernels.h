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
// of elimination: free nodes first, then the lower, then the upper attached nodes. "Offset of a
// node" is 24 x its number: that of its first float in an array (node x 3).
struct DiscGroupView {
  int nnode, nfree, nlower;
  const float* rest;         // (node x 3) rest position [m]
  const float* force_error;  // (node x 3) minus what rounding makes of the forces at rest [N]
  const float* limit;        // (1) largest displacement that is believed [m]

  // Shear: rows of DiscElasticity::laplacian.
  const int* shear_row;     // (nnode + 1) first entry of each node's row
  const int* shear_column;  // (entry) offset of the node
  const float* shear;       // (entry) [N/m]

  // Cells, the nucleus last if there is one.
  int ncell;
  bool nucleus;
  const int* cell_node;      // (ncell + 1) first entry in cell_nodes
  const int* cell_nodes;     // (cell's node) offset of the node
  const int* cell_link;      // (cell's node + 1) first entry in cell_links
  const int* cell_links;     // (entry x 3) 24 x places k, i, j among the cell's nodes: the volume's
                             // gradient at a node is the sum of x_k x (x_j - x_i) / 6, positions
                             // relative to the cell's node 0
  const float* cell_volume;  // (cell x 3) volume [m^3], mu [Pa], (lambda + mu) / volume [N/m^5]
  const float* fibres;       // (cell's node x 2) DiscElasticity::Cell::fibres [1/m]
  const float* fibre_rest;   // (cell x 2 x 3) direction at rest
  const float* fibre_law;    // (cell x 2) volume Ef [Nm], stiffening

  // The metric of the global step. Cholesky factor L in 3x3 blocks.
  const int* column;              // (nfree + 1) first block below the diagonal of each block column
  const int* row;                 // (block) offset of the block's row
  const float* diagonal;          // (nfree x 6) 1/l00, l10, 1/l11, l20, l21, 1/l22
  const float* below;             // (block x 9) row major
  const float* response;          // (nfree x 3 x 6) DiscElasticity::response
  const float* wrench_response;   // (nfree x 3 x 6) DiscElasticity::response_without_nucleus
  const float* nucleus_response;  // (nfree x 3) DiscElasticity::nucleus_response
  const float* nucleus_gradient;  // (nucleus' node x 3) of 6 x its volume at rest [m^2]
  const float* nucleus_wrench;    // (6) wrench on the upper bone per pressure of the nucleus, with
                                  // the free nodes in equilibrium [m^2], [m^3]
};

struct DiscKernels {
  const char* name;

  // Free part of the displacements u (nnode x 3 x 8) from the state (nfree x 3 x 8), moved by the
  // response to the change of the bones' pose since (6 x 8). keep (8): 0 for lanes whose state
  // counts as rest, else 1.
  void (*predict)(const DiscGroupView&, const double* state, const float* keep,
                  const float* pose_change, float* u);
  // Local step: internal forces f (nnode x 3 x 8) [N] at displacements u, and the nucleus' pressure
  // (8) [Pa]. work (nnode + 3 x nodes of the largest cell) x 3 x 8 is left holding the gradient of
  // the last cell's volume, for `nucleus` and `gradient`.
  void (*forces)(const DiscGroupView&, const float* u, float* f, float* pressure, float* work);
  // Wrench (6 x 8) on the upper bone in frame M: half the difference of the forces on the two
  // endplates. correction (6 x 8) is the work of the residual on the response to the bones' motion:
  // what a full correction with the metric but for the nucleus' pressure adds to the wrench.
  void (*wrench)(const DiscGroupView&, const float* u, const float* f, float* wrench,
                 float* correction);
  // Free part of d (nnode x 3 x 8): solution of L L^T d = f.
  void (*solve)(const DiscGroupView&, const float* f, float* d);
  // Adds to d the nucleus' volume term, of which the metric has the present gradient (work, see
  // forces). response (nnode x 3): solution for that gradient, or for the one at rest where the two
  // are near enough. pressure_change (8): rise of its pressure that d brings [Pa]; change (8): the
  // largest component of d [m].
  void (*nucleus)(const DiscGroupView&, const float* work, const float* response, float* d,
                  float* pressure_change, float* change);
  // Free part of the present gradient (work) of the nucleus' volume (nnode x 3 x 8) [m^2].
  void (*gradient)(const DiscGroupView&, const float* work, float* out);
  // Adds factor (8) times d to u, free part.
  void (*apply)(const DiscGroupView&, const float* factor, const float* d, float* u);
  // Work (8) of the forces f along d, free part [J].
  void (*slope)(const DiscGroupView&, const float* f, const float* d, float* out);
  void (*store)(const DiscGroupView&, const float* u, double* state);
};

extern const DiscKernels kDiscKernelsPortable;
extern const DiscKernels kDiscKernelsAvx2;
extern const DiscKernels kDiscKernelsAvx512;

}  // namespace torso
