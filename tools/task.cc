// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/task.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "tools/error.h"
#include "tools/located_json.h"
#include "tools/paths.h"

namespace torso::tools {
namespace {

namespace fs = std::filesystem;

constexpr double kDegree = M_PI / 180;

std::array<double, 3> vector3(const LocatedValue& json, double unit) {
  const std::vector<LocatedValue> elements = json.elements();
  if (elements.size() != 3) json.fail("not a list of three numbers");
  std::array<double, 3> v{};
  for (std::size_t i = 0; i < 3; i++) v[i] = unit * elements[i].number();
  return v;
}

int axisOf(const LocatedValue& json, bool sensor) {
  if (sensor) return json.integer(0, 1000);
  const std::string axis = json.text();
  if (axis != "x" && axis != "y" && axis != "z") json.fail("neither \"x\" nor \"y\" nor \"z\"");
  return axis[0] - 'x';
}

CostFactor readFactor(const LocatedValue& json) {
  using Of = CostFactor::Of;
  static const std::map<std::string, Of> kKinds = {{"com", Of::kCom},
                                                   {"com_velocity", Of::kComVelocity},
                                                   {"position", Of::kPosition},
                                                   {"velocity", Of::kVelocity},
                                                   {"sensor", Of::kSensor}};
  json.checkKeys({"of", "body", "sensor", "axis", "entry", "from", "power", "signed"});
  const auto kind = kKinds.find(json.at("of").text());
  if (kind == kKinds.end()) {
    json.at("of").fail("not com, com_velocity, position, velocity or sensor");
  }
  CostFactor factor;
  factor.of = kind->second;
  const bool sensor = factor.of == Of::kSensor;
  const bool body = factor.of == Of::kPosition || factor.of == Of::kVelocity;
  if (sensor) factor.name = json.at("sensor").text();
  if (body) factor.name = json.at("body").text();
  for (const auto& [key, fits] : {std::pair("sensor", sensor), std::pair("body", body),
                                  std::pair("entry", sensor), std::pair("axis", !sensor)}) {
    if (!fits && json.has(key)) json.at(key).fail("has no meaning for what the factor is of");
  }
  if (!sensor) {
    factor.axis = axisOf(json.at("axis"), false);
  } else if (json.has("entry")) {
    factor.axis = axisOf(json.at("entry"), true);
  }
  if (json.has("from")) {
    const LocatedValue from = json.at("from");
    factor.from_start = from.isText();
    if (!factor.from_start) {
      factor.from = from.number();
    } else if (from.text() != "start") {
      from.fail("neither a number nor \"start\"");
    }
  }
  if (json.has("power")) factor.power = json.at("power").number(0.1, 10);
  if (json.has("signed")) factor.is_signed = json.at("signed").flag();
  factor.where = (body ? json.at("body") : sensor ? json.at("sensor") : json.at("of")).where();
  return factor;
}

CostTerm readTerm(const LocatedValue& json) {
  json.checkKeys({"weight", "when", "factors", "comment"});
  CostTerm term;
  const std::string when = json.at("when").text();
  if (when != "end" && when != "sum") json.at("when").fail("neither \"end\" nor \"sum\"");
  term.at_end = when == "end";
  term.weight = json.at("weight").number();
  for (const LocatedValue& factor : json.at("factors").elements()) {
    term.factors.push_back(readFactor(factor));
  }
  if (term.factors.empty()) json.at("factors").fail("there is none");
  return term;
}

std::vector<std::string> patterns(const LocatedValue& json) {
  std::vector<std::string> all;
  for (const LocatedValue& pattern : json.elements()) all.push_back(pattern.text());
  if (all.empty()) json.fail("there is none");
  return all;
}

Action readAction(const LocatedValue& json) {
  json.checkKeys({"name", "actuators", "noise", "each", "optional"});
  Action action;
  action.name = json.at("name").text();
  action.actuators = patterns(json.at("actuators"));
  action.noise = json.at("noise").number(0, 1);
  if (json.has("each")) action.each = json.at("each").flag();
  if (json.has("optional")) action.optional = json.at("optional").flag();
  action.where = json.at("actuators").where();
  return action;
}

TaskStart readStart(const LocatedValue& json) {
  json.checkKeys({"keyframe", "shift_m", "turns_deg", "targets", "settle_s"});
  TaskStart start;
  start.where = json.where();
  if (json.has("keyframe")) start.keyframe = json.at("keyframe").text();
  if (json.has("shift_m")) start.shift = vector3(json.at("shift_m"), 1);
  if (json.has("settle_s")) start.settle = json.at("settle_s").number(0, 60);
  if (json.has("turns_deg")) {
    for (const auto& [joint, turn] : json.at("turns_deg").members()) {
      start.turns[joint] = vector3(turn, kDegree);
    }
  }
  if (json.has("targets")) {
    for (const LocatedValue& target : json.at("targets").elements()) {
      target.checkKeys({"actuators", "target", "optional"});
      start.targets.push_back({patterns(target.at("actuators")), target.at("target").number(-1, 1),
                               target.has("optional") && target.at("optional").flag(),
                               target.at("actuators").where()});
    }
  }
  return start;
}

}  // namespace

Task readTask(const std::string& path) {
  const LocatedJson file(path);
  const LocatedValue json = file.root();
  json.checkKeys({"description", "scene", "start", "actions", "cost", "sum_rate_hz", "horizon_s",
                  "timestep_s", "knot_interval_s", "iterations", "samples", "temperature", "noise",
                  "noise_decay"});
  Task task;
  task.path = path;
  task.name = fs::path(path).stem().string();
  task.description = json.at("description").text();
  if (json.has("scene")) {
    task.scene = (fs::path(path).parent_path() / json.at("scene").text()).string();
    if (!fs::is_regular_file(task.scene)) {
      json.at("scene").fail(task.scene + ": no such file; the path is relative to the task's");
    }
  }
  if (json.has("start")) task.start = readStart(json.at("start"));
  for (const LocatedValue& action : json.at("actions").elements()) {
    task.actions.push_back(readAction(action));
  }
  if (task.actions.empty()) json.at("actions").fail("there is none");
  for (const LocatedValue& term : json.at("cost").elements()) task.cost.push_back(readTerm(term));
  if (task.cost.empty()) json.at("cost").fail("there is none");
  const auto setting = [&json](const char* key, double low, double high, double otherwise) {
    return json.has(key) ? json.at(key).number(low, high) : otherwise;
  };
  task.horizon = json.at("horizon_s").number(1e-3, 60);
  task.timestep = setting("timestep_s", 1e-5, 0.1, 0.005);
  task.knot_interval = setting("knot_interval_s", 1e-3, 60, 0.1);
  task.sum_rate = setting("sum_rate_hz", 0.01, 1e5, 600);
  task.iterations = json.has("iterations") ? json.at("iterations").integer(1, 1000000) : 30;
  task.samples = json.has("samples") ? json.at("samples").integer(2, 1000000) : 64;
  task.temperature = setting("temperature", 1e-6, 1e6, 0.2);
  task.noise = setting("noise", 0, 10, 1);
  task.noise_decay = setting("noise_decay", 0.1, 1, 0.97);
  return task;
}

std::map<std::string, std::string> shippedTasks() {
  std::map<std::string, std::string> tasks;
  for (const fs::directory_entry& entry : fs::directory_iterator(tasksFolder())) {
    if (entry.path().extension() == ".json") {
      tasks[entry.path().stem().string()] = entry.path().string();
    }
  }
  return tasks;
}

Task findTask(const std::string& name) {
  if (fs::path(name).extension() == ".json") return readTask(name);
  const auto tasks = shippedTasks();
  const auto found = tasks.find(name);
  if (found != tasks.end()) return readTask(found->second);
  std::string known;
  for (const auto& [task, path] : tasks) known += (known.empty() ? "" : ", ") + task;
  throw Error(fmt::format("no task '{}'; there are {}, or give a file, TASK.json", name, known));
}

}  // namespace torso::tools
