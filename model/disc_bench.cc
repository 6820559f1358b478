// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/disc_bench.h"

#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace torso {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Quantity = DiscTest::Quantity;

namespace {

constexpr double kTolerance = 1e-8;  // residual force on a node or bone [N]
// A load put on at once may end in another equilibrium than one that grows: a small disc bent far
// has several.
constexpr int kTestSteps = 8;
constexpr double kSmallForce = 0.1, kSmallMoment = 1e-3;  // [N], [Nm]

Eigen::Quaterniond rotationOf(const Vector3d& v) {
  const double angle = v.norm();
  if (angle == 0) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, v / angle));
}

bool isHeld(int held, int dof) { return held >> dof & 1; }

}  // namespace

// The equilibrium's residual and its derivative, the free nodes eliminated.
struct DiscBench::Linearization {
  VectorXd free_force;                             // (3 nfree) on the free nodes
  VectorXd free_step;                              // that ends it while the bone stays
  Eigen::Matrix<double, Eigen::Dynamic, 6> carry;  // minus the free nodes' motion with the bone
  Vector6d bone_load;                              // that the bone bears
  Vector6d load_after_step;                        // that it bears after free_step
  Matrix6d tangent;
};

DiscBench::DiscBench(const DiscMesh& mesh, const DiscMaterial& material)
    : elasticity_(mesh, material),
      upper_nodes_(mesh.upper_nodes),
      u_(VectorXd::Zero(3 * mesh.rest_positions.size())) {
  for (const auto& cell : elasticity_.cells) energy_rounding_ += 1e-15 * cell.mu * cell.volume;
}

DiscBench::Linearization DiscBench::linearize() const {
  const int n = static_cast<int>(u_.size());
  VectorXd force;
  elasticity_.energy(u_, &force);
  const DiscElasticity::Hessian H = elasticity_.hessian(u_);
  Eigen::Matrix<double, Eigen::Dynamic, 6> motion(n, 6);
  motion.setZero();
  Matrix6d geometric = Matrix6d::Zero();  // as the lever of a node's force turns with the bone
  const Matrix3d R = pose_.rotation.toRotationMatrix();
  for (int i : upper_nodes_) {
    const Vector3d arm = R * elasticity_.rest.segment<3>(3 * i), g = -force.segment<3>(3 * i);
    for (int k = 0; k < 3; ++k) {
      motion(3 * i + k, k) = 1;
      motion.block<3, 1>(3 * i, 3 + k) = Vector3d::Unit(k).cross(arm);
    }
    geometric.bottomRightCorner<3, 3>() += arm * g.transpose() - g.dot(arm) * Matrix3d::Identity();
  }
  const VectorXd& g = H.nucleus_gradient;
  const Vector6d swept = motion.transpose() * g;
  const Eigen::Matrix<double, Eigen::Dynamic, 6> coupling =
      H.sparse * motion + H.nucleus_stiffness * g * swept.transpose();

  Linearization l;
  l.bone_load = -motion.transpose() * force;
  l.load_after_step = l.bone_load;
  l.tangent = motion.transpose() * coupling + geometric;
  l.free_force = elasticity_.freePart(force);
  const VectorXd free_g = elasticity_.freePart(g);
  const int nfree = static_cast<int>(free_g.size());
  l.free_step.setZero(nfree);
  l.carry.setZero(nfree, 6);
  if (nfree == 0) return l;

  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(elasticity_.freePart(H.sparse));
  const VectorXd response = factor.solve(free_g);
  const double k = H.nucleus_stiffness / (1 + H.nucleus_stiffness * free_g.dot(response));
  const auto inverse = [&](const VectorXd& b) -> VectorXd {
    const VectorXd x = factor.solve(b);
    return x - k * free_g.dot(x) * response;
  };
  Eigen::Matrix<double, Eigen::Dynamic, 6> free_coupling(nfree, 6);
  for (int j = 0; j < 6; ++j) {
    free_coupling.col(j) = elasticity_.freePart(VectorXd(coupling.col(j)));
    l.carry.col(j) = inverse(free_coupling.col(j));
  }
  l.free_step = inverse(l.free_force);
  l.load_after_step += free_coupling.transpose() * l.free_step;
  l.tangent -= free_coupling.transpose() * l.carry;
  return l;
}

// Moves the free nodes and the upper bone with its nodes.
void DiscBench::displace(const VectorXd& free_step, const Vector6d& step) {
  pose_.position += step.head<3>();
  pose_.rotation = (rotationOf(step.tail<3>()) * pose_.rotation).normalized();
  const Matrix3d R = pose_.rotation.toRotationMatrix();
  for (int i : upper_nodes_) {
    const Vector3d X = elasticity_.rest.segment<3>(3 * i);
    u_.segment<3>(3 * i) = R * X + pose_.position - X;
  }
  for (size_t i = 0; i < elasticity_.free_nodes.size(); ++i) {
    u_.segment<3>(3 * elasticity_.free_nodes[i]) += free_step.segment<3>(3 * i);
  }
}

