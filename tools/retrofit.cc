// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/retrofit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plugin/mujoco_torso.h"
#include "tools/clock.h"
#include "tools/course_limit.h"
#include "tools/equilibrium.h"
#include "tools/error.h"
#include "tools/graft_xml.h"
#include "tools/posture.h"
#include "tools/retrofit_course.h"
#include "tools/smoothness.h"

namespace torso::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// Second difference of a joint's turn over a frame that is let be beside what the input explains.
constexpr double kLeastLimit = 0.2 * EIGEN_PI / 180;  // [rad]
// Of what is explained for two joints in a row, the upper neck's or a shoulder girdle's, the part
// that each of them is let have.
constexpr double kOneOfTwo = 0.6;
// Of the time of a retrofit; rough.
constexpr double kFreeShare = 0.6;

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

HeldFrame heldFrame(const Poses& poses, std::size_t frame, const std::vector<Isometry3d>& at_rest,
                    double weight) {
  const Isometry3d to_pelvis = poses.at(frame, "pelvis").inverse();
  HeldFrame held = {at_rest, to_pelvis.linear() * (weight * Vector3d::UnitZ()), {}};
  for (std::size_t i = 0; i < kHeldBones.size(); i++) {
    if (poses.has(kHeldBones[i])) held.poses[i] = to_pelvis * poses.at(frame, kHeldBones[i]);
  }
  return held;
}

// Makes the leads, which are the turns of the joints in equilibrium, as smooth as the motion.
void smoothLead(const HeldMotion& motion, const std::vector<std::string>& joints,
                std::vector<HeldFrame>* held) {
  const ExplainedJumps explained(motion);
  const std::size_t frames = held->size();
  for (std::size_t joint = 0; joint < joints.size(); joint++) {
    const double share = JointLead::isOneOfTwo(joints[joint]) ? kOneOfTwo : 1;
    Eigen::MatrixXd course(frames, 3);
    Eigen::VectorXd limit(frames);
    for (std::size_t t = 0; t < frames; t++) {
      course.row(t) = (*held)[t].lead.col(joint).transpose();
      limit[t] = kLeastLimit + share * explained.of(joints[joint])[t];
    }
    course = limitSecondDifferences(course, limit);
    for (std::size_t t = 0; t < frames; t++) {
      (*held)[t].lead.col(joint) = course.row(t).transpose();
    }
  }
}

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
    : human(body.human()),
      torso(body.torsoOnHolds(parts)),
      led_torso(JointLead::ledModel(torso.get())) {}

RetrofitResult retrofit(const RetrofitModels& models, const HeldMotion& motion,
                        const RetrofitOptions& options,
                        const std::function<void(double)>& progress) {
  const double start = threadSeconds();
  const Poses poses(motion);
  const mjModel* m = models.human.get();
  const std::size_t frames = motion.frames();
  RetrofitResult result;
  result.name = motion.name;
  result.rate = motion.rate;
  result.nq = m->nq;

  // Frame by frame.
  Equilibrium free(models.torso.get(), m, options.momentum);
  const auto least = [&](double steps) {
    return std::max(2, static_cast<int>(std::lround(steps / motion.rate)));
  };
  std::vector<HeldFrame> held;
  std::vector<bool> lost;
  std::vector<mjtNum> first;
  Course free_course(free, least(options.steps), options.unrest);
  for (std::size_t frame = 0; frame < frames; frame++) {
    held.push_back(heldFrame(poses, frame, free.restPoses(), options.weight));
    lost.push_back(!free_course.follow(held.back()));
    held.back().lead = free.turns();
    if (frame == 0) first = free.state();
    if (progress) progress(kFreeShare * static_cast<double>(frame + 1) / frames);
  }

  // Over time.
  const mjModel* torso = (options.over_time ? models.led_torso : models.torso).get();
  if (options.over_time) {
    smoothLead(motion, JointLead(torso).names(), &held);
  } else {
    for (HeldFrame& frame : held) frame.lead = {};
  }
  Equilibrium led(torso, m, options.momentum);
  led.setState(first);
  Course course(led, least(options.led_steps), options.unrest);
  course.startAt(held.front());
  const Reader reader(torso);
  const DataPtr human = makeData(m);
  for (std::size_t frame = 0; frame < frames; frame++) {
    const bool jumped = !course.follow(held[frame]);
    led.forward();
    result.frames.push_back(reader.read(led, held[frame].poses));
    RetrofitFrame& now = result.frames.back();
    now.unrest = course.unrest();
    if (frame < motion.flags.size()) now.flags = motion.flags[frame];
    addFlags(options, jumped || lost[frame], &now);
    assemble(m, human.get(), led, poses, frame);
    result.qpos.insert(result.qpos.end(), human->qpos, human->qpos + m->nq);
    if (progress) {
      progress(kFreeShare + (1 - kFreeShare) * static_cast<double>(frame + 1) / frames);
    }
  }
  result.core_seconds = threadSeconds() - start;
  return result;
}

}  // namespace torso::tools
