// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/disc_group.h"

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <new>
#include <set>
#include <stdexcept>
#include <utility>

namespace torso {
namespace {

using Eigen::Matrix3d;

constexpr std::align_val_t kAlignment{64};
// Displacements beyond this many times the disc's size are cut off: no disc gets there, and the
// arithmetic stays finite.
constexpr double kLargestDisplacement = 4;
constexpr int kNode = 3 * kLanes;  // floats of a node

// Pairs of free nodes that the metric couples: its 3x3 blocks that are not empty.
Eigen::SparseMatrix<double> coupling(const DiscElasticity& elasticity) {
  const int n = static_cast<int>(elasticity.free_nodes.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k < elasticity.metric.outerSize(); ++k) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(elasticity.metric, k); it; ++it) {
      entries.emplace_back(static_cast<int>(it.row()) / 3, k / 3, 1.0);
    }
  }
  Eigen::SparseMatrix<double> graph(n, n);
  graph.setFromTriplets(entries.begin(), entries.end());
  return graph;
}

// Terms k, i, j of the volume's gradient at one node of a cell, see DiscGroupView::cell_links. Each
// face at the node adds the cross product of its two other nodes; two faces side by side add
//   x_i x x_k + x_k x x_j = x_k x (x_j - x_i).
// Node 0 is the origin, so that its faces are not needed, and it stands in for a missing i.
std::vector<std::array<int, 3>> volumeLinks(const std::vector<std::array<int, 3>>& faces,
                                            int node) {
  std::map<int, int> next;  // around the node, counter-clockwise from outside
  for (const auto& face : faces) {
    for (int k = 0; k < 3; ++k) {
      if (face[k] == node) next[face[(k + 1) % 3]] = face[(k + 2) % 3];
    }
  }
  std::vector<std::array<int, 3>> links;
  while (!next.empty()) {
    // From the beginning of an open chain, if there is one.
    int start = next.begin()->first;
    for (const auto& [from, to] : next) {
      const bool has_previous = std::any_of(
          next.begin(), next.end(), [from = from](const auto& e) { return e.second == from; });
      if (!has_previous) start = from;
    }
    for (int i = start; next.count(i);) {
      const int k = next[i];
      next.erase(i);
      if (next.count(k)) {
        const int j = next[k];
        next.erase(k);
        links.push_back({k, i, j});
        i = j;
      } else {
        links.push_back({i, 0, k});
        i = k;
      }
    }
  }
  return links;
}

}  // namespace

LaneArray::LaneArray(std::size_t count)
    : data_(static_cast<float*>(
          ::operator new(std::max<std::size_t>(count, 1) * kLanes * sizeof(float), kAlignment))) {
  std::fill(data_.get(), data_.get() + std::max<std::size_t>(count, 1) * kLanes, 0.0f);
}

void LaneArray::Free::operator()(float* p) const { ::operator delete(p, kAlignment); }

