// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Nearest point of a triangle surface, by a tree of boxes.

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "model/tri_mesh.h"

namespace torso {

class TriangleTree {
 public:
  explicit TriangleTree(const TriMesh& mesh);  // at least one face

  struct Nearest {
    int face;
    Eigen::Vector3d weights;  // of the face's vertices
    double distance;
  };
  Nearest nearest(const Eigen::Vector3d& p) const;
  // Negative inside; the mesh must be closed (Baerentzen and Aanaes 2005, IEEE TVCG 11:243-253).
  double signedDistance(const Eigen::Vector3d& p) const;

  const TriMesh& mesh() const { return mesh_; }
  const Eigen::AlignedBox3d& box() const { return nodes_[0].box; }

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    int begin, end;   // places in order_
    int left, right;  // children, or -1
  };
  int build(int begin, int end);
  void search(int node, const Eigen::Vector3d& p, Nearest& best) const;

  TriMesh mesh_;
  std::vector<int> order_;  // of the faces
  std::vector<Node> nodes_;
  std::vector<Eigen::Vector3d> vertex_normal_;  // weighted by angle
  std::vector<std::array<Eigen::Vector3d, 3>>
      edge_normal_;  // (face), of the edge opposite vertex k
};

}  // namespace torso
