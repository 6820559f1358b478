// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Measures of one vertebra from its surface; bone_measure.h says what each is.

#include <Eigen/Geometry>
#include <optional>

#include "model/mesh_checks.h"

namespace torso {

// Flat part of an articular face about a point, in the frame of the mesh.
struct FaceRegion {
  Eigen::Vector3d centre, normal;  // of the plane through it; out of the bone
  double width, height, area;      // extents across and along the face [m], [m^2]
};
// The face that a bone has within 3 mm of `near`, looking roughly along `outwards`. `up`: direction
// that its height is measured along. `size`: stature over that of the tables. None if there is no
// surface there.
std::optional<FaceRegion> findFace(const MeshTree& bone, const Eigen::Vector3d& near,
                                   const Eigen::Vector3d& outwards, const Eigen::Vector3d& up,
                                   double size);

class VertebraShape {
 public:
  // bone: in the vertebra frame (origin in the body, x forward, z along its axis).
  VertebraShape(const MeshTree& bone, double size);

  struct Endplate {
    double height;        // z of its plane on the axis x = 0 [m]
    double slope;         // dz/dx of its plane
    double front, back;   // x of the body's edge on the mid-line [m]
    double width, depth;  // [m]
    // Height of the plane at x.
    double at(double x) const { return height + slope * x; }
  };
  struct Pedicle {
    double width, height;    // least chords [m]
    double medial;           // y of its medial wall where it is narrowest [m]
    Eigen::Vector3d centre;  // there
  };

  const Endplate& endplate(bool upper) const { return upper ? upper_ : lower_; }
  // z of the endplate's surface over (x, y), from outside; NaN if there is none.
  double surface(bool upper, double x, double y) const;
  double height(bool anterior) const;  // of the body [m]
  double backWall(double z) const;     // x of the body's back on the mid-line
  double canalDepth() const;           // [m]; NaN if the canal is not closed behind
  const std::optional<Pedicle>& pedicle() const { return pedicle_; }
  double bodyVolume() const;  // in front of the body's back wall [m^3]
  double transverseSpan() const;
  Eigen::Vector3d spinousTip() const;  // the furthest point of the process
  double spinousTipDistance() const;

 private:
  double ray(const Eigen::Vector3d& from, const Eigen::Vector3d& along) const {
    return bone_.castRay(from, along).distance;
  }
  Endplate findEndplate(bool upper) const;
  std::optional<Pedicle> findPedicle() const;
  double chord(const Eigen::Vector3d& p, const Eigen::Vector3d& along) const {
    return ray(p, along) + ray(p, -along);
  }

  const MeshTree& bone_;
  const double mm_;  // a millimetre of the tables' size
  Endplate upper_, lower_;
  std::optional<Pedicle> pedicle_;
};

}  // namespace torso