DiscGroup::DiscGroup(const std::vector<const DiscMesh*>& meshes,
                     const std::vector<const DiscElasticity*>& elasticities,
                     const DiscKernels& kernels) {
  order(*meshes[0], *elasticities[0]);
  layOutCells(*elasticities[0]);
  const int nnode = static_cast<int>(number_.size());
  const int nfree = static_cast<int>(elasticities[0]->free_nodes.size());
  const int ncell = static_cast<int>(elasticities[0]->cells.size());
  limit_ = LaneArray(1);
  rest_ = LaneArray(3 * nnode);
  force_error_ = LaneArray(3 * nnode);
  shear_ = LaneArray(shear_column_.size());
  cell_volume_ = LaneArray(3 * ncell);
  fibres_ = LaneArray(2 * cell_nodes_.size());
  fibre_rest_ = LaneArray(6 * ncell);
  fibre_law_ = LaneArray(2 * ncell);
  response_ = LaneArray(18 * nfree);
  wrench_response_ = LaneArray(18 * nfree);
  nucleus_response_ = LaneArray(3 * nfree);
  const auto& last = elasticities[0]->cells.back();
  nucleus_gradient_ = LaneArray(last.nucleus ? 3 * last.nodes.size() : 0);
  nucleus_wrench_ = LaneArray(6);
  diagonal_ = LaneArray(6 * nfree);
  below_ = LaneArray(9 * row_.size());
  for (int lane = 0; lane < kLanes; ++lane) {
    const bool used = lane < static_cast<int>(meshes.size());
    const DiscElasticity& elasticity = *elasticities[used ? lane : 0];
    limit_(0, lane) = static_cast<float>(kLargestDisplacement * elasticity.size);
    for (int i = 0; i < 3 * nnode; ++i) {
      rest_(i, lane) = static_cast<float>(elasticity.rest[3 * node_[i / 3] + i % 3]);
    }
    for (int i = 0; i < nnode; ++i) {
      for (int e = shear_row_[i]; e < shear_row_[i + 1]; ++e) {
        const int j = node_[shear_column_[e] / kNode];
        shear_(e, lane) = static_cast<float>(elasticity.laplacian.coeff(node_[i], j));
      }
    }
    fillCells(elasticity, lane);
    for (int i = 0; i < 3 * nfree; ++i) {
      const int dof = 3 * elasticity.free_index[node_[i / 3]] + i % 3;
      nucleus_response_(i, lane) = static_cast<float>(elasticity.nucleus_response[dof]);
      for (int k = 0; k < 6; ++k) {
        response_(6 * i + k, lane) = static_cast<float>(elasticity.response(dof, k));
        wrench_response_(6 * i + k, lane) =
            static_cast<float>(elasticity.response_without_nucleus(dof, k));
      }
    }
    for (size_t i = 0; last.nucleus && i < 3 * last.nodes.size(); ++i) {
      const double gradient = elasticity.nucleus_gradient[3 * last.nodes[i / 3] + i % 3];
      nucleus_gradient_(i, lane) = static_cast<float>(6 * gradient);
    }
    for (int k = 0; k < 6; ++k) {
      nucleus_wrench_(k, lane) = static_cast<float>(elasticity.nucleus_wrench[k]);
    }
    factorise(elasticity, lane);
  }
  setView(*meshes[0]);

  // What rounding leaves of the forces at rest.
  LaneArray u(3 * nnode), f(3 * nnode), work(workSize() / kLanes);
  LaneArray pressure(1);
  kernels.forces(view_, u.data(), f.data(), pressure.data(), work.data());
  for (int i = 0; i < 3 * nnode * kLanes; ++i) force_error_.data()[i] = -f.data()[i];
}

std::size_t DiscGroup::workSize() const {
  int largest = 0;
  for (int c = 0; c < view_.ncell; ++c) {
    largest = std::max(largest, cell_node_[c + 1] - cell_node_[c]);
  }
  return kNode * (number_.size() + 3 * static_cast<std::size_t>(largest));
}

// Numbers of the nodes, free ones in an order of elimination that fills little (approximate minimum
// degree); pattern of the Cholesky factor and of the shear stiffness.
void DiscGroup::order(const DiscMesh& mesh, const DiscElasticity& elasticity) {
  const int nnode = static_cast<int>(mesh.rest_positions.size());
  const int nfree = static_cast<int>(elasticity.free_nodes.size());
  const Eigen::SparseMatrix<double> graph = coupling(elasticity);
  if (nfree > 0) {
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
    Eigen::AMDOrdering<int>()(graph, permutation);
    for (int i = 0; i < nfree; ++i) {
      node_.push_back(elasticity.free_nodes[permutation.indices()[i]]);
    }
  }
  node_.insert(node_.end(), mesh.lower_nodes.begin(), mesh.lower_nodes.end());
  node_.insert(node_.end(), mesh.upper_nodes.begin(), mesh.upper_nodes.end());
  number_.resize(nnode);
  for (int i = 0; i < nnode; ++i) number_[node_[i]] = i;

  // Fill: when a node is eliminated, those it is joined to become joined to each other.
  std::vector<std::set<int>> later(nfree);
  for (int k = 0; k < nfree; ++k) {
    const int j = number_[elasticity.free_nodes[k]];
    for (Eigen::SparseMatrix<double>::InnerIterator it(graph, k); it; ++it) {
      const int i = number_[elasticity.free_nodes[it.row()]];
      if (i > j) later[j].insert(i);
    }
  }
  column_.push_back(0);
  for (int j = 0; j < nfree; ++j) {
    if (!later[j].empty()) {
      const int parent = *later[j].begin();
      later[parent].insert(std::next(later[j].begin()), later[j].end());
    }
    for (int i : later[j]) row_.push_back(kNode * i);
    column_.push_back(static_cast<int>(row_.size()));
  }

  shear_row_.push_back(0);
  for (int i = 0; i < nnode; ++i) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(elasticity.laplacian, node_[i]); it; ++it) {
      shear_column_.push_back(kNode * number_[it.row()]);
    }
    shear_row_.push_back(static_cast<int>(shear_column_.size()));
  }
}

