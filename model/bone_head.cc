// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/bone_parts.h"
#include "model/bone_skull.h"
#include "model/fuse.h"

namespace torso {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

class Head {
 public:
  explicit Head(const Anatomy& anatomy) : anatomy_(anatomy) {
    ear_ = anatomy.landmark("external_auditory_meatus");
    ear_.y() = 0;
  }

  TriMesh build() {
    TriMesh mesh = skullAndJaw();
    append(mesh, fuse(atlas(), {1.1_mm, 2.5_mm, 600, 2, true}));
    append(mesh, fuse(axis(), {1.2_mm, 3_mm, 1000, 0, true}));
    return mesh;
  }

 private:
  // Sized so that the vault ends just below the head's vertex.
  TriMesh skullAndJaw() const {
    constexpr double kScalp = 2;
    const double scale =
        (anatomy_.landmark("head_vertex").z() - ear_.z()) / (kVaultHeight + kScalp);
    // The occipital condyles lie on C1.
    TriMesh mesh = skullMesh((anatomy_.c2.position + pointMm(1, 17, 23.5) - ear_) / scale);
    append(mesh, teethMesh(upperArch()));
    append(mesh, mandibleMesh());
    append(mesh, teethMesh(lowerArch()));
    for (Vector3d& v : mesh.vertices) v = ear_ + scale * v;
    return mesh;
  }

  // C1: a ring between the condyles of the skull and C2. From C2's body centre [mm].
  TriMesh atlas() const {
    TriMesh mesh;
    const Vector3d c2 = anatomy_.c2.position;
    const auto c = [&](double x, double y, double z, double side, double up) {
      return Section{c2 + pointMm(x, y, z), side * 1e-3, up * 1e-3, Vector3d::Zero()};
    };
    TubeStyle style;
    const Matrix3d tilt = Eigen::AngleAxisd(0.15, Vector3d::UnitX()).toRotationMatrix();
    appendPair(mesh, ellipsoid(c2 + pointMm(0, 19, 18), pointMm(10, 7.5, 6.5), tilt, 16, 2.5));
    append(mesh, tube({c(4, -18, 18, 4, 5), c(12, -9, 18.5, 3, 4.5), c(14.5, 0, 18.5, 3.2, 5.5),
                       c(12, 9, 18.5, 3, 4.5), c(4, 18, 18, 4, 5)},
                      style));
    append(mesh, tube({c(-4, -21, 18, 3.5, 4.5), c(-18, -21, 17, 3, 3.5), c(-30, -12, 16.5, 3, 4),
                       c(-33, 0, 16.5, 3.8, 5), c(-30, 12, 16.5, 3, 4), c(-18, 21, 17, 3, 3.5),
                       c(-4, 21, 18, 3.5, 4.5)},
                      style));
    appendPair(
        mesh, tube({c(-1, 22, 18, 4, 3.5), c(-3, 30, 17, 3, 2.8), c(-6, 37, 16, 3.8, 3.2)}, style));
    return mesh;
  }

  TriMesh axis() const {
    TriMesh mesh = vertebraShells(anatomy_, "C2");
    const Eigen::Isometry3d frame = anatomy_.c2.frame();
    TubeStyle style;
    style.up = Vector3d::UnitX();
    append(mesh, tube({{frame * pointMm(1, 0, 6), 6_mm, 6_mm},
                       {frame * pointMm(1, 0, 16), 4.8_mm, 5.2_mm},
                       {frame * pointMm(2, 0, 24), 5.2_mm, 5.5_mm},
                       {frame * pointMm(1, 0, 29), 3.8_mm, 4_mm}},
                      style));
    return mesh;
  }

  const Anatomy& anatomy_;
  Vector3d ear_;
};

}  // namespace

TriMesh headMesh(const Anatomy& anatomy) { return Head(anatomy).build(); }

}  // namespace torso