// Newton's step, halved until the energy falls, the loads' included: a constant moment does the
// work moment x angle in a turn about a fixed axis, as each step is. Returns false if none does.
bool DiscBench::advance(const Linearization& l, const Vector6d& step, const Vector6d& load,
                        int held) {
  const VectorXd free_step = l.free_step - l.carry * step;
  double work = 0, slope = -l.free_force.dot(free_step);
  for (int j = 0; j < 6; ++j) {
    if (isHeld(held, j)) continue;
    work += load[j] * step[j];
    slope -= (load[j] - l.bone_load[j]) * step[j];
  }
  const double energy = elasticity_.energy(u_);
  const double rounding = energy_rounding_ + 1e-13 * (energy + std::abs(work));
  const VectorXd u = u_;
  const DiscPose pose = pose_;
  for (double t = 1; t > 1e-6; t /= 2) {
    displace(t * free_step, t * step);
    const double change = elasticity_.energy(u_) - energy - t * work;
    if (change <= 1e-4 * t * slope + rounding) return true;
    u_ = u;
    pose_ = pose;
  }
  return false;
}

// Newton's method on free nodes and free degrees of freedom together, after the held ones are
// displaced. Returns false if it does not converge.
bool DiscBench::solve(const Vector6d& load, int held, Vector6d displacement) {
  std::vector<int> dofs;
  for (int j = 0; j < 6; ++j) {
    if (!isHeld(held, j)) dofs.push_back(j);
  }
  const int n = static_cast<int>(dofs.size());
  constexpr int kMaxIterations = 60;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const Linearization l = linearize();
    if (!displacement.isZero(0)) {
      displace(l.free_step - l.carry * displacement, displacement);
      displacement.setZero();
      continue;
    }
    double residual = l.free_force.size() > 0 ? l.free_force.cwiseAbs().maxCoeff() : 0;
    Eigen::MatrixXd K(n, n);
    VectorXd missing(n);
    for (int a = 0; a < n; ++a) {
      const int i = dofs[a];
      const double lever = i < 3 ? 1 : elasticity_.size;
      residual = std::max(residual, std::abs(load[i] - l.bone_load[i]) / lever);
      missing[a] = load[i] - l.load_after_step[i];
      for (int b = 0; b < n; ++b) K(a, b) = l.tangent(i, dofs[b]);
    }
    if (residual <= kTolerance) return true;
    Vector6d step = Vector6d::Zero();
    if (n > 0) {
      const VectorXd x = K.partialPivLu().solve(missing);
      for (int a = 0; a < n; ++a) step[dofs[a]] = x[a];
    }
    if (!step.allFinite() || !l.free_step.allFinite()) return false;
    if (!advance(l, step, load, held)) return false;
  }
  return false;
}

// The load is put on in parts if Newton's method does not find its way at once.
void DiscBench::setLoad(const Vector6d& load, int held) {
  const Vector6d start = this->load();
  double done = 0, part = 1;
  while (done < 1) {
    const double next = std::min(1.0, done + part);
    const VectorXd u = u_;
    const DiscPose pose = pose_;
    if (solve(start + next * (load - start), held, Vector6d::Zero())) {
      done = next;
      continue;
    }
    u_ = u;
    pose_ = pose;
    part /= 2;
    if (part < 1e-3) throw DiscGaveWay("the disc finds no equilibrium under its load");
  }
}

void DiscBench::move(const Vector6d& displacement) {
  if (!solve(Vector6d::Zero(), kHoldAll, displacement)) {
    throw DiscGaveWay("the disc finds no equilibrium in its pose");
  }
}

void DiscBench::startFrom(const DiscBench& other) {
  u_ = other.u_;
  pose_ = other.pose_;
}

Vector6d DiscBench::displacement() const {
  const Eigen::AngleAxisd turn(pose_.rotation);
  Vector6d d;
  d << pose_.position, turn.angle() * turn.axis();
  return d;
}

Vector6d DiscBench::load() const {
  VectorXd force;
  elasticity_.energy(u_, &force);
  const Matrix3d R = pose_.rotation.toRotationMatrix();
  Vector6d load = Vector6d::Zero();
  for (int i : upper_nodes_) {
    const Vector3d f = -force.segment<3>(3 * i);
    load.head<3>() += f;
    load.tail<3>() += (R * elasticity_.rest.segment<3>(3 * i)).cross(f);
  }
  return load;
}

