// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// A task of optimal control as its file (JSON, tasks/*.json) says it: what the body starts from,
// what drives it, and what that costs. Axes x forward, y left, z up.

#include <array>
#include <map>
#include <string>
#include <vector>

namespace torso::tools {

// One factor of a term of the cost: |q - from|^power, with the sign of q - from if `is_signed` or
// if the power is 1.
struct CostFactor {
  enum class Of {
    kCom,          // centre of mass of all that moves [m]
    kComVelocity,  // its velocity [m/s]
    kPosition,     // of a body's origin [m]
    kVelocity,     // of a body's centre of mass [m/s]
    kSensor        // an entry of a sensor, in the sensor's unit
  };
  Of of;
  std::string name;         // of the body or the sensor
  int axis = 0;             // x, y, z: 0, 1, 2; entry of the sensor
  double from = 0;          // what is taken off q
  bool from_start = false;  // that is q at the start
  double power = 1;
  bool is_signed = false;
  std::string where;  // file, line and column, for messages
};

// weight * product of the factors, at the end or summed over the steps.
struct CostTerm {
  bool at_end;
  double weight;
  std::vector<CostFactor> factors;
};

// Servos that are driven together by one knob (or each by its own). A knob is a share of each
// servo's way from its target at the start to the upper (+1) or lower (-1) end of its control
// range.
struct Action {
  std::string name;
  std::vector<std::string> actuators;  // names with wildcards * and ?
  double noise;                        // standard deviation of the knob's noise
  bool each = false;                   // a knob for each servo
  bool optional = false;               // left out where the model has none of these servos
  std::string where;
};

// Where servos aim at the start, as a knob.
struct StartTarget {
  std::vector<std::string> actuators;
  double share;
  bool optional = false;
  std::string where;
};

struct TaskStart {
  std::string keyframe;                                // "": qpos0
  std::array<double, 3> shift{};                       // of all free bodies [m]
  std::map<std::string, std::array<double, 3>> turns;  // of ball joints, rotation vectors [rad]
  std::vector<StartTarget> targets;
  double settle = 0;  // time to come to rest there, with strong damping [s]
  std::string where;
};

struct Task {
  std::string name, path, description;
  std::string scene;  // path of MJCF that is added to the model, "": nothing
  TaskStart start;
  std::vector<Action> actions;
  std::vector<CostTerm> cost;
  double sum_rate;  // a sum has so many summands per second, whatever the time step [Hz]

  // What the command's options may change.
  double horizon, timestep, knot_interval;  // [s]
  int iterations, samples;
  double temperature, noise, noise_decay;  // as of MppiOptions
};

// Reads a task file. Throws Error "<path>:<line>:<column>: <key>: what is wrong".
Task readTask(const std::string& path);

// The task files that come with the project, by name.
std::map<std::string, std::string> shippedTasks();

// readTask of a shipped task by name, or of a file whose name ends in .json. Throws Error that
// lists the tasks there are.
Task findTask(const std::string& name);

}  // namespace torso::tools
