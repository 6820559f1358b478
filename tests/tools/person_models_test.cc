// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Models of people of other sizes, sexes and curves than the tables': they load, stand and fall.

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "model/person.h"
#include "tests/tools/command_fixture.h"
#include "tools/extent.h"
#include "tools/mujoco_support.h"
#include "tools/paths.h"
#include "tools/rollout.h"
#include "tools/torso_mjcf.h"

namespace torso::tools {
namespace {

constexpr double kDegree = M_PI / 180;

class PersonModels : public Command {
 protected:
  // Names of the models written for a person. Bones are the tables': they have neither mass nor
  // contacts, and take seconds to make.
  void writeModels(const Person& person) {
    const Anatomy anatomy = personalAnatomy(Anatomy::load(anatomyFolder()), person);
    MjcfOptions options;
    options.mesh_dir = std::filesystem::absolute(mjcfFolder()).string() + "/assets";
    const auto save = [&](const tinyxml2::XMLDocument& document, const std::string& name) {
      tinyxml2::XMLPrinter printer;
      document.Print(&printer);
      std::ofstream(folder_ / name) << printer.CStr();
    };
    tinyxml2::XMLDocument torso, human, held, scene;
    writeMjcf(anatomy, options, torso);
    save(torso, "torso.xml");
    options.limbs = options.scene = true;
    writeMjcf(anatomy, options, human);
    save(human, "human.xml");
    writeHeldScene(held);
    save(held, "torso_held.xml");
    writeScene(scene);
    save(scene, "scene.xml");
  }

  RolloutSummary simulated(const std::string& name, const RolloutOptions& options) {
    const ModelPtr m = loadModel((folder_ / name).string());
    configureModel(m.get(), options, 0);
    const std::atomic<bool> stop{false};
    return rollout(m.get(), options, {}, nullptr, stop);
  }

  void expectSound(const Person& person) {
    writeModels(person);
    const ModelPtr m = loadModel((folder_ / "human.xml").string());
    EXPECT_NEAR(mj_getTotalmass(m.get()), *person.mass, 1e-3 * *person.mass);
    EXPECT_EQ(m->nv, 195);
    RolloutOptions options;
    options.seconds = 2;
    RolloutSummary held = simulated("torso_held.xml", options);
    EXPECT_EQ(held.failed, 0) << held.runs.front().failure;
    EXPECT_EQ(held.warnings, 0);
    EXPECT_GT(held.extremes.min_disc_thickness.value, 0.85);
    EXPECT_LT(held.extremes.max_disc_thickness.value, 1.1);
    // On its feet the body is balanced: half a second later it is where it was, although no servo
    // looks at its balance.
    const DataPtr d = makeData(m.get());
    configureModel(m.get(), options, 0);
    startRun(m.get(), d.get(), options);
    mj_forward(m.get(), d.get());
    mjtNum start[3];
    mju_copy3(start, d->subtree_com);
    while (d->time < 0.5) mj_step(m.get(), d.get());
    std::printf("in 0.5 s the centre of mass moves %.1f mm forward, %.1f mm down\n",
                1e3 * (d->subtree_com[0] - start[0]), 1e3 * (start[2] - d->subtree_com[2]));
    EXPECT_LT(std::abs(d->subtree_com[0] - start[0]), 0.03);
    EXPECT_NEAR(d->subtree_com[1], 0, 1e-3);
    EXPECT_LT(std::abs(d->subtree_com[2] - start[2]), 0.015);
    options.seconds = 1.5;
    options.control = Control::kRandom;
    options.lift = 1;
    const RolloutSummary fall = simulated("human.xml", options);
    EXPECT_EQ(fall.failed, 0) << fall.runs.front().failure;
    EXPECT_EQ(fall.warnings, 0);
    EXPECT_GT(fall.extremes.min_disc_thickness.value, 0.2);
    std::printf("held: thickness %.3f to %.3f; fall: %.3f to %.3f\n",
                held.extremes.min_disc_thickness.value, held.extremes.max_disc_thickness.value,
                fall.extremes.min_disc_thickness.value, fall.extremes.max_disc_thickness.value);
  }
};

Person person(Person::Sex sex, double stature, double mass) {
  Person p;
  p.sex = sex;
  p.stature = stature;
  p.mass = mass;
  return p;
}

TEST_F(PersonModels, SmallWoman) { expectSound(person(Person::Sex::kFemale, 1.55, 50)); }

TEST_F(PersonModels, TallWomanOfFlatterCurves) {
  Person p = person(Person::Sex::kFemale, 1.85, 90);
  p.lordosis = 55 * kDegree;
  p.kyphosis = 40 * kDegree;
  expectSound(p);
}

TEST_F(PersonModels, TallHeavyMan) { expectSound(person(Person::Sex::kMale, 1.95, 110)); }

TEST_F(PersonModels, StoutManOfDeepCurves) {
  Person p = person(Person::Sex::kMale, 1.60, 90);
  p.lordosis = 75 * kDegree;
  p.kyphosis = 60 * kDegree;
  expectSound(p);
}

// The command writes all files and tells whom they are of.
TEST_F(PersonModels, CommandWritesThemWhole) {
  const nlohmann::json body = runJson(
      "build --json --stature 1.85 --mass 90 --sex f --lordosis 55 --kyphosis 40 -o models");
  EXPECT_NEAR(body["stature_m"], 1.85, 1e-3);
  EXPECT_NEAR(body["mass_kg"], 90, 0.05);
  EXPECT_NEAR(body["lordosis_l1_s1_deg"], 55, 0.5);
  EXPECT_NEAR(body["kyphosis_t4_t12_deg"], 40, 0.5);
  EXPECT_EQ(body["sex"], "f");
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "models")) {
    files += entry.is_regular_file();
  }
  EXPECT_EQ(files, body["files"].size());
  const ModelPtr m = loadModel((folder_ / "models/human.xml").string());
  EXPECT_NEAR(stature(m.get()), 1.85, 0.02);  // as the bones show it
  EXPECT_NEAR(mj_getTotalmass(m.get()), 90, 0.1);
}

TEST_F(PersonModels, RefusalAndCtrlCWriteNothing) {
  const Result refused = run("build --stature 1.8 --mass 200 -o models");
  EXPECT_EQ(refused.status, 1);
  EXPECT_EQ(refused.err.rfind("torso build: --mass 200: must be from 51.84 to 129.6 kg", 0), 0u)
      << refused.err;
  EXPECT_EQ(run("build --sex x -o models").status, 2);
  EXPECT_NE(run("build --stature 1.6 -o models", "timeout -s INT 0.5").status, 0);
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
  write("models", "a file");
  const Result taken = run("build --stature 1.6 -o models/here");
  EXPECT_EQ(taken.status, 1);
  EXPECT_NE(taken.err.find("models/here"), std::string::npos) << taken.err;
  EXPECT_EQ(readFile(folder_ / "models"), "a file");
}

}  // namespace
}  // namespace torso::tools