void DiscGroup::layOutCells(const DiscElasticity& elasticity) {
  cell_node_.push_back(0);
  for (const auto& cell : elasticity.cells) {
    for (int node : cell.nodes) cell_nodes_.push_back(kNode * number_[node]);
    for (size_t i = 0; i < cell.nodes.size(); ++i) {
      cell_link_.push_back(static_cast<int>(cell_links_.size() / 3));
      if (i == 0) continue;
      for (const auto& link : volumeLinks(cell.faces, static_cast<int>(i))) {
        for (int place : link) cell_links_.push_back(kNode * place);
      }
    }
    cell_node_.push_back(static_cast<int>(cell_nodes_.size()));
  }
  cell_link_.push_back(static_cast<int>(cell_links_.size() / 3));
}

void DiscGroup::fillCells(const DiscElasticity& elasticity, int lane) {
  for (size_t c = 0; c < elasticity.cells.size(); ++c) {
    const auto& cell = elasticity.cells[c];
    cell_volume_(3 * c, lane) = static_cast<float>(cell.volume);
    cell_volume_(3 * c + 1, lane) = static_cast<float>(cell.mu);
    cell_volume_(3 * c + 2, lane) = static_cast<float>((cell.lambda + cell.mu) / cell.volume);
    if (cell.fibres.empty()) continue;  // zeros: of no length, hence slack
    fibre_law_(2 * c, lane) = static_cast<float>(cell.volume * elasticity.material.fibre_modulus);
    fibre_law_(2 * c + 1, lane) = static_cast<float>(elasticity.material.fibre_stiffening);
    for (int k = 0; k < 2; ++k) {
      for (int i = 0; i < 3; ++i) {
        fibre_rest_(6 * c + 3 * k + i, lane) = static_cast<float>(cell.at_rest[k][i]);
      }
      for (size_t i = 0; i < cell.nodes.size(); ++i) {
        fibres_(2 * (cell_node_[c] + i) + k, lane) = static_cast<float>(cell.fibres[i][k]);
      }
    }
  }
}

// Left-looking Cholesky factorisation of the metric by 3x3 blocks, on the pattern of column_ and
// row_.
void DiscGroup::factorise(const DiscElasticity& elasticity, int lane) {
  const int n = static_cast<int>(elasticity.free_nodes.size());
  const auto row = [&](int block) { return row_[block] / kNode; };
  std::vector<Matrix3d> L(row_.size(), Matrix3d::Zero());
  std::vector<std::vector<std::pair<int, int>>> left(n);  // (row) its blocks: column, block
  std::vector<int> place(n);                              // (row) its block in the current column
  for (int j = 0; j < n; ++j) {
    for (int b = column_[j]; b < column_[j + 1]; ++b) place[row(b)] = b;
    Matrix3d D = Matrix3d::Zero();
    for (int c = 0; c < 3; ++c) {
      for (Eigen::SparseMatrix<double>::InnerIterator it(elasticity.metric,
                                                         3 * elasticity.free_index[node_[j]] + c);
           it; ++it) {
        const int i = number_[elasticity.free_nodes[it.row() / 3]];
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

void DiscGroup::setView(const DiscMesh& mesh) {
  view_.nnode = static_cast<int>(number_.size());
  view_.nfree = static_cast<int>(column_.size()) - 1;
  view_.nlower = static_cast<int>(mesh.lower_nodes.size());
  view_.rest = rest_.data();
  view_.force_error = force_error_.data();
  view_.limit = limit_.data();
  view_.shear_row = shear_row_.data();
  view_.shear_column = shear_column_.data();
  view_.shear = shear_.data();
  view_.ncell = static_cast<int>(cell_node_.size()) - 1;
  view_.nucleus = std::count(mesh.cells.begin(), mesh.cells.end(), DiscMesh::kNucleus) > 0;
  view_.cell_node = cell_node_.data();
  view_.cell_nodes = cell_nodes_.data();
  view_.cell_link = cell_link_.data();
  view_.cell_links = cell_links_.data();
  view_.cell_volume = cell_volume_.data();
  view_.fibres = fibres_.data();
  view_.fibre_rest = fibre_rest_.data();
  view_.fibre_law = fibre_law_.data();
  view_.column = column_.data();
  view_.row = row_.data();
  view_.diagonal = diagonal_.data();
  view_.below = below_.data();
  view_.response = response_.data();
  view_.wrench_response = wrench_response_.data();
  view_.nucleus_response = nucleus_response_.data();
  view_.nucleus_gradient = nucleus_gradient_.data();
  view_.nucleus_wrench = nucleus_wrench_.data();
}

}  // namespace torso
