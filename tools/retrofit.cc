// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/retrofit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plugin/mujoco_torso.h"
#include "tools/clock.h"
#include "tools/equilibrium.h"
#include "tools/error.h"
#include "tools/graft_xml.h"
#include "tools/posture.h"

namespace torso::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// From rest to the first frame, and then at most until it is at rest.
constexpr int kApproach = 100, kFirstRest = 300;
constexpr double kAtRest = 1e-5;  // [rad] a step
// Of the holds in a step: one that moves faster gets more steps, up to so many a frame.
constexpr double kStride = 0.005, kTurn = EIGEN_PI / 180;  // [m], [rad]
constexpr int kMostSteps = 60;
// After the holds have come to a frame, for as long as it would be flagged as not at rest.
constexpr int kRest = 40;

Isometry3d blend(const Isometry3d& a, const Isometry3d& b, double s) {
  return isometry(Quaterniond(a.linear()).slerp(s, Quaterniond(b.linear())),
                  (1 - s) * a.translation() + s * b.translation());
}

// Poses of a HeldMotion by name.
class Poses {
 public:
  explicit Poses(const HeldMotion& motion) : motion_(motion) {
    const auto fail = [&](const std::string& what) { throw Error(motion.name + ": " + what); };
    const std::size_t n = motion.positions.size();
    if (n == 0 || n != motion.quaternions.size() || n % motion.bodies.size() != 0) {
      fail("the motion has no frames");
    }
    if (!(motion.rate > 0)) fail("the motion has no frame rate");
    if (!has("pelvis")) fail("the motion does not tell where the pelvis is");
    for (std::size_t i = 0; i < n; i++) {
      double sum = 0, norm = 0;
      for (double x : motion.positions[i]) sum += x;
      for (double x : motion.quaternions[i]) norm += x * x;
      if (!std::isfinite(sum) || !std::isfinite(norm) || norm < 1e-6) {
        fail(fmt::format("frame {}: the pose of {} is not a number", i / motion.bodies.size(),
                         motion.bodies[i % motion.bodies.size()]));
      }
    }
  }

  bool has(const std::string& body) const { return column(body) < motion_.bodies.size(); }

  Isometry3d at(std::size_t frame, const std::string& body) const {
    const std::size_t i = frame * motion_.bodies.size() + column(body);
    const auto& p = motion_.positions[i];
    const auto& q = motion_.quaternions[i];
    return isometry(Quaterniond(q[0], q[1], q[2], q[3]), Vector3d(p[0], p[1], p[2]));
  }

 private:
  std::size_t column(const std::string& body) const {
    return std::find(motion_.bodies.begin(), motion_.bodies.end(), body) - motion_.bodies.begin();
  }
  const HeldMotion& motion_;
};

void setQuaternion(mjtNum* q, const Quaterniond& value) {
  q[0] = value.w();
  q[1] = value.x();
  q[2] = value.y();
  q[3] = value.z();
}

// Pose of the whole body at a frame: torso as in `torso`, limbs as held. human: scratch.
void assemble(const mjModel* m, mjData* human, Equilibrium& torso, const Poses& poses,
              std::size_t frame) {
  const Isometry3d pelvis = poses.at(frame, "pelvis");
  mju_copy(human->qpos, m->qpos0, m->nq);
  // Bodies come after their parents, so that a parent's pose is known.
  std::vector<Quaterniond> world(m->nbody, Quaterniond::Identity());
  for (int b = 1; b < m->nbody; b++) {
    const std::string name = nameOf(m, mjOBJ_BODY, b);
    const mjtNum* rest = m->body_quat + 4 * b;
    const Quaterniond to_parent(rest[0], rest[1], rest[2], rest[3]);
    world[b] = world[m->body_parentid[b]] * to_parent;
    if (m->body_jntnum[b] != 1) continue;
    const int joint = m->body_jntadr[b];
    mjtNum* q = human->qpos + m->jnt_qposadr[joint];
    const int twin = mj_name2id(torso.model(), mjOBJ_BODY, name.c_str());
    if (m->jnt_type[joint] == mjJNT_FREE) {
      const Isometry3d X = name == "pelvis" ? pelvis : pelvis * torso.pose(twin);
      mju_copy3(q, X.translation().data());
      world[b] = Quaterniond(X.linear());
      setQuaternion(q + 3, world[b]);
    } else if (m->jnt_type[joint] == mjJNT_BALL) {
      Quaterniond turn = Quaterniond::Identity();
      if (twin >= 0) {
        const mjtNum* t =
            torso.data()->qpos + torso.model()->jnt_qposadr[torso.model()->body_jntadr[twin]];
        turn = Quaterniond(t[0], t[1], t[2], t[3]);
      } else if (poses.has(name)) {
        turn = world[b].conjugate() * Quaterniond(poses.at(frame, name).linear());
      }
      turn.normalize();
      setQuaternion(q, turn);
      world[b] = world[b] * turn;
    }
  }
}

