// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// What the two disc solvers share: the energy of DiscMaterial on a mesh with its derivatives, the
// constant metric of the global step, and the frame half way between the two bones (frame M).
// Internal to the disc solvers.

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <vector>

#include "model/disc.h"

namespace torso {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

struct DiscElasticity {
  // Parts of the energy, for tests; to be combined with |.
  enum Terms { kShear = 1, kVolume = 2, kFibres = 4, kAllTerms = 7 };

  // Patch of tets of one dilatation.
  struct Cell {
    bool nucleus;
    std::vector<int> nodes;                  // of the mesh
    std::vector<std::array<int, 3>> faces;   // of its surface seen from outside, without those at
                                             // nodes[0]: places in `nodes`
    double volume;                           // at rest [m^3]
    double mu, lambda;                       // Lame constants [Pa]
    std::vector<Eigen::Vector2d> fibres;     // (node) F a = sum of node position x entry, for the
                                             // two families [1/m]; empty if there are none
    std::array<Eigen::Vector3d, 2> at_rest;  // the two fibre directions a, unit
  };

  // Second derivative of the energy: sparse + nucleus_stiffness * gradient gradient^T, the latter
  // being the nucleus' volume term, which couples all its nodes.
  struct Hessian {
    Eigen::SparseMatrix<double> sparse;  // (3 nnode)^2
    Eigen::VectorXd nucleus_gradient;    // (3 nnode) of the nucleus' volume [m^2]; 0 if none
    double nucleus_stiffness;            // [N/m^5]
  };

  // Throws std::invalid_argument with the message of checkDiscMesh / checkDiscMaterial, or if the
  // mesh has a part that can move freely.
  DiscElasticity(const DiscMesh& mesh, const DiscMaterial& material);

  // Energy [J], and if f is not null the forces -dE/du on all nodes (3 nnode) [N], at displacements
  // u (3 nnode) from rest.
  double energy(const Eigen::VectorXd& u, Eigen::VectorXd* f = nullptr,
                int terms = kAllTerms) const;
  Hessian hessian(const Eigen::VectorXd& u, int terms = kAllTerms) const;
  double nucleusPressure(const Eigen::VectorXd& u) const;  // [Pa] above rest; 0 if no nucleus

  // The rows and columns of free nodes.
  Eigen::SparseMatrix<double> freePart(const Eigen::SparseMatrix<double>& matrix) const;
  Eigen::VectorXd freePart(const Eigen::VectorXd& vector) const;

  DiscMaterial material;
  Eigen::VectorXd rest;                   // (3 nnode) positions [m]
  std::vector<Cell> cells;                // the nucleus, if any, is the last one
  Eigen::MatrixXi block_pattern;          // (nnode)^2 number of the Hessian's block, or -1
  Eigen::SparseMatrix<double> laplacian;  // (nnode)^2 sum of V mu grad N_i . grad N_j [N/m]
  std::vector<int> free_nodes;            // nodes attached to no bone, increasing
  std::vector<int> free_index;            // (node) place in free_nodes, -1 if attached
  double height;                          // distance of the attached sets' centroids [m]
  double size;                            // largest distance of a node to the origin [m]

  // The metric of the global step: the Hessian at rest with all fibres taut.
  Eigen::SparseMatrix<double> metric;  // free x free, without the nucleus' volume term
  Eigen::VectorXd nucleus_gradient;    // (3 nnode) at rest [m^2]
  Eigen::VectorXd nucleus_response;    // (3 nfree) metric^-1 of its free part [m^3/N]
  double nucleus_stiffness;            // [N/m^5]
  // Free displacements (3 nfree x 6) in equilibrium, in the metric, with half a unit translation
  // (3) and rotation (3, about the origin) of the upper attached nodes and the opposite half of the
  // lower ones; and the same without the nucleus' volume term.
  Eigen::Matrix<double, Eigen::Dynamic, 6> response, response_without_nucleus;
  Vector6d nucleus_wrench;  // on the upper bone per pressure of the nucleus [m^2], [m^3]: what its
                            // gradient does directly and by way of the free nodes
  // Stiffness of the metric about the origin of the disc frame, SI: an upper bound near rest, where
  // only the fibres that a motion stretches resist it.
  Matrix6d bound_stiffness;

 private:
  void addCells(const DiscMesh& mesh);
  void addMetric(const DiscMesh& mesh);
};

// Pose of the two bones in frame M, whose rotation and origin are half way between theirs. A point
// x of the lower disc frame is half^T (x - origin) in frame M; frame M sees the upper bone turned
// by `half` and moved by `offset`, the lower one by the opposite.
struct HalfwayFrame {
  explicit HalfwayFrame(const DiscPose& pose);

  // The wrench on the upper bone in frame M (force, moment about M's origin) as a DiscWrench
  // without nucleus_pressure; `normal` is upperEndplateAreaVector.
  DiscWrench wrench(const Vector6d& in_m, const Eigen::Vector3d& normal) const;

  Eigen::Matrix3d half;      // rotation half way from the lower to the upper bone
  Eigen::Matrix3d full;      // rotation of the upper bone
  Eigen::Vector3d origin;    // of M, in the lower disc frame [m]
  Eigen::Vector3d offset;    // of the upper bone's disc frame from M's origin, in M [m]
  Eigen::Vector3d rotation;  // skew part of `half` as a vector: half the rotation, to first order
};

}  // namespace torso
