// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// A task on a model: its start state, what a vector of parameters does to the controls, and what
// the trajectory that follows costs.

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "tools/motion_file.h"
#include "tools/mujoco_support.h"
#include "tools/task.h"

namespace torso::tools {

class ControlProblem {
 public:
  // m outlives the object; its time step becomes the task's. path: of the model, for messages.
  // Settles the start. Throws Error that names what the model lacks, or why it does not settle.
  ControlProblem(mjModel* m, const Task& task, const std::string& path, int threads);

  // A knob over time is a uniform cubic B-spline with one control point, which is a parameter, per
  // knot interval, after three of zero: smooth, and at rest at the start. Parameters are those of
  // the first knob, then of the second, and so on; between -1 and 1 a knob stays so too.
  std::size_t size() const { return knobs_.size() * static_cast<std::size_t>(points_); }
  // Standard deviations of the noise (size()).
  std::vector<double> sigma() const;

  // Cost of each of these parameter vectors, infinite for a rollout that failed; rolled out by
  // torso_rollout, on all threads, the same bits for any number. progress, which may be empty, is
  // called on the calling thread with the share that is done. Throws Error; Cancelled if *cancel
  // became nonzero.
  struct Cancelled {};
  std::vector<double> costs(const std::vector<std::vector<double>>& parameters,
                            const std::function<void(double)>& progress, const int* cancel) const;

  // The trajectory of one of them, all of its steps and the start, and the controls of each step.
  struct Trajectory {
    double cost;
    Motion motion;
    std::vector<double> controls;  // (steps x nu)
  };
  Trajectory trajectory(const std::vector<double>& parameters) const;

  int steps() const { return steps_; }
  double simulatedSeconds() const { return steps_ * m_->opt.timestep; }  // of one rollout
  std::vector<std::string> knobNames() const;

 private:
  struct Knob {
    std::string name;
    std::vector<int> actuators;
    double noise;
  };
  struct Factor {
    CostFactor::Of of;
    int id, axis;  // body, or first entry of the sensor
    double from, power;
    bool is_signed;
  };
  struct Term {
    bool at_end;
    double weight;
    std::vector<Factor> factors;
  };
  struct Batch;

  void bindActions(const Task& task, const std::string& path);
  void bindStart(const Task& task, const std::string& path, mjData* d);
  void settle(const Task& task, mjData* d);
  void bindCost(const Task& task, const std::string& path, mjData* d);
  double quantity(const mjData* d, CostFactor::Of of, int id, int axis) const;
  double termsAt(const mjData* d, bool at_end) const;
  void setControls(const std::vector<double>& parameters, int step, mjtNum* ctrl) const;
  static void input(const mjModel* m, mjData* d, int trajectory, int step, void* user);
  static mjtNum stepCost(const mjModel* m, mjData* d, int trajectory, int step, void* user);
  void roll(Batch* batch, const int* cancel, mjtNum* states) const;

  mjModel* m_;
  int steps_, points_;
  double sum_step_;  // summands for each step
  bool needs_velocity_ = false;
  std::vector<Knob> knobs_;
  std::vector<Term> terms_;
  std::vector<int> moving_;       // bodies that are not fixed to the world
  double moving_mass_ = 0;        // [kg]
  std::vector<mjtNum> start_;     // TORSO_STATE_FULL
  std::vector<mjtNum> targets_;   // (nu) at the start
  std::vector<int> first_point_;  // of each step, and the four weights from there
  std::vector<std::array<double, 4>> weights_;
  std::vector<DataPtr> data_;  // of the threads
};

}  // namespace torso::tools
