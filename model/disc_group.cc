// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/disc_group.h"

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <algorithm>
#include <iterator>
#include <new>
#include <set>
#include <stdexcept>

namespace torso {
namespace {

using Eigen::Matrix3d;

constexpr std::align_val_t kAlignment{64};
// Displacements beyond this many times the disc's size are cut off: no disc gets there, and the
// arithmetic stays finite.
constexpr double kLargestDisplacement = 4;

// Free nodes in an order of elimination that fills little: approximate minimum degree.
std::vector<int> eliminationOrder(const DiscMesh& mesh, const DiscElasticity& elasticity) {
  const int n = static_cast<int>(elasticity.free_nodes.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& t : mesh.tets) {
    for (int a : t) {
      for (int b : t) {
        const int i = elasticity.free_index[a], j = elasticity.free_index[b];
        if (i >= 0 && j >= 0) entries.emplace_back(i, j, 1.0);
      }
    }
  }
  std::vector<int> order;
  if (n == 0) return order;
  Eigen::SparseMatrix<double> graph(n, n);
  graph.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::AMDOrdering<int>()(graph, permutation);
  for (int i = 0; i < n; ++i) order.push_back(elasticity.free_nodes[permutation.indices()[i]]);
  return order;
}

}  // namespace

LaneArray::LaneArray(std::size_t count)
    : data_(static_cast<float*>(
          ::operator new(std::max<std::size_t>(count, 1) * kLanes * sizeof(float), kAlignment))) {
  std::fill(data_.get(), data_.get() + std::max<std::size_t>(count, 1) * kLanes, 0.0f);
}

void LaneArray::Free::operator()(float* p) const { ::operator delete(p, kAlignment); }

DiscGroup::DiscGroup(const std::vector<const DiscMesh*>& meshes,
                     const std::vector<const DiscElasticity*>& elasticities) {
  const DiscMesh& first = *meshes[0];
  const int nnode = static_cast<int>(first.rest_positions.size());
  const int nfree = static_cast<int>(elasticities[0]->free_nodes.size());
  const int ntet = static_cast<int>(first.tets.size());
  std::vector<int> order = eliminationOrder(first, *elasticities[0]);
  order.insert(order.end(), first.lower_nodes.begin(), first.lower_nodes.end());
  order.insert(order.end(), first.upper_nodes.begin(), first.upper_nodes.end());
  number_.resize(nnode);
  for (int i = 0; i < nnode; ++i) number_[order[i]] = i;
  for (const auto& t : first.tets) {
    for (int i : t) tets_.push_back(3 * kLanes * number_[i]);
  }

  // Fill: when a node is eliminated, those it is joined to become joined to each other.
  std::vector<std::set<int>> later(nfree);
  for (const auto& t : first.tets) {
    for (int a : t) {
      for (int b : t) {
        if (number_[b] < nfree && number_[a] < number_[b]) later[number_[a]].insert(number_[b]);
      }
    }
  }
  column_.push_back(0);
  for (int j = 0; j < nfree; ++j) {
    if (!later[j].empty()) {
      const int parent = *later[j].begin();
      later[parent].insert(std::next(later[j].begin()), later[j].end());
    }
    for (int i : later[j]) row_.push_back(3 * kLanes * i);
    column_.push_back(static_cast<int>(row_.size()));
  }

  inverse_edges_ = LaneArray(9 * ntet);
  weight_ = LaneArray(ntet);
  ratio_ = LaneArray(1);
  limit_ = LaneArray(1);
  rest_ = LaneArray(3 * (nnode - nfree));
  response_ = LaneArray(18 * nfree);
  diagonal_ = LaneArray(6 * nfree);
  below_ = LaneArray(9 * row_.size());
  for (int lane = 0; lane < kLanes; ++lane) {
    const bool used = lane < static_cast<int>(meshes.size());
    const DiscMesh& mesh = *meshes[used ? lane : 0];
    const DiscElasticity& elasticity = *elasticities[used ? lane : 0];
    ratio_(0, lane) = static_cast<float>(elasticity.kappa / (2 * elasticity.mu));
    limit_(0, lane) = static_cast<float>(kLargestDisplacement * elasticity.size);
    for (int e = 0; e < ntet; ++e) {
      weight_(e, lane) = static_cast<float>(2 * elasticity.mu * elasticity.volume[e]);
      for (int i = 0; i < 9; ++i) {
        inverse_edges_(9 * e + i, lane) =
            static_cast<float>(elasticity.inverse_edges[e](i / 3, i % 3));
      }
    }
    for (int i = nfree; i < nnode; ++i) {
      for (int k = 0; k < 3; ++k) {
        rest_(3 * (i - nfree) + k, lane) = static_cast<float>(mesh.rest_positions[order[i]][k]);
      }
    }
    Eigen::VectorXi dofs(3 * nfree);  // (dof in order of elimination) dof of the elasticity
    for (int i = 0; i < nfree; ++i) {
      for (int k = 0; k < 3; ++k) dofs[3 * i + k] = 3 * elasticity.free_index[order[i]] + k;
    }
    for (int i = 0; i < 3 * nfree; ++i) {
      for (int k = 0; k < 6; ++k) {
        response_(6 * i + k, lane) = static_cast<float>(elasticity.response(dofs[i], k));
      }
    }
    std::vector<int> position(nfree);  // (free node) in the order of elimination
    for (int i = 0; i < nfree; ++i) position[elasticity.free_index[order[i]]] = i;
    factorise(elasticity.free_hessian, position, lane);
  }

  view_ = {nnode,
           nfree,
           static_cast<int>(first.lower_nodes.size()),
           ntet,
           tets_.data(),
           inverse_edges_.data(),
           weight_.data(),
           ratio_.data(),
           rest_.data(),
           response_.data(),
           limit_.data(),
           column_.data(),
           row_.data(),
           diagonal_.data(),
           below_.data()};
}

// Left-looking Cholesky factorisation by 3x3 blocks, on the pattern of column_ and row_.
void DiscGroup::factorise(const Eigen::SparseMatrix<double>& K, const std::vector<int>& position,
                          int lane) {
  const int n = static_cast<int>(position.size());
  const auto row = [&](int block) { return row_[block] / (3 * kLanes); };
  std::vector<int> node(n);  // inverse of position
  for (int i = 0; i < n; ++i) node[position[i]] = i;
  std::vector<Matrix3d> L(row_.size(), Matrix3d::Zero());
  std::vector<std::vector<std::pair<int, int>>> left(n);  // (row) its blocks: column, block
  std::vector<int> place(n);                              // (row) its block in the current column
  for (int j = 0; j < n; ++j) {
    for (int b = column_[j]; b < column_[j + 1]; ++b) place[row(b)] = b;
    Matrix3d D = Matrix3d::Zero();
    for (int c = 0; c < 3; ++c) {
      for (Eigen::SparseMatrix<double>::InnerIterator it(K, 3 * node[j] + c); it; ++it) {
        const int i = position[it.row() / 3];
        if (i == j) D(it.row() % 3, c) = it.value();
        if (i > j) L[place[i]](it.row() % 3, c) = it.value();
      }
    }
    for (const auto& [k, block] : left[j]) {
      const Matrix3d factor = L[block].transpose();
      D -= L[block] * factor;
      for (int b = block + 1; b < column_[k + 1]; ++b) L[place[row(b)]] -= L[b] * factor;
    }
    const Eigen::LLT<Matrix3d> llt(D);
    if (llt.info() != Eigen::Success) {
      throw std::invalid_argument("the stiffness at rest is not positive definite");
    }
    const Matrix3d l = llt.matrixL();
    const double diagonal[6] = {1 / l(0, 0), l(1, 0), 1 / l(1, 1), l(2, 0), l(2, 1), 1 / l(2, 2)};
    for (int i = 0; i < 6; ++i) diagonal_(6 * j + i, lane) = static_cast<float>(diagonal[i]);
    for (int b = column_[j]; b < column_[j + 1]; ++b) {
      L[b] = llt.matrixL().solve(L[b].transpose()).transpose().eval();
      left[row(b)].emplace_back(j, b);
      for (int i = 0; i < 9; ++i) below_(9 * b + i, lane) = static_cast<float>(L[b](i / 3, i % 3));
    }
  }
}

void discStressBySvd(const float* F, float ratio, float* stress) {
  Matrix3d G;
  for (int i = 0; i < 9; ++i) G(i / 3, i % 3) = F[i];
  const Projections p = project(G);
  const Matrix3d S = (G - p.rotation) + ratio * (G - p.isochoric);
  for (int i = 0; i < 9; ++i) stress[i] = static_cast<float>(S(i / 3, i % 3));
}

}  // namespace torso
