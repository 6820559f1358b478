// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// What goes on inside a disc: stress and fibre stretch of each tet, from where its nodes are.

#include <Eigen/Core>
#include <vector>

#include "model/disc.h"

namespace torso {

// Stress in one tet. The energy of DiscMaterial has three parts, and so has the stress:
//   shear   of the tet's own deformation gradient F
//   volume  a pressure, the same in all tets of a cell
//   fibres  tension along both families, of the mean deformation gradient of the cell
struct TetStress {
  // First Piola-Kirchhoff: force per area at rest. The nodal forces -dE/dx are exactly minus the
  // sum over the tets of V piola grad N, V and grad N at rest [Pa].
  Eigen::Matrix3d piola;
  // Cauchy: force per area now, symmetric [Pa]. A tet's volume is no concern of the energy, only
  // that of its cell is, so what is divided by is the ratio J of the cell's volume to that at rest:
  // summed over a cell, V J cauchy is exactly V piola F^T. (A J below a tenth counts as a tenth.)
  Eigen::Matrix3d cauchy;
  // Length of the two fibre families over that at rest; 1 in the nucleus, which has none.
  Eigen::Vector2d fibre_stretch;
};

// (tet) at node positions (nnode) [m] in any frame, turned and moved against the disc frame in any
// way; the Cauchy stress comes out in that frame. Mesh and material must pass checkDiscMesh and
// checkDiscMaterial.
std::vector<TetStress> discStress(const DiscMesh& mesh, const DiscMaterial& material,
                                  const std::vector<Eigen::Vector3d>& positions);

// Of a Cauchy stress: -trace / 3, positive in compression; and the norm of the deviator that equals
// the stress of a bar under pure tension [Pa].
double pressure(const Eigen::Matrix3d& cauchy);
double vonMises(const Eigen::Matrix3d& cauchy);

}  // namespace torso
