// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "model/body.h"
#include "tools/error.h"
#include "tools/mujoco_support.h"
#include "tools/retarget.h"
#include "tools/rhythm.h"
#include "tools/temporary_skeleton.h"

namespace torso::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::VectorXd;

// Deviations that weigh the same. What the clip determines is met to well below these, for the
// posture of trunk and girdle, which fills the rest in, is softer by orders of magnitude.
constexpr double kDegree = M_PI / 180;
constexpr double kPositionSigma = 0.003;        // pelvis, shoulders, head [m]
constexpr double kContactSigma = 0.001;         // of a foot that stands [m]
constexpr double kRotationSigma = 1 * kDegree;  // held bones
constexpr double kChestSigma = 30 * kDegree;    // rib cage to the clip's
constexpr double kTrunkSigma = 60 * kDegree;    // each ball joint of the trunk from rest
constexpr double kGirdleSigma = 15 * kDegree;   // clavicle from its rhythm, scapula from rest
constexpr double kLimitSigma = 2 * kDegree;     // beyond the limits below
// Wide limits: twice and more what a spine's region can do (range_of_motion.csv).
constexpr double kTrunkLimit = 80 * kDegree;
// Of the clavicle about its rhythm, half of what its servos can do (servos.csv), and of the scapula
// on the clavicle: gliding on the ribs lets the detailed body's turn there by little.
constexpr double kClavicleLimit = 20 * kDegree, kScapulaLimit = 5 * kDegree;

constexpr int kMaxIterations = 60;
constexpr double kStep = 1e-5;        // [rad], [m]
constexpr double kLongestStep = 0.5;  // so that a far start finds its way [rad], [m]

// A target missed by ten times its sigma.
constexpr double kLostCost = 100;

// A frame is flagged where a held bone misses its target by more than the goal's 95th percentile.
constexpr double kFlagPosition = 0.010, kFlagRotation = 3 * kDegree;

Vector3d rotationVector(const Quaterniond& q) {
  const double sign = q.w() < 0 ? -1 : 1, s = q.vec().norm();
  const double angle = 2 * std::atan2(s, std::abs(q.w()));
  return s < 1e-12 ? Vector3d(2 * sign * q.vec()) : Vector3d(sign * angle / s * q.vec());
}

