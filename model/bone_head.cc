// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/bone_parts.h"
#include "model/bone_skull.h"

namespace torso {

using Eigen::Vector3d;

TriMesh headMesh(const Anatomy& anatomy) {
  // Sized so that the vault ends just below the head's vertex.
  constexpr double kScalp = 2;  // [mm]
  Vector3d ear = anatomy.landmark("external_auditory_meatus");
  ear.y() = 0;
  const double scale = (anatomy.landmark("head_vertex").z() - ear.z()) / (kVaultHeight + kScalp);
  // The occipital condyles lie on C1.
  TriMesh mesh = skullMesh((anatomy.c2.position + pointMm(1, 17, 23.5) - ear) / scale);
  const TriMesh mandible = mandibleMesh();
  append(mesh, teethMesh(upperArch(), mesh));
  append(mesh, mandible);
  append(mesh, teethMesh(lowerArch(), mandible));
  for (Vector3d& v : mesh.vertices) v = ear + scale * v;
  append(mesh, atlasMesh(anatomy));
  append(mesh, axisMesh(anatomy));
  return mesh;
}

}  // namespace torso
