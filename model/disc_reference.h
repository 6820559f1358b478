// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The plain disc solver: one disc of any topology, double precision, as close to the formulas as
// code can be. Slow; the fast solver (disc_batch.h) is tested against it, and what is not in a
// hurry (bench, calibration, export) uses it.

#include <memory>

#include "model/disc.h"

namespace torso {

struct DiscElasticity;

class ReferenceDisc {
 public:
  enum class Method {
    kConstantMetric,  // projective dynamics' global step: the residual over the Hessian at rest
                      // with all fibres taut, in the frame half way between the two bones
    kNewton,          // the residual over the energy's Hessian where it stands
  };

  // Throws std::invalid_argument with the message of checkDiscMesh / checkDiscMaterial.
  ReferenceDisc(const DiscMesh& mesh, const DiscMaterial& material,
                Method method = Method::kNewton);
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
  // Displacements from rest in the frame half way between the two bones (3 nnode) [m]; what
  // elasticity() takes.
  const Eigen::VectorXd& displacements() const;
  const DiscElasticity& elasticity() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace torso
