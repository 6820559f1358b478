// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// What the command says of the models that come with the project.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/tools/command_fixture.h"
#include "tools/mujoco_support.h"

namespace torso::tools {
namespace {

using nlohmann::json;

class Human : public Command {};

const std::string kHuman = TORSO_MJCF "/human.xml";

// The counts of the design: see README.
TEST_F(Human, HasTheCountsOfItsDesign) {
  const json info = runJson("info --json " + kHuman);
  EXPECT_EQ(info["dof"], 195);
  EXPECT_EQ(info["free_joints"], 24);
  EXPECT_EQ(info["ball_joints"], 17);
  EXPECT_EQ(info["ligament_segments"], 440);
  EXPECT_EQ(info["facets"], 74);
  EXPECT_EQ(info["facet_points"], 4 * 74);
  EXPECT_NEAR(info["mass_kg"], 72, 0.5);
  EXPECT_NEAR(info["stature_m"], 1.70, 0.01);
  ASSERT_EQ(info["discs"].size(), 23u);
  EXPECT_EQ(info["discs"].front()["name"], "L5/S1");
  EXPECT_EQ(info["discs"].back()["name"], "C2/C3");
  for (const json& disc : info["discs"]) {
    EXPECT_GE(disc["nodes"], 127) << disc;
    EXPECT_LE(disc["nodes"], 285) << disc;
    EXPECT_GE(disc["tets"], 307) << disc;
    EXPECT_LE(disc["tets"], 1090) << disc;
  }
}

// 2 m drop with random controls. The full check has 100 seeds of 5 s; see tools/test.
void expectSound(const json& j, int runs) {
  EXPECT_EQ(j["runs"], runs);
  EXPECT_EQ(j["failed"], 0);
  EXPECT_EQ(j["warnings"], 0);
  EXPECT_EQ(j["bodies_on_floor"], 1);
  EXPECT_GT(j["min_disc_thickness_ratio"], 0.2);
  EXPECT_LT(j["max_disc_thickness_ratio"], 3);
  // A drop from 2 m is no light load.
  EXPECT_GT(j["max_disc_pressure_mpa"], 1);
  EXPECT_LT(j["min_disc_thickness_ratio"], 0.95);
  EXPECT_GT(j["ligament_violation_mm"]["max"], 0);
  EXPECT_GT(j["facet_violation_mm"]["max"], 0);
  EXPECT_EQ(j["dof"], 195);
}

TEST_F(Human, SurvivesADropAt600Hz) {
  expectSound(
      runJson("run --json --drop 2 --control random --seeds 2 --seconds 3 --threads 2 " + kHuman),
      2);
}

TEST_F(Human, SurvivesADropAt200Hz) {
  expectSound(runJson("run --json --drop 2 --control random --seeds 2 --seconds 3 --threads 2 "
                      "--timestep 0.005 " +
                      kHuman),
              2);
}

TEST_F(Human, GivesTheSameBitsOnAnyNumberOfThreads) {
  const std::string arguments =
      "run --json --drop 0.1 --control random --seeds 4 --seconds 0.4 " + kHuman;
  json one = runJson(arguments + " --threads 1");
  json four = runJson(arguments + " --threads 4");
  for (const char* key : {"core_s", "wall_s", "real_time_factor"}) {
    one.erase(key);
    four.erase(key);
  }
  EXPECT_EQ(one, four);
}

// The stock viewer draws at most 5000 shapes, and nothing if there are more.
// But for neighbours at a joint, excluded bodies are those whose geoms never meet: no contact is
// lost.
TEST_F(Human, OnlyNeighboursAreKeptApart) {
  const ModelPtr m = loadModel(kHuman);
  const auto canMeet = [&](int a, int b) {
    return (m->geom_contype[a] & m->geom_conaffinity[b]) ||
           (m->geom_contype[b] & m->geom_conaffinity[a]);
  };
  std::set<std::string> apart;
  for (int i = 0; i < m->nexclude; i++) {
    const int body1 = (m->exclude_signature[i] >> 16) - 1;
    const int body2 = (m->exclude_signature[i] & 0xFFFF) - 1;
    for (int a = 0; a < m->ngeom; a++) {
      for (int b = 0; b < m->ngeom; b++) {
        if (m->geom_bodyid[a] != body1 || m->geom_bodyid[b] != body2 || !canMeet(a, b)) continue;
        apart.insert(nameOf(m.get(), mjOBJ_BODY, body1) + " " + nameOf(m.get(), mjOBJ_BODY, body2));
      }
    }
  }
  EXPECT_GT(m->nexclude, 400);
  const std::set<std::string> neighbours = {
      "ribcage left_upper_arm", "ribcage right_upper_arm", "left_thigh L5", "left_thigh L4",
      "right_thigh L5",         "right_thigh L4",          "head ribcage"};
  EXPECT_EQ(apart, neighbours);
}

// The parts are measured in other runs than the step, and cover it.
TEST_F(Human, BenchPartsAddUpToTheStep) {
  const json j = runJson("bench --json --seconds 0.3 --repetitions 5 " + kHuman);
  const std::vector<std::pair<std::string, std::string>> keys = {
      {"parts_us", "step_us"}, {"parts_200hz_us", "step_200hz_us"}};
  for (const auto& [parts, step] : keys) {
    double sum = 0;
    for (const auto& [name, us] : j[parts].items()) {
      if (name == "other") continue;
      EXPECT_GE(us, 0) << name;
      sum += us.get<double>();
    }
    EXPECT_NEAR(sum, j[step].get<double>(), 0.1 * j[step].get<double>());
    EXPECT_NEAR(sum + j[parts]["other"].get<double>(), j[step].get<double>(), 1e-6);
    for (const char* name : {"kinematics", "collision", "constraint", "disc", "rows", "solver"}) {
      EXPECT_GT(j[parts][name], 0) << name;
    }
    // An iteration of 23 discs is more than moving 24 bones ahead.
    EXPECT_GT(j[parts]["disc"], j[parts]["integration"]);
  }
}

// What stands still must not depend on the time step; and one rate gives the same bits twice.
TEST_F(Human, StaticQuantitiesDoNotDependOnTheTimeStep) {
  const json j = runJson("timestep --json --without-drop --threads 2 --rates 1800,200,200");
  EXPECT_LT(j["residual_speed"], 0.05);
  EXPECT_EQ(j["shipped_rate_hz"], 600);
  ASSERT_EQ(j["quantities"].size(), 12u);
  std::map<std::string, double> at1800;
  double largest = 0;
  for (const json& q : j["quantities"]) {
    const std::string name = q["name"];
    const std::vector<double> values = q["values"];
    at1800[name] = values[0];
    EXPECT_NEAR(values[1] / values[0], 1, 0.02) << name;
    EXPECT_EQ(values[1], values[2]) << name;
    EXPECT_EQ(q["static"], true);
    largest = std::max(largest, 100 * std::abs(values[1] / values[0] - 1));
  }
  EXPECT_NEAR(j["static_difference_percent"][1], largest, 1e-9);
  // Each motion goes the way it is pushed, by no more than a living person's (51 deg of flexion,
  // Pearcy 1985), and L4-L5 does its share of it.
  for (const std::string motion : {"flexion", "extension", "lateral bending", "axial rotation"}) {
    const double whole = at1800[motion + " L1-S1"], level = at1800[motion + " L4-L5"];
    EXPECT_GT(whole, 3) << motion;
    EXPECT_LT(whole, 52) << motion;
    EXPECT_GT(level, 0.1 * whole) << motion;
    EXPECT_LT(level, 0.4 * whole) << motion;
  }
  // 500 N on 1200 to 1800 mm^2, of which facets and ligaments may take a third.
  const double rise = at1800["L4/L5 pressure, weight + 500 N"] - at1800["L4/L5 pressure, weight"];
  EXPECT_GT(rise, 0.19);
  EXPECT_LT(rise, 0.42);
}

TEST_F(Human, FitsIntoTheViewer) {
  const ModelPtr m = loadModel(kHuman);
  const DataPtr d = makeData(m.get());
  mj_forward(m.get(), d.get());
  mjvScene scene;
  mjv_defaultScene(&scene);
  mjv_makeScene(m.get(), &scene, 5000);
  mjvOption option;
  mjv_defaultOption(&option);
  mjvCamera camera;
  mjv_defaultFreeCamera(m.get(), &camera);
  for (int group = 0; group < mjNGROUP; group++) option.geomgroup[group] = 1;
  mjv_updateScene(m.get(), d.get(), &option, nullptr, &camera, mjCAT_ALL, &scene);
  EXPECT_EQ(d->warning[mjWARN_VGEOMFULL].number, 0);
  EXPECT_GT(scene.ngeom, m->ntendon);
  EXPECT_LT(scene.ngeom, 2500);  // with room for contacts and joints
  mjv_freeScene(&scene);
}

}  // namespace
}  // namespace torso::tools
