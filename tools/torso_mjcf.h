// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tinyxml2.h>

#include <map>
#include <string>
#include <vector>

#include "model/anatomy.h"
#include "model/bone_mesh.h"
#include "model/skeleton.h"
#include "tools/own_bones.h"

namespace torso::tools {

enum class TorsoKind {
  kDetailed,  // free vertebrae, discs, ligaments, facets
  // For comparisons: the same bones, masses, limbs and contacts; clavicles and scapulae are part of
  // the rigid rib cage.
  kFixed,   // pelvis to neck one rigid body
  kSimple,  // three ball joints, as common humanoids have (tools/simple_trunk.h)
};

struct MjcfOptions {
  bool limbs = false;  // arms and legs too
  bool scene = false;  // include scene.xml
  TorsoKind kind = TorsoKind::kDetailed;
  std::string prefix;     // put before every name
  double mesh_scale = 1;  // of the bone meshes, which are made at the size of the tables
  std::map<std::string, double> limb_scale;  // on top of it, by segment ("thigh"), as withLimbs'
  std::string mesh_dir = "assets";           // where they are, relative to the MJCF
  const OwnBones* own = nullptr;             // in place of generated bones, facets and ligaments
  // Bones that discs, ligaments and facets are fitted to, of this anatomy; null: they are left
  // where the tables have them, some millimetres off the surfaces. Outlives the call.
  const Skeleton* skeleton = nullptr;
  std::vector<std::string>
      only;              // these bodies, and of the rest what lies between them; empty: all
  std::string anchored;  // this body is fixed to the world
  bool bones = true;     // show the bones; their mesh files must exist
  bool muscles = false;  // of the detailed torso: tendons and actuators, controls 0 to 1
  double height = 0;     // of the S1 endplate above the ground; 0: feet on the ground [m]
};

// Name of the mesh of a body's bone or cartilage, and of its STL file: "L4", "ribcage_cartilage".
std::string boneMeshName(const std::string& body, Tissue tissue);

// Bodies that MjcfOptions asks for, in the order of the MJCF.
std::vector<std::string> mjcfBodies(const Anatomy& anatomy, const MjcfOptions& options);

// Writes the <mujoco> element of a torso or a whole body into an empty document.
// Names (docs: README, "Names you may rely on"): bodies as in model/body.h; discs, facets and
// ligaments as tuples "disc:L4/L5", "facet:L4/L5_left", "ligament:ALL_mid".
void writeMjcf(const Anatomy& anatomy, const MjcfOptions& options, tinyxml2::XMLDocument& document);

// The same as text.
std::string mjcfText(const Anatomy& anatomy, const MjcfOptions& options);

// Writes the floor, light and sky that human.xml includes.
void writeScene(tinyxml2::XMLDocument& document);

// Writes the scene that holds torso.xml by its pelvis.
void writeHeldScene(tinyxml2::XMLDocument& document);

}  // namespace torso::tools
