// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tests/plugin/fixture.h"

#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <mutex>
#include <random>
#include <sstream>

namespace torso {
namespace {

std::mutex warnings_mutex;
std::string warnings;

void onWarning(const char* message) {
  const std::lock_guard<std::mutex> lock(warnings_mutex);
  warnings += std::string(message) + "\n";
}

// MuJoCo does not expect its error handler to return.
void onError(const char* message) {
  std::fprintf(stderr, "MuJoCo error: %s\n", message);
  std::abort();
}

}  // namespace

PluginTest::PluginTest() {
  takeWarnings();
  mju_user_warning = onWarning;
  mju_user_error = onError;
}

PluginTest::~PluginTest() {
  mju_user_warning = nullptr;
  mju_user_error = nullptr;
}

void PluginTest::TearDown() { EXPECT_EQ(takeWarnings(), "") << "MuJoCo warned"; }

std::string PluginTest::takeWarnings() {
  const std::lock_guard<std::mutex> lock(warnings_mutex);
  return std::exchange(warnings, "");
}

std::string modelPath(const std::string& file) { return TORSO_MJCF_DIR "/" + file; }

std::string withoutMeshes(const std::string& text) {
  std::istringstream stream(text);
  std::string out, line;
  while (std::getline(stream, line)) {
    const bool asset = line.find("<mesh ") != std::string::npos;
    const bool geom =
        line.find("<geom ") != std::string::npos && line.find(" mesh=") != std::string::npos;
    if (!asset && !geom) out += line + "\n";
  }
  return out;
}

std::string modelText(const std::string& file) {
  std::ifstream stream(modelPath(file));
  if (!stream) throw std::runtime_error(modelPath(file) + " cannot be read");
  std::ostringstream buffer;
  buffer << stream.rdbuf();
  std::string text = withoutMeshes(buffer.str());
  // Includes are relative to the file, which will be elsewhere.
  const std::string include = "<include file=\"scene.xml\"/>";
  if (text.find(include) != std::string::npos) {
    std::string scene = modelText("scene.xml");
    scene.erase(0, scene.find('>', scene.find("<mujoco")) + 1);
    scene.erase(scene.find("</mujoco>"));
    replaceOnce(&text, include, scene);
  }
  return text;
}

void replaceOnce(std::string* text, const std::string& from, const std::string& to) {
  const std::size_t at = text->find(from);
  if (at == std::string::npos) throw std::runtime_error("the model's text has no '" + from + "'");
  text->replace(at, from.size(), to);
}

void fixPelvis(std::string* text) { replaceOnce(text, "<freejoint name=\"pelvis\"/>", ""); }

ModelPtr loadText(const std::string& text, std::string* error) {
  std::string path = testing::TempDir() + "torso_XXXXXX";
  close(mkstemp(path.data()));
  std::ofstream(path) << text;
  char message[1000] = "";
  ModelPtr m(mj_loadXML(path.c_str(), nullptr, message, sizeof message));
  unlink(path.c_str());
  if (error) {
    *error = message;
  } else if (!m) {
    throw std::runtime_error(message);
  }
  return m;
}

ModelPtr loadModel(const std::string& file) { return loadText(modelText(file)); }

DataPtr makeData(const mjModel* m) { return DataPtr(mj_makeData(m)); }
DataPtr copyData(const mjModel* m, const mjData* d) { return DataPtr(mj_copyData(nullptr, m, d)); }

torsoInfo torsoOf(const mjModel* m) {
  torsoInfo info = {};
  char error[500];
  if (torso_info(m, &info, error, sizeof error) != 1) {
    throw std::runtime_error(std::string("no sound torso: ") + error);
  }
  return info;
}

void randomControls(const mjModel* m, mjData* d, double share, int seed) {
  std::mt19937 random(seed);
  for (int i = 0; i < m->nu; i++) {
    const mjtNum* range = m->actuator_ctrlrange + 2 * i;
    d->ctrl[i] = share * std::uniform_real_distribution<double>(range[0], range[1])(random);
  }
}

void randomVelocities(const mjModel* m, mjData* d, double sigma, int seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, sigma);
  for (int i = 0; i < m->nv; i++) d->qvel[i] = normal(random);
}

void leaveInSpace(mjModel* m) {
  mju_zero3(m->opt.gravity);
  m->opt.collision = mjCOL_PAIR;  // predefined pairs only: the facets
}

std::string differences(const mjModel* m, const mjData* one, const mjData* two) {
  std::string names;
  const auto compare = [&](const char* name, const mjtNum* a, const mjtNum* b, int n) {
    if (std::memcmp(a, b, sizeof(mjtNum) * n) != 0) names += std::string(name) + " ";
  };
  compare("time", &one->time, &two->time, 1);
  compare("qpos", one->qpos, two->qpos, m->nq);
  compare("qvel", one->qvel, two->qvel, m->nv);
  compare("act", one->act, two->act, m->na);
  compare("qacc", one->qacc, two->qacc, m->nv);
  compare("qfrc_passive", one->qfrc_passive, two->qfrc_passive, m->nv);
  compare("qfrc_constraint", one->qfrc_constraint, two->qfrc_constraint, m->nv);
  compare("userdata", one->userdata, two->userdata, m->nuserdata);
  compare("sensordata", one->sensordata, two->sensordata, m->nsensordata);
  return names;
}

}  // namespace torso
