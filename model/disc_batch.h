// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The fast disc solver: many discs at once. Discs of equal topology (tets, cells and attached
// nodes) share the lanes of one SIMD register (8 floats), so that gather, local step and triangular
// solves run for 8 discs at the cost of one; a disc whose topology nobody shares gets a group of
// its own.
//
// It is projective dynamics seen as a quasi-Newton method (Liu, Bouaziz and Kavan 2017, ACM Trans.
// Graph. 36:23): each iteration is
//   local step at the present shape -> residual -> correction with a constant, factored metric,
// the metric being the Hessian at rest with all fibres taut, in the frame half way between the two
// bones, plus the volume term of the nucleus as it is now (Sherman and Morrison's formula). An
// evaluation first moves the last shape by the response, linear at rest, to the bones' motion
// since. The wrench is the virtual work of the internal forces on the metric's own response to a
// motion of the endplates, so its error is of second order. A group of discs whose bones have all
// stayed where they were, and whose shape had settled, is not computed again. State is the wrench,
// the pose it belongs to, and the displacement of the free nodes from rest; all zeros is rest.

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
    // An iteration is repeated, `max_iterations` at most, while it asks a free node to move by more
    // than `tolerance` times the disc's height along an axis, or corrects the wrench by more than
    // `wrench_tolerance` of itself: what it leaves to correct is a fraction of that.
    double tolerance = 0.04;
    double wrench_tolerance = 0.015;
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

  // Stiffness of disc i near rest about its centre were all fibres taut, (6 x 6), SI: an upper
  // bound of the tangent stiffness at rest, see DiscElasticity.
  const Eigen::Matrix<double, 6, 6>& boundStiffness(int i) const;
  const Disc& disc(int i) const;

  // Name of the instruction set in use: "avx512", "avx2" or "portable". setInstructionSet is for
  // tests and benchmarks, to be called before a batch is made; it returns false if this machine
  // lacks the set.
  static const char* instructionSet();
  static bool setInstructionSet(const std::string& name);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace torso