// The way of the holds from frame to frame.
class Course {
 public:
  Course(Equilibrium& torso, const RetrofitOptions& options, double rate)
      : torso_(torso), last_(torso.restPoses()), unrest_limit_(options.unrest) {
    least_ = std::max(2, static_cast<int>(std::lround(options.steps / rate)));
  }

  // Brings the torso along as the holds go to the next frame; the first time from rest. Returns
  // false if it lost its footing on the way, for a pose far out of reach, and has come from rest
  // again.
  bool follow(const std::vector<Isometry3d>& goal, const Vector3d& up) {
    int steps = least_;
    for (std::size_t i = 0; i < goal.size(); i++) {
      const Isometry3d move = last_[i].inverse() * goal[i];
      steps = std::max(steps, static_cast<int>(move.translation().norm() / kStride));
      steps = std::max(steps, static_cast<int>(Eigen::AngleAxisd(move.linear()).angle() / kTurn));
    }
    if (started_ && go(goal, up, std::min(steps, kMostSteps))) {
      for (int i = 0; i < kRest && unrest_ > unrest_limit_; i++) unrest_ = torso_.step();
      if (firstWarning(torso_.data()).empty()) return true;
    }
    const bool lost = started_;
    started_ = true;
    torso_.reset();
    last_ = torso_.restPoses();
    last_up_ = up;
    go(goal, up, kApproach);
    for (int i = 0; i < kFirstRest && unrest_ > kAtRest; i++) unrest_ = torso_.step();
    return !lost;
  }

  double unrest() const { return unrest_; }

 private:
  bool go(const std::vector<Isometry3d>& goal, const Vector3d& up, int steps) {
    std::vector<Isometry3d> now = goal;
    for (int s = 1; s <= steps; s++) {
      const double share = static_cast<double>(s) / steps;
      for (std::size_t i = 0; i < goal.size(); i++) now[i] = blend(last_[i], goal[i], share);
      torso_.hold(now, (1 - share) * last_up_ + share * up);
      unrest_ = torso_.step();
    }
    last_ = goal;
    last_up_ = up;
    return firstWarning(torso_.data()).empty();
  }

  Equilibrium& torso_;
  std::vector<Isometry3d> last_;
  double unrest_limit_;  // RetrofitOptions::unrest
  Vector3d last_up_ = Vector3d::Zero();
  int least_;
  bool started_ = false;
  double unrest_ = 0;
};

void addFlags(const RetrofitOptions& options, bool jumped, RetrofitFrame* frame) {
  const auto flag = [frame](const std::string& text) { frame->flags.push_back(text); };
  if (frame->position_error > options.position_error) {
    flag(fmt::format("held bone {:.0f} mm off", 1e3 * frame->position_error));
  }
  if (frame->rotation_error > options.rotation_error) {
    flag(fmt::format("held bone {:.0f} deg off", frame->rotation_error * 180 / EIGEN_PI));
  }
  const double tension = *std::max_element(frame->ligaments.begin(), frame->ligaments.end());
  if (tension > options.ligament_tension) flag(fmt::format("ligament at {:.0f} N", tension));
  if (frame->unrest > options.unrest) flag("not at rest");
  if (jumped) flag("solved anew from rest");
}

