// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// What the two disc solvers share: element constants, local projections, linear elasticity at rest
// and the frame half way between the two bones (frame M). Internal to the disc solvers.

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "model/disc.h"

namespace torso {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

// Nearest rotation (determinant +1, also if F is inverted) and nearest matrix of determinant 1 in
// the Frobenius norm, from the singular values of F.
struct Projections {
  Eigen::Matrix3d rotation;
  Eigen::Matrix3d isochoric;
};
Projections project(const Eigen::Matrix3d& F);

// Nearest point to s = (s1 >= s2 >= |s3|), where s3 may be negative, of the surface p1 p2 p3 = 1.
Eigen::Vector3d nearestUnitProduct(const Eigen::Vector3d& s);

struct DiscElasticity {
  // Throws std::invalid_argument with the message of checkDiscMesh / checkDiscMaterial, or if the
  // mesh has a part that can move freely.
  DiscElasticity(const DiscMesh& mesh, const DiscMaterial& material);

  double mu, kappa;                            // [Pa]
  std::vector<Eigen::Matrix3d> inverse_edges;  // (tet) inverse of [x1-x0, x2-x0, x3-x0] [1/m]
  std::vector<double> volume;                  // (tet) [m^3]
  std::vector<int> free_nodes;                 // nodes attached to no bone, increasing
  std::vector<int> free_index;                 // (node) place in free_nodes, -1 if attached
  double height;                               // distance of the attached sets' centroids [m]
  double size;                                 // largest distance of a node to the origin [m]
  Eigen::SparseMatrix<double> free_hessian;    // elastic Hessian at rest, free x free
  // Free displacements (3 nfree x 6) in equilibrium with half a unit translation (3) and rotation
  // (3, about the origin) of the upper attached nodes and the opposite half of the lower ones.
  Eigen::Matrix<double, Eigen::Dynamic, 6> response;
  Matrix6d rest_stiffness;  // about the origin of the disc frame, SI

  // Forces -dE/dx on all nodes at displacements u from rest (3 nnode), and the energy [J].
  double forces(const DiscMesh& mesh, const Eigen::VectorXd& u, Eigen::VectorXd* f) const;
};

// Pose of the two bones in frame M, whose rotation and origin are half way between theirs. A point
// x of the lower disc frame is half^T (x - origin) in frame M; frame M sees the upper bone turned
// by `half` and moved by `offset`, the lower one by the opposite.
struct HalfwayFrame {
  explicit HalfwayFrame(const DiscPose& pose);

  // The wrench on the upper bone in frame M (force, moment about M's origin) as a DiscWrench;
  // `normal` is upperEndplateAreaVector.
  DiscWrench wrench(const Vector6d& in_m, const Eigen::Vector3d& normal) const;

  Eigen::Matrix3d half;      // rotation half way from the lower to the upper bone
  Eigen::Matrix3d full;      // rotation of the upper bone
  Eigen::Vector3d origin;    // of M, in the lower disc frame [m]
  Eigen::Vector3d offset;    // of the upper bone's disc frame from M's origin, in M [m]
  Eigen::Vector3d rotation;  // skew part of `half` as a vector: half the rotation, to first order
};

}  // namespace torso
