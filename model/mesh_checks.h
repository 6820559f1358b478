// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// What a surface is like as a solid: closed, of one sheet, free of itself and of others; and where
// a ray or a point meets it. All lengths in metres, in the mesh's own frame.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <utility>
#include <vector>

#include "model/tri_mesh.h"

namespace torso {

// Faults of a surface, counted; all zero for a closed, oriented 2-manifold.
struct MeshFaults {
  int bad_indices = 0;       // faces with a vertex that does not exist, or twice the same one
  int open_edges = 0;        // edges of one face only
  int crowded_edges = 0;     // edges of more than two faces
  int misturned_edges = 0;   // edges of two faces that run along them the same way
  int pinched_vertices = 0;  // vertices whose faces do not form one fan
  int flat_faces = 0;        // area below 1e-12 m^2 or a coordinate that is not finite

  bool any() const {
    return bad_indices + open_edges + crowded_edges + misturned_edges + pinched_vertices +
               flat_faces >
           0;
  }
};
MeshFaults findFaults(const TriMesh& mesh);

// A mesh with a tree of boxes about its faces. Keeps a copy of the mesh.
class MeshTree {
 public:
  // Throws std::invalid_argument if a face has an index out of range, or there is no face.
  explicit MeshTree(TriMesh mesh);

  struct Hit {
    double distance = std::numeric_limits<double>::infinity();  // along the ray [m]
    int face = -1;                                              // -1: none
  };
  struct Nearest {
    Eigen::Vector3d point;
    double distance;
    int face;
    Eigen::Vector3d weights;  // of the face's vertices, whose weighted mean the point is
  };

  const TriMesh& mesh() const { return mesh_; }
  const Eigen::AlignedBox3d& box() const { return nodes_.front().box; }
  Eigen::Vector3d normal(int face) const;  // unit, outwards

  // First face that the ray origin + t direction, t > 0, meets, from either side. direction: unit.
  Hit castRay(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;
  Nearest nearest(const Eigen::Vector3d& point) const;
  // How many closed shells of the mesh the point lies in.
  int windingNumber(const Eigen::Vector3d& point) const;
  // Distance to the surface, negative inside.
  double signedDistance(const Eigen::Vector3d& point) const;

  // Pairs of faces that cross, apart from neighbours that only share their vertex or edge.
  std::vector<std::pair<int, int>> selfIntersections() const;
  // Pairs (face of this, face of the other) that cross.
  std::vector<std::pair<int, int>> intersections(const MeshTree& other) const;

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    int first, count;  // faces order_[first ...] of a leaf; count 0: children `first`, first + 1
  };
  void split(int node, int first, int last);
  template <typename Visit>
  void alongRay(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double& limit,
                const Visit& visit) const;
  template <typename Visit>
  void overlapping(const MeshTree& other, const Visit& visit) const;

  TriMesh mesh_;
  std::vector<int> order_;
  std::vector<Node> nodes_;
};

// How far one solid reaches into another: the deepest vertex of either in the other [m], 0 if they
// are apart. Crossing faces without a vertex inside count with `touch`.
double penetration(const MeshTree& a, const MeshTree& b, double touch = 1e-6);

}  // namespace torso
