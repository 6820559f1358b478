// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The laboratory's bench for one disc between two bones: no ligaments, no facets, lower bone
// clamped, loads on the upper bone, in equilibrium at every point (quasi-static). Degrees of
// freedom and loads come in the order x, y, z, rotation about x, y, z, of the disc frame (disc.h);
// a force acts at the origin of the upper bone's disc frame and a moment about it, both with
// directions that stay as the bone moves. SI units.

#include <Eigen/Core>
#include <stdexcept>
#include <vector>

#include "model/anatomy.h"
#include "model/disc.h"
#include "model/disc_elasticity.h"

namespace torso {

// Degrees of freedom that are held where they are, as bits 1 << dof.
enum HeldDofs { kHoldNone = 0, kHoldRotation = 7 << 3, kHoldAll = 63 };

// A disc finds no equilibrium: it is far too soft for its load.
class DiscGaveWay : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// One disc and the pose in which it is. All functions leave it in equilibrium, or throw DiscGaveWay
// if none is found.
class DiscBench {
 public:
  // At rest. Throws std::invalid_argument with the message of checkDiscMesh / checkDiscMaterial.
  DiscBench(const DiscMesh& mesh, const DiscMaterial& material);

  // The free degrees of freedom move until the load on them is `load`. What `load` says of held
  // ones is ignored: they bear whatever reaction arises.
  void setLoad(const Vector6d& load, int held = kHoldNone);
  // Moves the upper bone by a translation and a rotation vector about its disc frame's origin.
  void move(const Vector6d& displacement);

  // Takes the pose and the shape of a disc of the same mesh and perhaps another material, as a
  // place to start from: not an equilibrium yet.
  void startFrom(const DiscBench& other);

  const DiscPose& pose() const { return pose_; }    // of the upper bone
  Vector6d displacement() const;                    // from rest: translation, rotation vector
  Vector6d load() const;                            // that holds the upper bone where it is
  double nucleusPressure() const;                   // [Pa]
  double size() const { return elasticity_.size; }  // largest distance of a node to the centre [m]
  // Derivative of load() by `move` where the disc stands (6x6, SI). At rest, where all fibres are
  // about to be stretched, it is that of the disc without fibres.
  Matrix6d tangent() const;

 private:
  struct Linearization;

  Linearization linearize() const;
  bool solve(const Vector6d& load, int held, Vector6d displacement);
  bool advance(const Linearization& l, const Vector6d& step, const Vector6d& load, int held);
  void displace(const Eigen::VectorXd& free_step, const Vector6d& step);

  DiscElasticity elasticity_;
  double energy_rounding_ = 0;  // rounding error of the energy near rest [J]
  std::vector<int> upper_nodes_;
  DiscPose pose_;
  Eigen::VectorXd u_;  // (3 nnode) displacements from rest, lower disc frame [m]
};

// Stiffness for small displacements from where `bench` stands (6x6, SI), the other motions held:
// central differences over +-amplitude [m], and +-amplitude over the disc's size in rotation (0.1
// mm is about 0.25 deg of a lumbar disc; laboratories use 0.5 mm and 1 to 2 deg). Its symmetric
// part, as laboratories give (Gardner-Morse and Stokes 2004). A finite amplitude makes it
// continuous in the material and the preload, though fibres that it stretches resist and others do
// not.
Matrix6d stiffnessMatrix(const DiscBench& bench, double amplitude = 1e-4);

// How a quantity is measured in the laboratory.
struct DiscProtocol {
  Vector6d direction;  // of the load: a unit vector along one degree of freedom
  int held;            // HeldDofs, during preload and test
};

// Compression, tension and shear of lumbar and thoracic discs with rotations held, as testing
// machines and shear rigs hold the potted bones; cervical discs with all motions free, as Moroney
// et al. 1988 loaded them; moments with all motions free. kPressure is measured in compression.
// Throws std::invalid_argument for kLossFactor and kPreloadRatio, which are no loading.
DiscProtocol discProtocol(Region region, DiscTest::Quantity quantity);

// Response to a load that grows in equal steps on top of an axial preload. Points beyond which the
// disc gives way are left out.
struct DiscCurve {
  std::vector<double> load;              // (point) [N] or [Nm], from 0
  std::vector<double> displacement;      // (point) along the load, from the preloaded pose [m, rad]
  std::vector<double> nucleus_pressure;  // (point) [Pa]
};
DiscCurve loadDisc(DiscBench bench, const DiscProtocol& protocol, double load, double preload,
                   int steps);

// What the test would give of this disc, in the unit of DiscTest::value: stiffnesses are secants
// from rest, or the preloaded pose, to the test's load (0: 0.1 N, 1 mNm). `bench` at rest.
// `retardation_time` [s]: of a disc whose viscosity is in proportion to its stiffness; the loss
// factor is that at 1 Hz.
double simulateDiscTest(const DiscBench& bench, double retardation_time, const DiscTest& test);

// Where a loading begins and ends.
struct DiscTestEnds {
  DiscBench preloaded, loaded;
};
// The same, but for the loss factor and the preload ratio, and where the disc stood. ends: of a
// disc of the same mesh and nearly the same material; equilibrium is then looked for from there, in
// a tenth of the time; null: the load grows from none.
double simulateDiscTest(const DiscBench& bench, const DiscTest& test, const DiscTestEnds* near,
                        DiscTestEnds* ends);

}  // namespace torso
