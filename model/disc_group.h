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
  // are copies of the first disc that stay at rest.
  DiscGroup(const std::vector<const DiscMesh*>& meshes,
            const std::vector<const DiscElasticity*>& elasticities);

  const DiscGroupView& view() const { return view_; }
  // (node of the mesh) its number in the group: free nodes first, in order of elimination.
  const std::vector<int>& number() const { return number_; }
  int blocks() const {
    return static_cast<int>(row_.size());
  }  // 3x3 blocks of L below the diagonal

 private:
  void factorise(const Eigen::SparseMatrix<double>& K, const std::vector<int>& position, int lane);

  DiscGroupView view_;
  std::vector<int> number_, tets_, column_, row_;
  LaneArray inverse_edges_, weight_, ratio_, rest_, response_, limit_, diagonal_, below_;
};

}  // namespace torso
