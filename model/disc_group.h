// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Up to 8 discs of equal topology in the lane layout of disc_kernels.h. Internal to DiscBatch.

#include <cstddef>
#include <memory>
#include <vector>

#include "model/disc.h"
#include "model/disc_elasticity.h"
#include "model/disc_kernels.h"

namespace torso {

// Zeroed array of floats, 64-byte aligned.
class LaneArray {
 public:
  LaneArray() = default;
  explicit LaneArray(std::size_t count);
  float* data() const { return data_.get(); }
  // Value i of a lane.
  float& operator()(std::size_t i, int lane) const { return data_[kLanes * i + lane]; }

 private:
  struct Free {
    void operator()(float* p) const;
  };
  std::unique_ptr<float[], Free> data_;
};

class DiscGroup {
 public:
  // At most kLanes discs, all of the first one's topology, and their elasticity. Lanes left over
  // are copies of the first disc that stay at rest. kernels: those that will be used, whose
  // rounding errors at rest are taken off.
  DiscGroup(const std::vector<const DiscMesh*>& meshes,
            const std::vector<const DiscElasticity*>& elasticities, const DiscKernels& kernels);

  const DiscGroupView& view() const { return view_; }
  // (node of the mesh) its number in the group: free nodes first, in order of elimination.
  const std::vector<int>& number() const { return number_; }
  int blocks() const { return static_cast<int>(row_.size()); }  // of L below the diagonal
  // Number of floats of the array `work` of DiscKernels::forces.
  std::size_t workSize() const;

 private:
  void order(const DiscMesh& mesh, const DiscElasticity& elasticity);
  void layOutCells(const DiscElasticity& elasticity);
  void fillCells(const DiscElasticity& elasticity, int lane);
  void factorise(const DiscElasticity& elasticity, int lane);
  void setView(const DiscMesh& mesh);

  DiscGroupView view_ = {};
  std::vector<int> number_, node_;  // node_: (number) node of the mesh
  std::vector<int> shear_row_, shear_column_, cell_node_, cell_nodes_, cell_link_, cell_links_;
  std::vector<int> column_, row_;
  LaneArray rest_, force_error_, limit_, shear_, cell_volume_, fibres_, fibre_rest_, fibre_law_;
  LaneArray diagonal_, below_, response_, wrench_response_, nucleus_response_, nucleus_gradient_,
      nucleus_wrench_;
};

}  // namespace torso
