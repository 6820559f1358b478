// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/stick_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "tools/error.h"
#include "tools/performer.h"
#include "tools/retrofit_clip.h"

namespace torso::tools {

using Eigen::Vector3d;

StickFigure::StickFigure(const Anatomy& tables, const std::string& path, const std::string& name) {
  std::vector<std::string> errors;
  const std::string stem = std::filesystem::path(path).stem().string();
  const std::vector<Person> persons = readPersons(path, stem, 0, {}, &errors);
  if (persons.empty()) throw Error(errors.empty() ? path + ": nobody in it" : errors.front());
  std::vector<std::string> names;
  const Person* person = persons.size() == 1 ? &persons.front() : nullptr;
  for (const Person& one : persons) {
    names.push_back(one.name);
    if (one.name == name) person = &one;
  }
  if (!person) {
    throw Error(fmt::format("{}: no person '{}' in it, but {}; the motion's name tells which one",
                            path, name, fmt::join(names, ", ")));
  }
  world_ = inWorld(person->clip, measurePerformer(tables, person->clip, person->roles));
  // Without what carries the hips: often a root on the floor.
  std::vector<bool> ours(world_.joints.size(), false);
  for (int j = 0; j < static_cast<int>(world_.joints.size()); j++) {
    const int parent = world_.joints[j].parent;
    ours[j] = j == person->roles.hips || (parent >= 0 && ours[parent]);
    if (ours[j] && j != person->roles.hips) joints_.push_back(j);
  }
}

std::vector<Stick> StickFigure::at(double time, const Vector3d& shift) const {
  const double last = static_cast<double>(world_.frames() - 1);
  const double frame = last > 0 ? std::fmod(time * world_.rate, last + 1e-9) : 0;
  const auto before = static_cast<std::size_t>(frame);
  const std::size_t after = std::min(before + 1, world_.frames() - 1);
  const double share = frame - static_cast<double>(before);
  const auto place = [&](int joint) -> Vector3d {
    return (1 - share) * world_.pose(before, joint).translation() +
           share * world_.pose(after, joint).translation() + shift;
  };
  std::vector<Stick> sticks;
  for (const int j : joints_) sticks.push_back({place(world_.joints[j].parent), place(j)});
  return sticks;
}

}  // namespace torso::tools
