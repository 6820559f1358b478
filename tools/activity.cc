// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/activity.h"

#include "model/csv.h"

namespace torso::tools {

namespace {

constexpr double kDegree = EIGEN_PI / 180;

}  // namespace

std::vector<Activity> readActivities(const std::string& folder) {
  const CsvTable table(folder + "/activities.csv");
  std::vector<Activity> activities;
  for (int i = 0; i < table.rows(); i++) {
    const auto number = [&](const char* column) { return table.number(i, column); };
    Activity a;
    a.name = table.text(i, "activity");
    a.title = table.text(i, "title");
    a.held = static_cast<Held>(table.word(i, "held", {"feet", "seat", "bed"}));
    a.gravity = {number("gravity_x"), number("gravity_y"), number("gravity_z")};
    a.gravity.normalize();
    a.thorax_pitch = number("thorax_pitch_deg") * kDegree;
    a.lumbar_flexion = number("lumbar_flexion_deg") * kDegree;
    a.knee = number("knee_deg") * kDegree;
    a.upper_arm = number("upper_arm_deg") * kDegree;
    a.forearm = number("forearm_deg") * kDegree;
    a.whole_body_leans = table.word(i, "lean", {"legs", "body"}) == 1;
    a.load = number("load_kg");
    a.load_in_hands = table.empty(i, "load_mm");
    a.load_distance = a.load_in_hands ? 0 : number("load_mm") * 1e-3;
    a.pressure = number("pressure_mpa") * 1e6;
    a.l3_load = table.empty(i, "l3_load_n") ? 0 : number("l3_load_n");
    activities.push_back(a);
  }
  return activities;
}

}  // namespace torso::tools
