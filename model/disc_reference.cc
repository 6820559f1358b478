// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/disc_reference.h"

#include <Eigen/SparseCholesky>

#include "model/disc_elasticity.h"

namespace torso {

using Eigen::Vector3d;
using Eigen::VectorXd;

struct ReferenceDisc::Impl {
  Impl(const DiscMesh& mesh_, const DiscMaterial& material, Method method_)
      : mesh(mesh_), elasticity(mesh_, material), method(method_), frame(DiscPose()) {
    metric.compute(elasticity.metric);
    reset();
  }

  void reset() {
    frame = HalfwayFrame(DiscPose());
    u.setZero(3 * mesh.rest_positions.size());
    energy = elasticity.energy(u, &force);
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

  // Solution of (A + k g g^T) x = r, A g_response = g.
  static VectorXd updated(VectorXd x, const VectorXd& g, const VectorXd& g_response, double k) {
    x -= k * g.dot(x) / (1 + k * g.dot(g_response)) * g_response;
    return x;
  }

  VectorXd metricStep(const VectorXd& r) const {
    return updated(metric.solve(r), elasticity.freePart(elasticity.nucleus_gradient),
                   elasticity.nucleus_response, elasticity.nucleus_stiffness);
  }

  // Newton's step, or the metric's where the energy is not convex.
  VectorXd newtonStep(const VectorXd& r) const {
    const DiscElasticity::Hessian H = elasticity.hessian(u);
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(elasticity.freePart(H.sparse));
    if (factor.info() == Eigen::Success) {
      const VectorXd g = elasticity.freePart(H.nucleus_gradient);
      const VectorXd step = updated(factor.solve(r), g, factor.solve(g), H.nucleus_stiffness);
      if (step.allFinite() && step.dot(r) > 0) return step;
    }
    return metricStep(r);
  }

  // One local and global step. The step is halved while it does not lower the energy enough.
  // Returns false if none does.
  bool iterate(const VectorXd& r) {
    const VectorXd step = method == Method::kNewton ? newtonStep(r) : metricStep(r);
    const double slope = r.dot(step);
    const VectorXd start = u;
    const double energy_before = energy;
    for (double t = 1; t > 1e-9; t /= 2) {
      u = start;
      for (size_t i = 0; i < elasticity.free_nodes.size(); ++i) {
        u.segment<3>(3 * elasticity.free_nodes[i]) += t * step.segment<3>(3 * i);
      }
      energy = elasticity.energy(u, &force);
      // The last term is the rounding error of the energy.
      if (energy <= energy_before - 1e-4 * t * slope + 1e-13 * std::abs(energy_before)) return true;
    }
    u = start;
    energy = elasticity.energy(u, &force);
    return false;
  }

  void updatePositions() {
    positions.resize(mesh.rest_positions.size());
    for (size_t i = 0; i < positions.size(); ++i) {
      positions[i] = frame.half * (mesh.rest_positions[i] + u.segment<3>(3 * i)) + frame.origin;
    }
  }

  DiscMesh mesh;
  DiscElasticity elasticity;
  Method method;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> metric;
  HalfwayFrame frame;
  VectorXd u, force;  // (3 nnode) displacement from rest and internal force, frame M
  double energy;
  std::vector<Vector3d> positions;
};

ReferenceDisc::ReferenceDisc(const DiscMesh& mesh, const DiscMaterial& material, Method method)
    : impl_(std::make_unique<Impl>(mesh, material, method)) {}
ReferenceDisc::~ReferenceDisc() = default;
ReferenceDisc::ReferenceDisc(ReferenceDisc&&) noexcept = default;
ReferenceDisc& ReferenceDisc::operator=(ReferenceDisc&&) noexcept = default;

int ReferenceDisc::solve(const DiscPose& pose, int max_iterations, double tolerance) {
  impl_->attach(pose);
  impl_->energy = impl_->elasticity.energy(impl_->u, &impl_->force);
  int iterations = 0;
  for (; iterations < max_iterations; ++iterations) {
    const VectorXd r = impl_->elasticity.freePart(impl_->force);
    if (r.size() == 0 || r.cwiseAbs().maxCoeff() <= tolerance) break;
    if (!impl_->iterate(r)) break;
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
  DiscWrench wrench = impl_->frame.wrench(w, upperEndplateAreaVector(impl_->mesh));
  wrench.nucleus_pressure = impl_->elasticity.nucleusPressure(impl_->u);
  return wrench;
}

double ReferenceDisc::energy() const { return impl_->energy; }

const std::vector<Vector3d>& ReferenceDisc::positions() const { return impl_->positions; }

const VectorXd& ReferenceDisc::displacements() const { return impl_->u; }

const DiscElasticity& ReferenceDisc::elasticity() const { return impl_->elasticity; }

}  // namespace torso
