// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "model/anatomy.h"
#include "tools/graft_host.h"

namespace torso::tools {

struct GraftOptions {
  std::string input, output;     // MJCF files
  std::string prefix;            // put before every name of the torso
  bool dry_run = false;          // do all but write
  bool groups = false;           // servos of lumbar, thoracic and cervical levels together
  std::string map;               // JSON file that says which body is what; "": recognise all
  std::string write_map;         // write what was recognised to this file, to be edited
  double timestep = 0;           // [s]; 0: the humanoid's, but at most 1/600
  bool keep_integrator = false;  // do not replace RK4 by Euler
  std::string meshes;  // folder of the bone meshes of `torso build`; "": make them, some seconds
};

// One element of the humanoid or of our torso that is not as it was.
struct GraftChange {
  // "removed", "replaced", "moved", "changed", "renamed", "added", "kept" although it is slow, or
  // "unneeded": not added
  std::string action;
  std::string kind;  // "body", "actuator", ..., or the section of the MJCF
  std::string name;
  std::string detail;
};

struct GraftReport {
  std::vector<RecognisedPart> parts;
  double length_scale, mass_scale;  // of our torso, relative to the anatomy tables
  std::vector<GraftChange> changes;
  double mass_before, mass_after;                        // whole model [kg]
  double hip_to_shoulder_before, hip_to_shoulder_after;  // mid hip to mid shoulder [m]
  int limb_joints;                                       // joints of arms and legs, kept in order
};

// Replaces the trunk of an MJCF humanoid (all between thighs, upper arms and the top of the head)
// by the torso of `anatomy`, scaled so that hips and shoulders stay where they are in the sagittal
// plane and the mass of what is removed is kept. Writes options.output and, beside it, the bone
// meshes in torso_assets/, after MuJoCo has loaded the result and it has passed the checks (mass,
// hip-shoulder distance, limb joints, torso data). Throws Error, and then nothing is written.
GraftReport graft(const Anatomy& anatomy, const GraftOptions& options);

}  // namespace torso::tools
