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

// Tetrahedral mesh of one disc. Tets are gathered in cells, patches of equal dilatation: what keeps
// linear tets from locking in a nearly incompressible material. The nucleus is one cell, hence of
// one pressure, as a fluid. Each cell of the annulus carries two families of fibres, at plus and
// minus the fibre angle to the hoop in the surface that the hoop and the disc's axis span.
struct DiscMesh {
  std::vector<Eigen::Vector3d> rest_positions;  // (node) [m], disc frame
  std::vector<std::array<int, 4>> tets;         // node indices, positively oriented
  std::vector<int> lower_nodes;                 // nodes attached to the lower bone's endplate
  std::vector<int> upper_nodes;                 // nodes attached to the upper bone's endplate
  std::vector<int> cells;                       // (tet) cell of the annulus, or kNucleus
  std::vector<std::array<int, 2>> hoops;        // (cell) nodes from one to the other of which the
                                                // hoop runs at rest
  static constexpr int kNucleus = -1;
};

// Outline, heights and wedge of a disc from which a structured mesh is made.
struct DiscShape {
  double width;             // left-right extent of the outline [m]
  double depth;             // front-back extent of the outline [m]
  double height_anterior;   // distance between the endplates at the front [m]
  double height_posterior;  // distance between the endplates at the back [m]
};

// Nucleus, ground substance of the annulus, and its fibres. With F the deformation gradient of a
// tet of volume V, v the volume of a cell now and V_c at rest, and s = |F a| the stretch of the
// fibre direction a under the cell's mean deformation gradient, the energy is the sum of
//   shear   V mu / 2 (|F|^2 - 3)                                 over all tets,
//   volume  -mu (v - V_c) + (lambda + mu) / (2 V_c) (v - V_c)^2  over all cells,
//   fibres  V_c Ef ((s - 1)^2 / 2 + c (s - 1)^3 / 3) where s > 1 over both families of each cell.
// The first two are a neo-Hookean material that also stands inversion (Smith, de Goes and Kim 2018,
// ACM Trans. Graph. 37:12), with the cells' mean dilatation (F-bar patches: de Souza Neto, Andrade
// Pires and Owen 2005, Int. J. Numer. Methods Eng. 62:353-383). They linearise to Hooke's law, with
// mu = E / (2 (1 + nu)) and lambda = E nu / ((1 + nu) (1 - 2 nu)) in the annulus, mu = E / 3 and
// lambda = K - 2 mu / 3 in the nucleus. A fibre is a projective-dynamics constraint: spring to the
// nearest vector no longer than at rest, of a stiffness Ef (1 + c (s - 1)) that rises with stretch.
struct DiscMaterial {
  double annulus_modulus;       // E of the ground substance [Pa], > 0
  double annulus_poisson;       // nu of the ground substance, 0 <= nu < 0.5
  double fibre_modulus;         // Ef: of one family, per area of annulus [Pa], >= 0
  double fibre_stiffening;      // c, >= 0
  double fibre_angle;           // [rad], 0 (hoop) to pi / 2 (axial)
  double nucleus_modulus;       // E of the nucleus [Pa], > 0
  double nucleus_bulk_modulus;  // K of the nucleus [Pa], > 0
};

// One isotropic material throughout, without fibres. E [Pa] > 0, 0 <= nu < 0.5.
DiscMaterial homogeneousMaterial(double youngs_modulus, double poissons_ratio);

// Pose of the upper bone's disc frame in the lower bone's disc frame; identity at rest.
struct DiscPose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();            // [m]
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  // unit
};

// What the disc does to its *upper* bone; the lower bone gets exactly the opposite at the same
// point.
struct DiscWrench {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   // [N], lower disc frame
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  // [Nm], about the origin of that frame
  double pressure =
      0;  // [Pa] normal force on the upper endplate over its rest area, > 0 compressed
  double nucleus_pressure = 0;  // [Pa] above rest, as a needle in the nucleus measures; 0 if none
};

// Structured mesh: a fan and rings of triangles times layers of prisms of 3 tets. The nucleus takes
// 43 % of the area and lies behind the centre by a twentieth of the depth; the annulus has two
// rings of 12 sectors; 4 layers. A cell of the annulus is one sector of one ring, two layers high.
// Defaults: 185 nodes, 720 tets, 48 cells. `refinement` multiplies rings, sectors and layers. The
// topology does not depend on the shape, and is mirror symmetric about the sagittal plane and about
// z = 0. The outline is convex, flattened behind, its area 0.82 x width x depth. Throws
// std::invalid_argument if a size is not positive, or refinement < 1.
DiscMesh makeDiscMesh(const DiscShape& shape, int refinement = 1);

// Empty if the mesh can be simulated, else one sentence that names what is wrong (index out of
// range, NaN, degenerate or inverted tet, node attached twice, nothing attached, a part of the mesh
// that hangs on no endplate, a cell without tets or whose hoop has no direction).
std::string checkDiscMesh(const DiscMesh& mesh);
std::string checkDiscMaterial(const DiscMaterial& material);

// Outward normal of the upper attached surface at rest times its area [m^2], summed over its faces;
// zero if no three upper nodes are the face of a tet. For a plane endplate the norm is the area.
Eigen::Vector3d upperEndplateAreaVector(const DiscMesh& mesh);
double upperEndplateArea(const DiscMesh& mesh);  // norm of the above [m^2]

}  // namespace torso
