// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The fast disc solver: many discs at once. Discs of equal topology (tets and attached nodes) share
// the lanes of one SIMD register (8 floats), so that gather, local step and triangular solves run
// for 8 discs at the cost of one; a disc whose topology nobody shares gets a group of its own. An
// evaluation moves the last shape by the response, linear at rest, to the bones' motion since; then
// one iteration is
//   local step at that shape -> residual -> correction with the factored rest Hessian,
// in the frame half way between the two bones. Where the strain is large, the correction's length
// is chosen by the volume term's curvature along it. The wrench is the virtual work of the internal
// forces on the rest Hessian's own response to a motion of the endplates, so its error is of second
// order. State is the displacement of the free nodes from rest in that frame, and the pose it
// belongs to; all zeros is rest.

#include <cstddef>
#include <memory>
#include <string>

#include "model/disc.h"

namespace torso {

class DiscBatch {
 public:
  struct Disc {
    DiscMesh mesh;
    DiscMaterial material;
  };
  struct Options {
    // An iteration is repeated while it asks a free node to move by more than `tolerance` times the
    // disc's height along an axis, `max_iterations` at most.
    double tolerance = 0.02;
    int max_iterations = 8;
  };

  // Throws std::invalid_argument that names the disc's index and what is wrong with it.
  explicit DiscBatch(const std::vector<Disc>& discs);
  ~DiscBatch();

  int size() const;                 // number of discs
  int stateSize() const;            // doubles of state for all discs together
  std::size_t scratchSize() const;  // bytes of 64-byte aligned scratch that evaluate needs

  // Reads the poses (size) and the state (stateSize) the iteration starts from; writes the state it
  // reaches (state_out may equal state_in) and the wrenches (size). Allocates nothing, keeps
  // nothing: any number of threads may call it on one object, each with its own scratch. The same
  // input gives the same bits, whatever the other discs do. Any finite poses and state give a
  // finite answer. Returns the largest number of iterations that a group took.
  int evaluate(const DiscPose* poses, const double* state_in, double* state_out,
               DiscWrench* wrenches, void* scratch, const Options& options) const;

  // Writes node positions [m] of disc i in its lower disc frame, (nnode x 3) row major. state is
  // that of all discs, pose the one at which it was reached.
  void positions(int i, const DiscPose& pose, const double* state, double* xpos) const;

  // Tangent stiffness at rest of disc i about the disc's centre, (6 x 6), as ReferenceDisc's.
  const Eigen::Matrix<double, 6, 6>& restStiffness(int i) const;
  const Disc& disc(int i) const;

  // Name of the instruction set in use: "avx512", "avx2" or "portable". setInstructionSet is for
  // tests and benchmarks; it returns false if this machine lacks the set.
  static const char* instructionSet();
  static bool setInstructionSet(const std::string& name);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace torso
