// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The intervertebral disc as a continuum: mesh, material, pose of its two bones and the wrench it
// answers with. Everything is expressed in the *disc frame*: origin at the disc's centre, x
// forward, y left, z up along the disc's axis, attached to the lower bone. At rest the lower and
// the upper bone's copy of that frame coincide. SI units.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

namespace torso {

// Tetrahedral mesh of one disc.
struct DiscMesh {
  std::vector<Eigen::Vector3d> rest_positions;  // (node) [m], disc frame
  std::vector<std::array<int, 4>> tets;         // node indices, positively oriented
  std::vector<int> lower_nodes;                 // nodes attached to the lower bone's endplate
  std::vector<int> upper_nodes;                 // nodes attached to the upper bone's endplate
};

// Outline, heights and wedge of a disc from which a structured mesh is made.
struct DiscShape {
  double width;             // left-right extent of the outline [m]
  double depth;             // front-back extent of the outline [m]
  double height_anterior;   // distance between the endplates at the front [m]
  double height_posterior;  // distance between the endplates at the back [m]
};

// Isotropic, homogeneous. The energy per element of volume V and deformation gradient F is
//   V mu |F - R|^2 + V kappa/2 |F - P|^2,
// R the nearest rotation, P the nearest matrix of determinant 1, mu = E / (2 (1 + nu)) and
// kappa = 3 E nu / ((1 + nu) (1 - 2 nu)), which linearises to Hooke's law with E and nu.
struct DiscMaterial {
  double youngs_modulus;  // E [Pa], > 0, <= 1e12
  double poissons_ratio;  // nu, 0 <= nu < 0.5
};

// Pose of the upper bone's disc frame in the lower bone's disc frame; identity at rest.
struct DiscPose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();            // [m]
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  // unit
};

// What the disc does to its *upper* bone; the lower bone gets exactly the opposite at the same
// point.
struct DiscWrench {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // [N], lower disc frame
  Eigen::Vector3d moment =
      Eigen::Vector3d::Zero();  // [Nm], about the origin of the lower disc frame
  double pressure =
      0;  // [Pa] normal force on the upper endplate over its rest area, > 0 compressed
};

// Structured mesh: `rings` concentric rings of triangles, 6 per ring more than the last, times
// `layers` layers of prisms of 3 tets. The topology does not depend on the shape, and is mirror
// symmetric about the sagittal plane (and, for an even number of layers, about z = 0). The outline
// is convex, flattened behind, its area 0.82 x width x depth. Defaults: 185 nodes, 648 tets. Throws
// std::invalid_argument if a size is not positive, or with fewer than 2 rings or 1 layer.
DiscMesh makeDiscMesh(const DiscShape& shape, int rings = 3, int layers = 4);

// Empty if the mesh can be simulated, else one sentence that names what is wrong (index out of
// range, NaN, degenerate or inverted tet, node attached twice, nothing attached, a part of the mesh
// that hangs on no endplate).
std::string checkDiscMesh(const DiscMesh& mesh);
std::string checkDiscMaterial(const DiscMaterial& material);

// Outward normal of the upper attached surface at rest times its area [m^2], summed over its faces;
// zero if no three upper nodes are the face of a tet. For a plane endplate the norm is the area.
Eigen::Vector3d upperEndplateAreaVector(const DiscMesh& mesh);
double upperEndplateArea(const DiscMesh& mesh);  // norm of the above [m^2]

}  // namespace torso
