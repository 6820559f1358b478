// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/disc_fit.h"

#include "model/body.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

namespace torso {

using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

// Left between bone and disc where they were apart, as a share of the reach: at the rounded edge of
// an endplate the flat faces of the elements would else cut into the bone.
constexpr double kCartilage = 0.1;

// Way of each of these nodes to the bone.
std::vector<Vector3d> waysToBone(const DiscMesh& mesh, const std::vector<int>& nodes,
                                 const Isometry3d& frame, const MeshTree& bone, double reach) {
  constexpr double kMiddle = 1e-9;
  std::vector<Vector3d> ways(nodes.size(), Vector3d::Zero());
  for (std::size_t i = 0; i < nodes.size(); i++) {
    const Vector3d& p = mesh.rest_positions[nodes[i]];
    if (p.y() < -kMiddle) continue;
    const Vector3d q = frame * p;
    if (bone.windingNumber(q) > 0) {  // out along the axis, into the disc
      const Vector3d axis = frame.linear().col(2) * (p.z() < 0 ? 1 : -1);
      const double inside = bone.castRay(q, axis).distance;
      if (inside <= reach) ways[i].z() = p.z() < 0 ? inside : -inside;
      continue;
    }
    const MeshTree::Nearest nearest = bone.nearest(q);
    if (nearest.distance > reach) continue;
    ways[i] = std::max(0.0, 1 - kCartilage * reach / nearest.distance) *
              (frame.inverse() * nearest.point - p);
    if (p.y() < kMiddle) ways[i].y() = 0;
  }
  for (std::size_t i = 0; i < nodes.size(); i++) {  // the right side as the left
    const Vector3d& p = mesh.rest_positions[nodes[i]];
    if (p.y() >= -kMiddle) continue;
    for (std::size_t k = 0; k < nodes.size(); k++) {
      const Vector3d& q = mesh.rest_positions[nodes[k]];
      if ((q - Vector3d(p.x(), -p.y(), p.z())).norm() < kMiddle) {
        ways[i] = {ways[k].x(), -ways[k].y(), ways[k].z()};
      }
    }
  }
  return ways;
}

}  // namespace

void fitDiscFaces(const Isometry3d& frame, const MeshTree& lower, const MeshTree& upper,
                  double reach, DiscMesh* mesh) {
  const std::size_t n = mesh->lower_nodes.size();  // nodes of a layer; layer by layer from below
  const std::size_t layers = mesh->rest_positions.size() / n;
  const auto below = waysToBone(*mesh, mesh->lower_nodes, frame, lower, reach);
  const auto above = waysToBone(*mesh, mesh->upper_nodes, frame, upper, reach);
  for (std::size_t j = 0; j < layers; j++) {
    const double t = static_cast<double>(j) / static_cast<double>(layers - 1);
    for (std::size_t i = 0; i < n; i++) {
      mesh->rest_positions[j * n + i] += (1 - t) * below[i] + t * above[i];
    }
  }
  for (const auto& t : mesh->tets) {
    const Vector3d& a = mesh->rest_positions[t[0]];
    const Vector3d b = mesh->rest_positions[t[1]] - a, c = mesh->rest_positions[t[2]] - a;
    if (!(b.cross(c).dot(mesh->rest_positions[t[3]] - a) > 0)) {
      throw std::runtime_error(
          "disc: its faces cannot follow the bones, an element turns inside out");
    }
  }
}

DiscMesh fittedDiscMesh(const Anatomy& anatomy, const Skeleton& skeleton, const Disc& disc) {
  DiscMesh mesh = makeDiscMesh(disc.shape);
  fitDiscFaces(disc.frame, skeleton.bone(bodyOfLevel(anatomy, disc.lower)),
               skeleton.bone(bodyOfLevel(anatomy, disc.upper)), kDiscReach * anatomy.length_scale,
               &mesh);
  return mesh;
}

}  // namespace torso
