// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/fall.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/control_option.h"
#include "tools/error.h"
#include "tools/impact.h"
#include "tools/rollout.h"

namespace torso::tools {
namespace {

using Eigen::Vector3d;

bool ofWorld(const mjModel* m, int geom) { return m->body_weldid[m->geom_bodyid[geom]] == 0; }

// Takes what the last mj_step computed: forces over that step, velocities at its start.
class Recorder {
 public:
  Recorder(const mjModel* m, const std::string& path, Fall& fall)
      : m_(m), head_(mj_name2id(m, mjOBJ_BODY, "head")), fall_(fall) {
    if (head_ < 0) throw Error(path + ": no body is called 'head'");
  }

  void add(const mjData* d) {
    Vector3d sum = Vector3d::Zero();
    for (int i = 0; i < d->ncon; i++) {
      const mjContact& contact = d->contact[i];
      const bool first = ofWorld(m_, contact.geom1), second = ofWorld(m_, contact.geom2);
      if (contact.efc_address < 0 || first == second) continue;
      mjtNum local[6], world[3];
      mj_contactForce(m_, d, i, local);
      mju_rotVecMatT(world, local, contact.frame);  // on the body of geom2
      sum += (first ? 1 : -1) * Vector3d(world);
      const double start = d->time - m_->opt.timestep;
      if (fall_.touch < 0) fall_.touch = start;
      const int body = m_->geom_bodyid[first ? contact.geom2 : contact.geom1];
      if (fall_.head_touch < 0 && m_->body_weldid[body] == m_->body_weldid[head_]) {
        fall_.head_touch = start;
      }
    }
    fall_.floor_force.push_back(sum);
    mjtNum v[6];
    mj_objectVelocity(m_, d, mjOBJ_BODY, head_, v, 0);
    const Vector3d velocity(v + 3);
    if (fall_.floor_force.size() > 1) {
      const Vector3d acceleration =
          (velocity - velocity_) / m_->opt.timestep - Vector3d(m_->opt.gravity);
      fall_.head_acceleration.push_back(acceleration.norm() / kStandardGravity);
    }
    velocity_ = velocity;
  }

 private:
  const mjModel* m_;
  int head_;
  Fall& fall_;
  Vector3d velocity_ = Vector3d::Zero();
};

// Of the first samples, at most `count`.
FallPeaks peaks(const Fall& fall, std::size_t count) {
  const auto largest = [](const std::vector<double>& values) {
    return values.empty() ? 0 : *std::max_element(values.begin(), values.end());
  };
  std::vector<double> force, head = fall.head_acceleration;
  for (const Vector3d& f : fall.floor_force) force.push_back(f.norm());
  force.resize(std::min(force.size(), count));
  head.resize(std::min(head.size(), count));
  return {largest(force), largest(head), exceededFor(head, fall.interval),
          headInjuryCriterion(head, fall.interval).hic};
}

}  // namespace

Fall fall(const mjModel* model, const std::string& path, const FallOptions& options,
          std::uint64_t seed) {
  RolloutOptions rollout;
  rollout.control = Control::kRandom;
  rollout.amplitude = options.amplitude;
  rollout.lift = options.height;
  checkDrop(model, rollout, path);
  const ModelPtr m(mj_copyModel(nullptr, model));
  if (!m) throw Error("not enough memory for the model");
  configureModel(m.get(), rollout, 1 / options.rate);
  const DataPtr d = makeData(m.get());
  startRun(m.get(), d.get(), rollout);
  ControlSignal controls(m.get(), d.get(), rollout, seed);

  Fall result;
  result.seed = seed;
  result.interval = m->opt.timestep;
  result.weight = mj_getTotalmass(m.get()) * mju_norm3(m->opt.gravity);
  Recorder recorder(m.get(), path, result);
  const auto steps = static_cast<std::int64_t>(std::lround(options.seconds * options.rate));
  // The time of the touch, in free fall.
  const double expected = std::sqrt(2 * options.height / mju_norm3(m->opt.gravity));
  for (std::int64_t step = 0; step <= steps; step++) {
    controls.apply(m.get(), d.get(), step);
    const std::size_t shown = result.frames.size();
    const double touch = result.touch < 0 ? expected : result.touch;
    if (shown < options.frame_times.size() && d->time >= touch + options.frame_times[shown]) {
      result.frames.push_back(makeData(m.get()));
      mj_copyData(result.frames.back().get(), m.get(), d.get());
    }
    mj_step(m.get(), d.get());
    const std::string warning = firstWarning(d.get());
    if (!warning.empty()) {
      throw Error(fmt::format("{}: seed {} at {:.3f} s: {}", path, seed, d->time, warning));
    }
    recorder.add(d.get());
  }
  result.floor_force.pop_back();  // of the step whose end nobody saw
  for (const DataPtr& frame : result.frames) mj_forward(m.get(), frame.get());
  return result;
}

FallPeaks peaksOf(const Fall& fall) { return peaks(fall, std::numeric_limits<std::size_t>::max()); }

FallPeaks landingPeaksOf(const Fall& fall) {
  if (fall.touch < 0) return {};
  return peaks(fall, static_cast<std::size_t>((fall.touch + kLanding) / fall.interval));
}

}  // namespace torso::tools
