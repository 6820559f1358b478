// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/control_problem.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <thread>

#include "tools/error.h"

namespace torso::tools {
namespace {

// Share of its velocity that a body keeps in a step of 5 ms while it settles: it sinks by 0.4 m/s.
constexpr double kSettling = 0.9;

std::string namesOf(const mjModel* m, mjtObj type, int n) {
  std::vector<std::string> names;
  for (int i = 0; i < n; i++) names.push_back(nameOf(m, type, i));
  constexpr std::size_t kShown = 40;
  const std::size_t all = names.size();
  names.resize(std::min(all, kShown));
  return fmt::format("{}{}", fmt::join(names, ", "), all > kShown ? ", ..." : "");
}

// The control at a share (-1 to 1) of the way from a target to the ends of the range.
double shareOfRange(const mjModel* m, int actuator, double from, double share) {
  const mjtNum* range = m->actuator_ctrlrange + 2 * actuator;
  return share > 0 ? from + share * (range[1] - from) : from - share * (range[0] - from);
}

// Ids of the actuators that match any of the names with wildcards. Throws Error "<where>: ..." if
// one of these matches none, unless that is optional, or if an actuator has no range.
std::set<int> matching(const mjModel* m, const std::vector<std::string>& patterns, bool optional,
                       const std::string& where, const std::string& path) {
  std::set<int> found;
  for (const std::string& pattern : patterns) {
    bool any = false;
    for (int i = 0; i < m->nu; i++) {
      const std::string name = nameOf(m, mjOBJ_ACTUATOR, i);
      if (fnmatch(pattern.c_str(), name.c_str(), 0) != 0) continue;
      if (!m->actuator_ctrllimited[i]) {
        throw Error(
            fmt::format("{}: actuator '{}' has no ctrlrange to take shares of", where, name));
      }
      any = true;
      found.insert(i);
    }
    if (!any && !optional) {
      throw Error(fmt::format("{}: {} has no actuator '{}'; it has {}", where, path, pattern,
                              namesOf(m, mjOBJ_ACTUATOR, m->nu)));
    }
  }
  return found;
}

}  // namespace

// What the callbacks share.
struct ControlProblem::Batch {
  const ControlProblem& problem;
  const std::vector<std::vector<double>>& parameters;
  const std::function<void(double)>& progress;
  std::thread::id caller = std::this_thread::get_id();
  std::atomic<int> done{0};
  std::vector<double> costs = std::vector<double>(parameters.size());
};

ControlProblem::ControlProblem(mjModel* m, const Task& task, const std::string& path, int threads)
    : m_(m) {
  m->opt.timestep = task.timestep;
  steps_ = static_cast<int>(std::lround(task.horizon / task.timestep));
  if (steps_ < 1) {
    throw Error(fmt::format("{}: the horizon of {} s is shorter than a step of {} s", task.path,
                            task.horizon, task.timestep));
  }
  points_ = std::max(1, static_cast<int>(std::lround(task.horizon / task.knot_interval)));
  sum_step_ = task.timestep * task.sum_rate;
  for (int i = 0; i < threads; i++) data_.push_back(makeData(m));

  for (int step = 0; step < steps_; step++) {
    const double place = static_cast<double>(step) / steps_ * points_;
    const int first = std::min(static_cast<int>(place), points_ - 1);
    const double s = place - first, r = 1 - s;
    first_point_.push_back(first - 3);  // three control points of zero come before
    weights_.push_back({r * r * r / 6, (3 * s * s * s - 6 * s * s + 4) / 6,
                        (-3 * s * s * s + 3 * s * s + 3 * s + 1) / 6, s * s * s / 6});
  }
  mjData* d = data_[0].get();
  bindStart(task, path, d);
  bindActions(task, path);
  bindCost(task, path, d);
}

void ControlProblem::bindActions(const Task& task, const std::string& path) {
  for (const Action& action : task.actions) {
    const std::set<int> found = matching(m_, action.actuators, action.optional, action.where, path);
    if (action.each) {
      for (const int id : found) {
        knobs_.push_back({nameOf(m_, mjOBJ_ACTUATOR, id), {id}, action.noise});
      }
    } else if (!found.empty()) {
      knobs_.push_back({action.name, {found.begin(), found.end()}, action.noise});
    }
  }
  if (knobs_.empty()) {
    throw Error(fmt::format("{}: {} has none of the actuators of its actions", task.path, path));
  }
}

void ControlProblem::bindStart(const Task& task, const std::string& path, mjData* d) {
  const TaskStart& start = task.start;
  const int key = keyframeId(m_, start.keyframe, path);
  if (key < 0) {
    mj_resetData(m_, d);
  } else {
    mj_resetDataKeyframe(m_, d, key);
    d->time = 0;
  }
  for (int j = 0; j < m_->njnt; j++) {
    if (m_->jnt_type[j] == mjJNT_FREE) {
      mju_addTo3(d->qpos + m_->jnt_qposadr[j], start.shift.data());
    }
  }
  for (const auto& [name, turn] : start.turns) {
    const int joint = mj_name2id(m_, mjOBJ_JOINT, name.c_str());
    if (joint < 0 || m_->jnt_type[joint] != mjJNT_BALL) {
      throw Error(fmt::format("{}: turns_deg: {} has no ball joint '{}'", start.where, path, name));
    }
    mjtNum* q = d->qpos + m_->jnt_qposadr[joint];
    mju_quatIntegrate(q, turn.data(), 1);
  }
  for (const StartTarget& target : start.targets) {
    for (const int id : matching(m_, target.actuators, target.optional, target.where, path)) {
      d->ctrl[id] = shareOfRange(m_, id, d->ctrl[id], target.share);
    }
  }
  targets_.assign(d->ctrl, d->ctrl + m_->nu);
  settle(task, d);
}

void ControlProblem::settle(const Task& task, mjData* d) {
  const double kept = std::pow(kSettling, m_->opt.timestep / 0.005);
  const long steps = std::lround(task.start.settle / m_->opt.timestep);
  for (long step = 0; step < steps; step++) {
    mj_step(m_, d);
    const std::string warning = firstWarning(d);
    if (!warning.empty()) {
      throw Error(fmt::format("{}: the start does not settle: {} (after {:.3f} s)",
                              task.start.where, warning, d->time));
    }
    mju_scl(d->qvel, d->qvel, kept, m_->nv);
  }
  d->time = 0;
  mju_zero(d->qvel, m_->nv);
  start_.resize(torso_stateSize(m_, TORSO_STATE_FULL));
  torso_getState(m_, d, start_.data(), TORSO_STATE_FULL);
  mj_forward(m_, d);
  mj_subtreeVel(m_, d);
}

void ControlProblem::bindCost(const Task& task, const std::string& path, mjData* d) {
  using Of = CostFactor::Of;
  for (int b = 1; b < m_->nbody; b++) {
    if (m_->body_weldid[b] == 0) continue;
    moving_.push_back(b);
    moving_mass_ += m_->body_mass[b];
  }
  if (!(moving_mass_ > 0)) throw Error(path + ": nothing moves in this model");
  for (const CostTerm& term : task.cost) {
    Term bound{term.at_end, term.weight, {}};
    for (const CostFactor& f : term.factors) {
      int id = 0, axis = f.axis;
      if (f.of == Of::kPosition || f.of == Of::kVelocity) {
        id = mj_name2id(m_, mjOBJ_BODY, f.name.c_str());
        if (id < 0) {
          throw Error(fmt::format("{}: {} has no body '{}'; it has {}", f.where, path, f.name,
                                  namesOf(m_, mjOBJ_BODY, m_->nbody)));
        }
      } else if (f.of == Of::kSensor) {
        const int sensor = mj_name2id(m_, mjOBJ_SENSOR, f.name.c_str());
        if (sensor < 0) {
          throw Error(fmt::format("{}: {} has no sensor '{}'; it has {}", f.where, path, f.name,
                                  m_->nsensor ? namesOf(m_, mjOBJ_SENSOR, m_->nsensor) : "none"));
        }
        if (f.axis >= m_->sensor_dim[sensor]) {
          throw Error(fmt::format("{}: sensor '{}' has no entry {}, but 0 to {}", f.where, f.name,
                                  f.axis, m_->sensor_dim[sensor] - 1));
        }
        id = m_->sensor_adr[sensor];
      }
      const double from = f.from_start ? quantity(d, f.of, id, axis) : f.from;
      bound.factors.push_back({f.of, id, axis, from, f.power, f.is_signed || f.power == 1});
      needs_velocity_ |= !term.at_end && (f.of == Of::kComVelocity || f.of == Of::kVelocity);
    }
    terms_.push_back(bound);
  }
}

double ControlProblem::quantity(const mjData* d, CostFactor::Of of, int id, int axis) const {
  switch (of) {
    case CostFactor::Of::kCom: {
      double sum = 0;
      for (const int b : moving_) sum += m_->body_mass[b] * d->xipos[3 * b + axis];
      return sum / moving_mass_;
    }
    case CostFactor::Of::kComVelocity:
      return d->subtree_linvel[axis] * m_->body_subtreemass[0] / moving_mass_;
    case CostFactor::Of::kPosition:
      return d->xpos[3 * id + axis];
    case CostFactor::Of::kVelocity: {
      mjtNum velocity[6];
      mj_objectVelocity(m_, d, mjOBJ_BODY, id, velocity, 0);
      return velocity[3 + axis];
    }
    case CostFactor::Of::kSensor:
      return d->sensordata[id + axis];
  }
  return NAN;
}

double ControlProblem::termsAt(const mjData* d, bool at_end) const {
  double cost = 0;
  for (const Term& term : terms_) {
    if (term.at_end != at_end) continue;
    double product = term.weight * (at_end ? 1 : sum_step_);
    for (const Factor& f : term.factors) {
      const double x = quantity(d, f.of, f.id, f.axis) - f.from;
      const double magnitude = f.power == 1 ? std::abs(x) : std::pow(std::abs(x), f.power);
      product *= f.is_signed && x < 0 ? -magnitude : magnitude;
    }
    cost += product;
  }
  return cost;
}

void ControlProblem::setControls(const std::vector<double>& parameters, int step,
                                 mjtNum* ctrl) const {
  mju_zero(ctrl, m_->nu);  // shares at first
  for (std::size_t k = 0; k < knobs_.size(); k++) {
    const double* points = parameters.data() + k * static_cast<std::size_t>(points_);
    double share = 0;
    for (int i = 0; i < 4; i++) {
      const int point = first_point_[step] + i;
      if (point >= 0) share += weights_[step][i] * points[point];
    }
    for (const int id : knobs_[k].actuators) ctrl[id] += share;
  }
  for (int i = 0; i < m_->nu; i++) {
    ctrl[i] = shareOfRange(m_, i, targets_[i], std::clamp(ctrl[i], -1., 1.));
  }
}

void ControlProblem::input(const mjModel*, mjData* d, int trajectory, int step, void* user) {
  const auto* batch = static_cast<const Batch*>(user);
  batch->problem.setControls(batch->parameters[trajectory], step, d->ctrl);
}

mjtNum ControlProblem::stepCost(const mjModel* m, mjData* d, int, int step, void* user) {
  auto* batch = static_cast<Batch*>(user);
  const ControlProblem& problem = batch->problem;
  // d has the positions of before the step.
  if (problem.needs_velocity_) mj_subtreeVel(m, d);
  double cost = problem.termsAt(d, false);
  if (step == problem.steps_ - 1) {
    mj_forward(m, d);
    mj_subtreeVel(m, d);
    cost += problem.termsAt(d, false) + problem.termsAt(d, true);
    batch->done++;
    if (batch->progress && std::this_thread::get_id() == batch->caller) {
      batch->progress(static_cast<double>(batch->done) /
                      static_cast<double>(batch->parameters.size()));
    }
  }
  return cost;
}

void ControlProblem::roll(Batch* batch, const int* cancel, mjtNum* states) const {
  torsoRollout r;
  torso_defaultRollout(&r);
  r.ntrajectory = static_cast<int>(batch->parameters.size());
  r.nstep = steps_;
  r.initial_state = start_.data();
  r.ninitial = 1;
  r.input = input;
  r.step_cost = stepCost;
  r.cost = batch->costs.data();
  r.state = states;
  std::vector<int> status(batch->parameters.size());
  r.status = status.data();
  r.user = batch;
  r.cancel = cancel;
  std::vector<mjData*> data;
  for (const DataPtr& d : data_) data.push_back(d.get());
  if (torso_rollout(m_, data.data(), static_cast<int>(data.size()), &r) < 0) {
    char error[500];
    torso_lastError(error, sizeof error);
    throw Error(error);
  }
  for (std::size_t i = 0; i < status.size(); i++) {
    if (status[i] == TORSO_CANCELLED) throw Cancelled();
    if (status[i] != TORSO_OK) batch->costs[i] = INFINITY;
  }
  takeWarnings();  // a failed sample has its infinite cost
}

std::vector<double> ControlProblem::sigma() const {
  std::vector<double> all;
  for (const Knob& knob : knobs_) all.insert(all.end(), points_, knob.noise);
  return all;
}

std::vector<std::string> ControlProblem::knobNames() const {
  std::vector<std::string> names;
  for (const Knob& knob : knobs_) names.push_back(knob.name);
  return names;
}

std::vector<double> ControlProblem::costs(const std::vector<std::vector<double>>& parameters,
                                          const std::function<void(double)>& progress,
                                          const int* cancel) const {
  Batch batch{*this, parameters, progress};
  roll(&batch, cancel, nullptr);
  return batch.costs;
}

ControlProblem::Trajectory ControlProblem::trajectory(const std::vector<double>& parameters) const {
  const std::vector<std::vector<double>> one = {parameters};
  const std::function<void(double)> no_progress;
  Batch batch{*this, one, no_progress};
  const std::size_t size = torso_stateSize(m_, TORSO_STATE_PHYSICS);
  std::vector<mjtNum> states(size * steps_);
  roll(&batch, nullptr, states.data());

  Trajectory result{
      batch.costs[0], {}, std::vector<double>(static_cast<std::size_t>(steps_) * m_->nu)};
  result.motion.rate = 1 / m_->opt.timestep;
  result.motion.columns = qposColumns(m_);
  result.motion.qpos.assign(start_.begin() + 1, start_.begin() + 1 + m_->nq);
  for (int step = 0; step < steps_; step++) {
    const auto qpos = states.begin() + static_cast<std::ptrdiff_t>(step * size) + 1;
    result.motion.qpos.insert(result.motion.qpos.end(), qpos, qpos + m_->nq);
    setControls(parameters, step, result.controls.data() + static_cast<std::size_t>(step) * m_->nu);
  }
  return result;
}

}  // namespace torso::tools