// Reads what a frame tells off an Equilibrium.
class Reader {
 public:
  explicit Reader(const mjModel* m) : posture_(m) {
    const int discs = posture_.levels();
    level_of_tendon_.assign(m->ntendon, -1);
    for (int i = 0; i < m->ntendon; i++) {
      const std::string name = nameOf(m, mjOBJ_TENDON, i);
      for (int disc = 0; disc < discs; disc++) {
        const std::string end = std::string("_") + torso_discName(m, disc);
        if (name.size() > end.size() &&
            name.compare(name.size() - end.size(), end.size(), end) == 0)
          level_of_tendon_[i] = disc;
      }
    }
    facets_ = torsoOf(m, "torso").nfacet;
  }

  RetrofitFrame read(Equilibrium& torso, const std::vector<Isometry3d>& targets) const {
    const mjModel* m = torso.model();
    mjData* d = torso.data();
    RetrofitFrame frame;
    for (std::size_t i = 0; i < targets.size(); i++) {
      const Isometry3d error = targets[i].inverse() * torso.pose(torso.heldBodies()[i]);
      frame.position_error = std::max(frame.position_error, error.translation().norm());
      frame.rotation_error =
          std::max(frame.rotation_error, Eigen::AngleAxisd(error.linear()).angle());
    }
    for (const Quaterniond& turn : posture_.turns(d)) frame.turns.push_back(rotationVector(turn));
    frame.ligaments.assign(posture_.levels(), 0);
    for (int i = 0; i < posture_.levels(); i++) {
      frame.pressures.push_back(torso_discPressure(m, d, i));
    }
    for (int i = 0; i < m->ntendon; i++) {
      if (level_of_tendon_[i] < 0) continue;
      double& largest = frame.ligaments[level_of_tendon_[i]];
      largest = std::max<double>(largest, torso_ligamentTension(m, d, i));
    }
    for (int i = 0; i < facets_; i++) {
      mjtNum force[3];
      torso_facetForce(m, d, i, force);
      frame.facets.push_back(mju_norm3(force));
    }
    return frame;
  }

 private:
  Posture posture_;
  std::vector<int> level_of_tendon_;
  int facets_ = 0;
};

}  // namespace

RetrofitModels::RetrofitModels(const BodyMjcf& body, const SpineParts& parts)
    : human(body.human()), torso(body.torsoOnHolds(parts)) {}

RetrofitResult retrofit(const RetrofitModels& models, const HeldMotion& motion,
                        const RetrofitOptions& options,
                        const std::function<void(double)>& progress) {
  const double start = threadSeconds();
  const Poses poses(motion);
  const mjModel* m = models.human.get();
  RetrofitResult result;
  result.name = motion.name;
  result.rate = motion.rate;
  result.nq = m->nq;
  Equilibrium torso(models.torso.get(), m, options.momentum);
  const Reader reader(models.torso.get());
  const DataPtr human = makeData(m);

  const auto targets = [&](std::size_t frame) {
    const Isometry3d to_pelvis = poses.at(frame, "pelvis").inverse();
    std::vector<Isometry3d> result = torso.restPoses();
    for (std::size_t i = 0; i < kHeldBones.size(); i++) {
      if (poses.has(kHeldBones[i])) result[i] = to_pelvis * poses.at(frame, kHeldBones[i]);
    }
    return result;
  };
  Course course(torso, options, motion.rate);
  const std::size_t frames = motion.frames();
  for (std::size_t frame = 0; frame < frames; frame++) {
    const auto goal = targets(frame);
    const Vector3d up =
        poses.at(frame, "pelvis").linear().transpose() * (options.weight * Vector3d::UnitZ());
    const bool jumped = !course.follow(goal, up);
    torso.forward();
    result.frames.push_back(reader.read(torso, goal));
    RetrofitFrame& now = result.frames.back();
    now.unrest = course.unrest();
    if (frame < motion.flags.size()) now.flags = motion.flags[frame];
    addFlags(options, jumped, &now);
    assemble(m, human.get(), torso, poses, frame);
    result.qpos.insert(result.qpos.end(), human->qpos, human->qpos + m->nq);
    if (progress) progress(static_cast<double>(frame + 1) / frames);
  }
  result.core_seconds = threadSeconds() - start;
  return result;
}

}  // namespace torso::tools
