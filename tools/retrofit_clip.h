// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The persons in a motion capture file, from its reading to the files that come out of it.

#include <array>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "model/anatomy.h"
#include "tools/clip.h"
#include "tools/part_map.h"
#include "tools/role.h"

namespace torso::tools {

// What is written for each person, after its name: the motion of the whole body (motion_file.h,
// motion_bvh.h, motion_glb.h), the body in the person's size for `torso view` and `torso render`,
// and what each frame tells (retrofit_readouts.h).
constexpr std::array<const char*, 6> kRetrofitFiles = {".csv", ".bin", ".bvh",
                                                       ".glb", ".xml", "_readouts.csv"};

struct Person {
  std::string name;  // of the files: of the clip, and a number if there are several persons
  Clip clip;
  Roles roles;
};

// The persons in all takes of a file. rate [Hz]; 0: the clip's own, but at most 30. stem: the names
// begin with it. What fails does not stop the others: errors gets a message for each.
std::vector<Person> readPersons(const std::string& path, const std::string& stem, double rate,
                                const PartMap& map, std::vector<std::string>* errors);

// What the person's joints were taken for, and its size. Throws Error.
nlohmann::ordered_json describePerson(const Anatomy& tables, const Person& person);

// Writes <folder>/<name><kRetrofitFiles> and returns describePerson with errors, flags and times.
// The XML includes "scene.xml", which must be in the folder. temporary: <name>_temporary.xml and
// .csv too, the skeleton of temporary_skeleton.h and its motion. progress gets the share done; it
// may throw to cancel: then nothing is written. Throws Error. Thread-safe.
nlohmann::ordered_json retrofitPerson(const Anatomy& tables, const Person& person,
                                      const std::string& folder, bool temporary,
                                      const std::function<void(double)>& progress);

}  // namespace torso::tools
