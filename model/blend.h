// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Solids put together with fillets, and the surface of the result as a mesh.

#include <Eigen/Geometry>
#include <vector>

#include "model/solid.h"
#include "model/tri_mesh.h"

namespace torso {

// Smaller of two distances, with a fillet of size k >= 0 where they are equal (a polynomial smooth
// minimum), and the greater one.
double smoothMin(double a, double b, double k);
double smoothMax(double a, double b, double k);

// Solids united, carved away or clipped to, one after the other, each with a fillet, 0 for none.
class Blend {
 public:
  Blend() = default;
  Blend(const Solid& solid) { unite(solid, 0); }

  Blend& unite(const Solid& solid, double fillet = 0);
  Blend& carve(const Solid& solid, double fillet = 0);  // takes the solid away
  Blend& clip(const Solid& solid, double fillet = 0);   // keeps what lies in the solid
  Blend& unitePair(const Solid& left, double fillet);   // and its mirror image
  Blend& carvePair(const Solid& left, double fillet);

  const Eigen::AlignedBox3d& box() const { return box_; }
  // A lower bound of the distance where it is more than `far`.
  double distance(const Eigen::Vector3d& p, double far) const;
  Solid solid() const;

 private:
  enum class Action { kUnite, kCarve, kClip };
  struct Step {
    Solid solid;
    double fillet;
    Action action;
  };
  std::vector<Step> steps_;
  Eigen::AlignedBox3d box_;
  double largest_fillet_ = 0;
};

}  // namespace torso