Matrix3d cross(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

// Derivative of rotationVector by a turn in the joint's own frame.
Matrix3d inverseRightJacobian(const Vector3d& v) {
  const double a = v.norm();
  const Matrix3d V = cross(v);
  if (a < 1e-6) return Matrix3d::Identity() + V / 2;
  return Matrix3d::Identity() + V / 2 +
         (1 / (a * a) - (1 + std::cos(a)) / (2 * a * std::sin(a))) * V * V;
}

class Solver {
 public:
  Solver(const Targets& targets, const Performer& performer)
      : t_(targets),
        model_(compileModel(temporarySkeletonMjcf(performer.anatomy), "temporary skeleton")),
        data_(makeData(model_.get())),
        m_(model_.get()),
        d_(data_.get()),
        H_(m_->nv, m_->nv),
        g_(m_->nv),
        jacp_(3, m_->nv),
        jacr_(3, m_->nv) {
    for (const std::string& name : heldBodies()) bodies_.push_back(id(mjOBJ_BODY, name));
    ribcage_ = id(mjOBJ_BODY, "ribcage");
    for (const char* name : {"lumbar", "thoracic", "cervical", "head"}) {
      posture_.push_back({id(mjOBJ_JOINT, name), kTrunkSigma, kTrunkLimit});
    }
    for (const char* name : {"back_length", "neck_length"}) {
      slides_.push_back(id(mjOBJ_JOINT, name));
    }
    for (const std::string side : {"left_", "right_"}) {
      shoulders_.push_back(static_cast<int>(posture_.size()));
      posture_.push_back(
          {id(mjOBJ_JOINT, side + "sternoclavicular"), kGirdleSigma, kClavicleLimit});
      posture_.push_back(
          {id(mjOBJ_JOINT, side + "acromioclavicular"), kGirdleSigma, kScapulaLimit});
    }
    for (int side = 0; side < 2; side++) {
      const int elbow = bodies_[heldBody(side, kLowerArm)];
      shafts_[side] = Eigen::Map<const Vector3d>(m_->body_pos + 3 * elbow).normalized();
    }
    // Joints of limbs that no target turns stay at rest.
    for (int j = 0; j < m_->njnt; j++) {
      if (m_->jnt_type[j] != mjJNT_BALL) continue;
      const int body = m_->jnt_bodyid[j];
      const auto held = std::find(bodies_.begin(), bodies_.end(), body);
      if (held != bodies_.end() && body != bodies_[kHead] && !t_.has[held - bodies_.begin()]) {
        posture_.push_back({j, kRotationSigma, M_PI});
      }
    }
  }

  Retargeted solve(const std::string& name, double rate) {
    Retargeted out;
    out.motion.name = name;
    out.motion.rate = rate;
    out.motion.bodies = heldBodies();
    for (size_t f = 0; f < t_.frames; f++) {
      if (f == 0) start(f);
      const double cost = solveFrame(f);
      if (f > 0 && cost > kLostCost) restart(f, cost);
      record(f, out);
    }
    return out;
  }

 private:
  using RowJacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;
  struct Posture {
    int joint;
    double sigma, limit;
    Quaterniond rest = Quaterniond::Identity();
  };

  int id(mjtObj type, const std::string& name) const { return mj_name2id(m_, type, name.c_str()); }
  const Isometry3d& target(size_t f, int held) const { return t_.poses[f * bodies_.size() + held]; }
  Quaterniond turn(int body) const {
    const mjtNum* q = d_->xquat + 4 * body;
    return {q[0], q[1], q[2], q[3]};
  }
  Vector3d place(int body) const { return Eigen::Map<const Vector3d>(d_->xpos + 3 * body); }

  void kinematics() {
    mj_kinematics(m_, d_);
    mj_comPos(m_, d_);
  }

  // Pelvis in place, the trunk's turn shared by its joints, limbs as the targets have them.
  void start(size_t f) {
    mju_copy(d_->qpos, m_->qpos0, m_->nq);
    const Isometry3d& X = target(f, kPelvis);
    setTurn(d_->qpos + 3, Quaterniond(X.linear()));
    for (int k = 0; k < 3; k++) d_->qpos[k] = X.translation()[k];
    Quaterniond chest(X.linear());
    if (t_.has_chest) {
      const Quaterniond all = chest.conjugate() * t_.chest[f];
      const Quaterniond half = Quaterniond::Identity().slerp(0.5, all);
      for (int k = 0; k < 2; k++) setTurn(qposOf(posture_[k].joint), half);
      chest = t_.chest[f];
    }
    if (t_.has[kHead]) {
      const Quaterniond all = chest.conjugate() * Quaterniond(target(f, kHead).linear());
      setTurn(qposOf(posture_[2].joint), Quaterniond::Identity().slerp(0.5, all));
    }
    for (size_t b = 0; b < bodies_.size(); b++) {
      if (b == kPelvis || !t_.has[b]) continue;
      kinematics();
      const int body = bodies_[b];
      const mjtNum* fixed = m_->body_quat + 4 * body;
      const Quaterniond at_rest =
          turn(m_->body_parentid[body]) * Quaterniond(fixed[0], fixed[1], fixed[2], fixed[3]);
      const int joint = m_->body_jntadr[body] + m_->body_jntnum[body] - 1;
      setTurn(qposOf(joint),
              at_rest.conjugate() * Quaterniond(target(f, static_cast<int>(b)).linear()));
    }
  }
  mjtNum* qposOf(int joint) { return d_->qpos + m_->jnt_qposadr[joint]; }
  static void setTurn(mjtNum* to, const Quaterniond& q) {
    to[0] = q.w(), to[1] = q.x(), to[2] = q.y(), to[3] = q.z();
  }

  // Adds |residual|^2 weight to the cost and, with residual + J dq, to the normal equations.
  void add(const RowJacobian& J, const Vector3d& residual, double weight) {
    cost_ += weight * residual.squaredNorm();
    if (!derive_) return;
    // Only the columns of the body's own chain are not zero.
    columns_.clear();
    for (int c = 0; c < m_->nv; c++) {
      if (J(0, c) != 0 || J(1, c) != 0 || J(2, c) != 0) columns_.push_back(c);
    }
    for (int a : columns_) {
      const Vector3d Ja = weight * J.col(a);
      g_[a] -= Ja.dot(residual);
      for (int b : columns_) {
        if (b <= a) H_(a, b) += Ja.dot(J.col(b));
      }
    }
  }

  void addPosition(size_t f, int held, double weight) {
    const int body = bodies_[held];
    if (derive_) mj_jacBody(m_, d_, jacp_.data(), nullptr, body);
    add(jacp_, place(body) - target(f, held).translation(), weight);
  }
  void addRotation(const Quaterniond& goal, int body, double weight) {
    if (derive_) mj_jacBody(m_, d_, nullptr, jacr_.data(), body);
    add(jacr_, rotationVector(turn(body) * goal.conjugate()), weight);
  }

  // The cost in the state of d_, with the normal equations if asked.
  double evaluate(size_t f, bool derive) {
    derive_ = derive;
    cost_ = 0;
    mj_kinematics(m_, d_);
    if (derive) {
      mj_comPos(m_, d_);
      H_.setZero();
      g_.setZero();
    }
    const double place = 1 / (kPositionSigma * kPositionSigma);
    const double turn_weight = 1 / (kRotationSigma * kRotationSigma);
    addPosition(f, kPelvis, place);
    if (t_.has[kHead]) addPosition(f, kHead, place);
    for (int side = 0; side < 2; side++) {
      if (t_.has[heldBody(side, kUpperArm)]) addPosition(f, heldBody(side, kUpperArm), place);
      const double contact = t_.contact[f][side];
      if (contact > 0) {
        addPosition(f, heldBody(side, kFoot), contact / (kContactSigma * kContactSigma));
      }
    }
    for (size_t b = 0; b < bodies_.size(); b++) {
      if (!t_.has[b]) continue;
      addRotation(Quaterniond(target(f, static_cast<int>(b)).linear()), bodies_[b], turn_weight);
    }
    if (t_.has_chest) addRotation(t_.chest[f], ribcage_, 1 / (kChestSigma * kChestSigma));
    for (const Posture& p : posture_) addPosture(p);
    for (int joint : slides_) addSlide(joint);
    return cost_;
  }

  // From the last frame's pose the way may lead to a trunk that is wound up: where the targets are
  // missed, a start from nothing is tried too.
  void restart(size_t f, double cost) {
    const std::vector<mjtNum> qpos(d_->qpos, d_->qpos + m_->nq);
    start(f);
    if (solveFrame(f) < 0.5 * cost) return;
    mju_copy(d_->qpos, qpos.data(), m_->nq);
    kinematics();
  }

  // Clavicles and scapulae go along with the upper arms that the clip has, on the rib cage as it
  // is.
  void leadGirdle(size_t f) {
    mj_kinematics(m_, d_);
    for (int side = 0; side < 2; side++) {
      const int arm = heldBody(side, kUpperArm);
      const Vector3d shaft = turn(ribcage_).conjugate() * (target(f, arm).linear() * shafts_[side]);
      const double raised = std::acos(std::clamp(-shaft.z(), -1.0, 1.0));
      posture_[shoulders_[side]].rest = girdleRhythm(raised, side == 0 ? 1 : -1).sternoclavicular;
    }
  }

  // Levenberg-Marquardt until steps are small. Returns the cost.
  double solveFrame(size_t f) {
    leadGirdle(f);
    double damping = 1e-3;
    double cost = evaluate(f, true);
    std::vector<mjtNum> qpos(d_->qpos, d_->qpos + m_->nq);
    for (int k = 0; k < kMaxIterations; k++) {
      MatrixXd damped = H_;
      damped.diagonal().array() += damping;
      const VectorXd dq = damped.selfadjointView<Eigen::Lower>().llt().solve(g_);
      const double largest = dq.cwiseAbs().maxCoeff();
      if (!std::isfinite(largest)) throw Error("inverse kinematics failed");
      const VectorXd move = std::min(1.0, kLongestStep / largest) * dq;
      mj_integratePos(m_, d_->qpos, move.data(), 1);
      const double next = evaluate(f, false);
      if (next > cost * (1 + 1e-9)) {
        mju_copy(d_->qpos, qpos.data(), m_->nq);
        if (largest < kStep || damping > 1e8) break;
        damping *= 10;
        continue;
      }
      damping = std::max(1e-3, damping / 10);
      qpos.assign(d_->qpos, d_->qpos + m_->nq);
      if (largest < kStep) break;
      cost = evaluate(f, true);
    }
    cost = evaluate(f, false);
    kinematics();
    return cost;
  }

  // Within the range as soft as a turn of a ball joint by kTrunkSigma, beyond it hard.
  void addSlide(int joint) {
    const double x = d_->qpos[m_->jnt_qposadr[joint]], most = m_->jnt_range[2 * joint + 1];
    const int dof = m_->jnt_dofadr[joint];
    const auto addTerm = [&](double residual, double sigma) {
      cost_ += residual * residual / (sigma * sigma);
      if (!derive_) return;
      H_(dof, dof) += 1 / (sigma * sigma);
      g_[dof] -= residual / (sigma * sigma);
    };
    addTerm(x, most);
    if (std::abs(x) > most) addTerm(x - std::copysign(most, x), kContactSigma);
  }

  void addPosture(const Posture& p) {
    const mjtNum* q = d_->qpos + m_->jnt_qposadr[p.joint];
    const Vector3d v = rotationVector(p.rest.conjugate() * Quaterniond(q[0], q[1], q[2], q[3]));
    const Matrix3d J = inverseRightJacobian(v);
    const int dof = m_->jnt_dofadr[p.joint];
    const auto addRows = [&](const Vector3d& residual, const Matrix3d& rows, double sigma) {
      const double weight = 1 / (sigma * sigma);
      cost_ += weight * residual.squaredNorm();
      if (!derive_) return;
      H_.block<3, 3>(dof, dof) += weight * rows.transpose() * rows;
      g_.segment<3>(dof) -= weight * rows.transpose() * residual;
    };
    addRows(v, J, p.sigma);
    const double angle = v.norm();
    if (angle <= p.limit) return;
    const Vector3d axis = v / angle;
    addRows((angle - p.limit) * axis, axis * axis.transpose() * J, kLimitSigma);
  }

  void record(size_t f, Retargeted& out) {
    double worst_position = 0, worst_rotation = 0;
    size_t worst = 0;
    HeldMotion& motion = out.motion;
    for (size_t b = 0; b < bodies_.size(); b++) {
      const Vector3d p = place(bodies_[b]);
      Quaterniond q = turn(bodies_[b]);
      if (f > 0) {  // the sign that is nearer to the last frame's
        const auto& last = motion.quaternions[motion.quaternions.size() - bodies_.size()];
        const double dot = last[0] * q.w() + last[1] * q.x() + last[2] * q.y() + last[3] * q.z();
        if (dot < 0) q.coeffs() *= -1;
      }
      motion.positions.push_back({p.x(), p.y(), p.z()});
      motion.quaternions.push_back({q.w(), q.x(), q.y(), q.z()});
      if (!t_.has[b]) continue;
      const Isometry3d& goal = target(f, static_cast<int>(b));
      const double apart = (p - goal.translation()).norm();
      if (apart > worst_position) worst_position = apart, worst = b;
      worst_rotation = std::max(worst_rotation,
                                rotationVector(q * Quaterniond(goal.linear()).conjugate()).norm());
    }
    motion.position_errors.push_back(worst_position);
    motion.rotation_errors.push_back(worst_rotation);
    std::vector<std::string> flags;
    if (worst_position > kFlagPosition) {
      flags.push_back(fmt::format("{} {:.0f} mm from the clip's: out of reach", heldBodies()[worst],
                                  1e3 * worst_position));
    }
    if (worst_rotation > kFlagRotation) {
      flags.push_back(
          fmt::format("a bone is turned {:.0f} degrees from the clip's", worst_rotation / kDegree));
    }
    motion.flags.push_back(flags);
    out.qpos.emplace_back(d_->qpos, d_->qpos + m_->nq);
  }

  const Targets& t_;
  ModelPtr model_;
  DataPtr data_;
  const mjModel* m_;
  mjData* d_;
  std::vector<int> bodies_;  // MuJoCo's ids, by heldBodies()
  int ribcage_;
  std::vector<Posture> posture_;
  std::vector<int> slides_;
  std::vector<int> shoulders_;      // of posture_: left and right sternoclavicular
  std::array<Vector3d, 2> shafts_;  // of the upper arms, their frames, towards the elbow
  MatrixXd H_;
  VectorXd g_;
  RowJacobian jacp_, jacr_;
  std::vector<int> columns_;
  double cost_ = 0;
  bool derive_ = true;
};

}  // namespace

Retargeted solveMotion(const Targets& targets, const Performer& performer, const std::string& name,
                       double rate) {
  return Solver(targets, performer).solve(name, rate);
}

}  // namespace torso::tools
