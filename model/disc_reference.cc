// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/disc_reference.h"

#include <Eigen/SparseCholesky>

#include "model/disc_elasticity.h"

namespace torso {

using Eigen::Vector3d;
using Eigen::VectorXd;

struct ReferenceDisc::Impl {
  Impl(const DiscMesh& mesh_, const DiscMaterial& material, Metric metric_)
      : mesh(mesh_), elasticity(mesh_, material), metric(metric_), frame(DiscPose()) {
    const int nfree = static_cast<int>(elasticity.free_nodes.size());
    if (metric == Metric::kRestHessian) {
      factor.compute(elasticity.free_hessian);
    } else {
      // sum w A^T A: a Laplacian, the same for each coordinate and in every frame.
      std::vector<Eigen::Triplet<double>> entries;
      for (size_t e = 0; e < mesh.tets.size(); ++e) {
        Eigen::Matrix<double, 4, 3> g;
        g.bottomRows<3>() = elasticity.inverse_edges[e];
        g.row(0) = -elasticity.inverse_edges[e].colwise().sum();
        const double weight = elasticity.volume[e] * (2 * elasticity.mu + elasticity.kappa);
        for (int a = 0; a < 4; ++a) {
          for (int b = 0; b < 4; ++b) {
            const int i = elasticity.free_index[mesh.tets[e][a]];
            const int j = elasticity.free_index[mesh.tets[e][b]];
            if (i < 0 || j < 0) continue;
            const double value = weight * g.row(a).dot(g.row(b));
            for (int k = 0; k < 3; ++k) entries.emplace_back(3 * i + k, 3 * j + k, value);
          }
        }
      }
      Eigen::SparseMatrix<double> matrix(3 * nfree, 3 * nfree);
      matrix.setFromTriplets(entries.begin(), entries.end());
      factor.compute(matrix);
    }
    reset();
  }

  void reset() {
    frame = HalfwayFrame(DiscPose());
    u.setZero(3 * mesh.rest_positions.size());
    energy = elasticity.forces(mesh, u, &force);
    updatePositions();
  }

  // Moves the attached nodes with their bones.
  void attach(const DiscPose& pose) {
    frame = HalfwayFrame(pose);
    for (int i : mesh.lower_nodes) {
      const Vector3d& X = mesh.rest_positions[i];
      u.segment<3>(3 * i) = frame.half.transpose() * X - X - frame.offset;
    }
    for (int i : mesh.upper_nodes) {
      const Vector3d& X = mesh.rest_positions[i];
      u.segment<3>(3 * i) = frame.half * X - X + frame.offset;
    }
  }

  VectorXd residual() const {
    VectorXd r(3 * elasticity.free_nodes.size());
    for (size_t i = 0; i < elasticity.free_nodes.size(); ++i) {
      r.segment<3>(3 * i) = force.segment<3>(3 * elasticity.free_nodes[i]);
    }
    return r;
  }

  // One local and global step. The step is halved while it does not lower the energy enough, which
  // the projective metric never needs (its model bounds the energy from above).
  void iterate(const VectorXd& r) {
    const VectorXd step = factor.solve(r);
    const double slope = r.dot(step);
    const VectorXd start = u;
    const double energy_before = energy;
    for (double t = 1; t > 1e-9; t /= 2) {
      u = start;
      for (size_t i = 0; i < elasticity.free_nodes.size(); ++i) {
        u.segment<3>(3 * elasticity.free_nodes[i]) += t * step.segment<3>(3 * i);
      }
      energy = elasticity.forces(mesh, u, &force);
      // The last term is the rounding error of the energy.
      if (energy <= energy_before - 1e-4 * t * slope + 1e-13 * energy_before) return;
    }
    u = start;
    energy = elasticity.forces(mesh, u, &force);
  }

  void updatePositions() {
    positions.resize(mesh.rest_positions.size());
    for (size_t i = 0; i < positions.size(); ++i) {
      positions[i] = frame.half * (mesh.rest_positions[i] + u.segment<3>(3 * i)) + frame.origin;
    }
  }

  DiscMesh mesh;
  DiscElasticity elasticity;
  Metric metric;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor;
  HalfwayFrame frame;
  VectorXd u, force;  // (3 nnode) displacement from rest and internal force, frame M
  double energy;
  std::vector<Vector3d> positions;
};

ReferenceDisc::ReferenceDisc(const DiscMesh& mesh, const DiscMaterial& material, Metric metric)
    : impl_(std::make_unique<Impl>(mesh, material, metric)) {}
ReferenceDisc::~ReferenceDisc() = default;
ReferenceDisc::ReferenceDisc(ReferenceDisc&&) noexcept = default;
ReferenceDisc& ReferenceDisc::operator=(ReferenceDisc&&) noexcept = default;

int ReferenceDisc::solve(const DiscPose& pose, int max_iterations, double tolerance) {
  impl_->attach(pose);
  impl_->energy = impl_->elasticity.forces(impl_->mesh, impl_->u, &impl_->force);
  int iterations = 0;
  for (; iterations < max_iterations; ++iterations) {
    const VectorXd r = impl_->residual();
    if (r.size() == 0 || r.cwiseAbs().maxCoeff() <= tolerance) break;
    impl_->iterate(r);
  }
  impl_->updatePositions();
  return iterations;
}

void ReferenceDisc::reset() { impl_->reset(); }

DiscWrench ReferenceDisc::wrench() const {
  Vector6d w = Vector6d::Zero();
  for (int i : impl_->mesh.upper_nodes) {
    const Vector3d f = impl_->force.segment<3>(3 * i);
    const Vector3d x = impl_->mesh.rest_positions[i] + impl_->u.segment<3>(3 * i);
    w.head<3>() += f;
    w.tail<3>() += x.cross(f);
  }
  return impl_->frame.wrench(w, upperEndplateAreaVector(impl_->mesh));
}

double ReferenceDisc::energy() const { return impl_->energy; }

const std::vector<Vector3d>& ReferenceDisc::positions() const { return impl_->positions; }

Eigen::Matrix<double, 6, 6> ReferenceDisc::restStiffness() const {
  return impl_->elasticity.rest_stiffness;
}

}  // namespace torso