double DiscBench::nucleusPressure() const { return elasticity_.nucleusPressure(u_); }

Matrix6d DiscBench::tangent() const { return linearize().tangent; }

Matrix6d stiffnessMatrix(const DiscBench& bench, double amplitude) {
  Matrix6d K;
  for (int j = 0; j < 6; ++j) {
    const double step = j < 3 ? amplitude : amplitude / bench.size();
    Vector6d load[2];
    for (int side : {0, 1}) {
      DiscBench moved = bench;
      moved.move((side == 0 ? -step : step) * Vector6d::Unit(j));
      load[side] = moved.load();
    }
    K.col(j) = (load[1] - load[0]) / (2 * step);
  }
  return (K + K.transpose()) / 2;
}

DiscProtocol discProtocol(Region region, Quantity quantity) {
  const int held = region == Region::kCervical ? kHoldNone : kHoldRotation;
  switch (quantity) {
    case Quantity::kCompression:
    case Quantity::kPressure:
      return {-Vector6d::Unit(2), held};
    case Quantity::kTension:
      return {Vector6d::Unit(2), held};
    case Quantity::kAnteriorShear:
      return {Vector6d::Unit(0), held};
    case Quantity::kPosteriorShear:
      return {-Vector6d::Unit(0), held};
    case Quantity::kLateralShear:
      return {Vector6d::Unit(1), held};
    case Quantity::kFlexion:
      return {Vector6d::Unit(4), kHoldNone};
    case Quantity::kExtension:
      return {-Vector6d::Unit(4), kHoldNone};
    case Quantity::kLateralBending:
      return {Vector6d::Unit(3), kHoldNone};
    case Quantity::kAxialTorsion:
      return {Vector6d::Unit(5), kHoldNone};
    case Quantity::kLossFactor:
    case Quantity::kPreloadRatio:
      break;
  }
  throw std::invalid_argument("this quantity is measured in no loading");
}

DiscCurve loadDisc(DiscBench bench, const DiscProtocol& protocol, double load, double preload,
                   int steps) {
  const Vector6d axial = -preload * Vector6d::Unit(2);
  if (preload > 0) bench.setLoad(axial, protocol.held);
  const Vector6d start = bench.displacement();
  DiscCurve curve;
  for (int i = 0; i <= steps; ++i) {
    const double now = load * i / steps;
    try {
      if (i > 0) bench.setLoad(axial + now * protocol.direction, protocol.held);
    } catch (const DiscGaveWay&) {
      break;
    }
    curve.load.push_back(now);
    curve.displacement.push_back(protocol.direction.dot(bench.displacement() - start));
    curve.nucleus_pressure.push_back(bench.nucleusPressure());
  }
  return curve;
}

namespace {

double meanPreloadRatio(const DiscBench& bench, double preload) {
  DiscBench loaded = bench;
  loaded.setLoad(-preload * Vector6d::Unit(2));
  const Vector6d before = stiffnessMatrix(bench).diagonal();
  const Vector6d after = stiffnessMatrix(loaded).diagonal();
  return (after.array() / before.array()).mean();
}

}  // namespace

double simulateDiscTest(const DiscBench& bench, double retardation_time, const DiscTest& test) {
  if (test.quantity == Quantity::kLossFactor) return 2 * M_PI * retardation_time;
  if (test.quantity == Quantity::kPreloadRatio) return meanPreloadRatio(bench, test.preload);
  return simulateDiscTest(bench, test, nullptr, nullptr);
}

double simulateDiscTest(const DiscBench& bench, const DiscTest& test, const DiscTestEnds* near,
                        DiscTestEnds* ends) {
  const DiscProtocol protocol = discProtocol(test.region, test.quantity);
  const bool moment =
      test.quantity >= Quantity::kFlexion && test.quantity <= Quantity::kAxialTorsion;
  const double small = moment ? kSmallMoment : kSmallForce;
  const double load = test.load > 0 ? test.load : small;
  const Vector6d axial = -test.preload * Vector6d::Unit(2);
  DiscBench preloaded = bench;
  if (near) preloaded.startFrom(near->preloaded);
  if (near || test.preload > 0) preloaded.setLoad(axial, protocol.held);
  DiscBench loaded = preloaded;
  if (near) loaded.startFrom(near->loaded);
  const int steps = near ? 1 : kTestSteps;
  for (int i = 1; i <= steps; ++i) {
    loaded.setLoad(axial + load * i / steps * protocol.direction, protocol.held);
  }
  if (ends) *ends = {preloaded, loaded};
  if (test.quantity == Quantity::kPressure) return loaded.nucleusPressure();
  return load / protocol.direction.dot(loaded.displacement() - preloaded.displacement());
}

}  // namespace torso
