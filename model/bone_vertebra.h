// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// A vertebra's parts, for bone_vertebra.cc; in the vertebra frame, of a pair the left one [m].

#include "model/blend.h"
#include "model/bone_parts.h"

namespace torso {

// What the parts of one vertebra are built around.
struct VertebraPlan {
  VertebraPlan(const Anatomy& anatomy, const Vertebra& vertebra);

  const Anatomy& anatomy;
  const Vertebra& v;
  double half_height;           // of the body
  double back;                  // x of the body's back
  double canal_end;             // x of the canal's back
  double canal_half;            // half its width
  Eigen::Vector3d pedicle_end;  // there begin the lamina and the articular processes
  Eigen::Vector3d spinous_tip;

  // Facet faces as facetFrame gives them: z out of the face, y up along it. The inferior one lies
  // against the superior one of the bone below. C2 has no superior face of this kind.
  struct Face {
    Eigen::Isometry3d frame;
    double width, height;
    Eigen::Vector3d behind(double depth) const { return at(0, 0, -depth); }
    Eigen::Vector3d at(double across, double up, double out) const {
      return frame * Eigen::Vector3d(across, up, out);
    }
  };
  bool has_superior;
  Face superior, inferior;

  bool lumbar() const { return v.region == Region::kLumbar; }
  bool thoracic() const { return v.region == Region::kThoracic; }
  bool cervical() const { return v.region == Region::kCervical; }
  int number() const { return v.name[1] - '0' + (v.name.size() > 2 ? 9 + v.name[2] - '0' : 0); }

  // Frame of an endplate: origin in its middle, z along the body's axis.
  Eigen::Isometry3d endplate(bool upper) const;
  // Where a joint of this or another level lies; null if the table has none.
  const CostalJoint* costalJoint(const std::string& level, bool costotransverse) const;
  std::string levelBelow() const;  // "S1" below L5
};

struct Endplate {
  Eigen::Isometry3d frame;  // origin in its middle, z upwards
  double width, depth;      // [m]
};
struct DrumStyle {
  double waist = 0.1;  // share of the radius that the middle lacks
  double hollow = 0;   // depth of the hollow behind [m]
  bool heart = false;  // narrower in front
};
// Body between two endplates, which are slightly dished inside a rim. Its axes are nearly those of
// the space that it is in.
Solid drum(const Endplate& below, const Endplate& above, const DrumStyle& style);
Solid vertebralBody(const VertebraPlan& plan);

// The parts of the arch, by region: pedicles, laminae, articular, transverse and spinous processes.
void addLumbarArch(Blend& bone, const VertebraPlan& plan);
void addThoracicArch(Blend& bone, const VertebraPlan& plan);
void addCervicalArch(Blend& bone, const VertebraPlan& plan);

// Surface of the finished bone, with the table's span and spinous tip to the micrometre.
TriMesh vertebraSurface(const Blend& bone, const VertebraPlan& plan, double voxel);

// Pedicles between the body and pedicle_end.
void addPedicles(Blend& bone, const VertebraPlan& plan);
// Takes away what fillets have left in the canal.
void carveCanal(Blend& bone, const VertebraPlan& plan);
// Bone behind a face, `depth` thick.
void addFace(Blend& bone, const VertebraPlan::Face& face, double depth, double fillet);
// Takes away what fillets have put before a face.
void clearFace(Blend& bone, const VertebraPlan::Face& face);
// Sets a face off from the bone around it by a step, so that it has its own size.
void outlineFace(Blend& bone, const VertebraPlan::Face& face);

}  // namespace torso
