// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The plain disc solver: one disc of any topology, double precision, SVD projections, as close to
// the formulas as code can be. Slow; the fast solver (disc_batch.h) is tested against it.

#include <memory>

#include "model/disc.h"

namespace torso {

class ReferenceDisc {
 public:
  // Global step of projective dynamics: the constant matrix that the residual is divided by.
  enum class Metric {
    kProjective,   // sum of w A^T A, as in the paper
    kRestHessian,  // elastic Hessian at rest, in the frame half way between the two bones
  };

  // Throws std::invalid_argument with the message of checkDiscMesh / checkDiscMaterial.
  ReferenceDisc(const DiscMesh& mesh, const DiscMaterial& material,
                Metric metric = Metric::kRestHessian);
  ~ReferenceDisc();
  ReferenceDisc(ReferenceDisc&&) noexcept;
  ReferenceDisc& operator=(ReferenceDisc&&) noexcept;

  // Iterates from the shape left by the last call (at first: rest) until the residual force on the
  // free nodes is below `tolerance` [N, largest component] or `max_iterations` are done.
  // Returns the number of iterations.
  int solve(const DiscPose& pose, int max_iterations, double tolerance);
  void reset();  // back to the rest shape

  DiscWrench wrench() const;
  double energy() const;                                  // [J]
  const std::vector<Eigen::Vector3d>& positions() const;  // (node) [m], lower disc frame
  // Tangent stiffness at rest: minus d(force, moment)/d(translation, rotation vector), (6 x 6),
  // SI, symmetric positive definite, interior nodes in equilibrium.
  Eigen::Matrix<double, 6, 6> restStiffness() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace torso
