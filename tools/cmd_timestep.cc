// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <future>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/commands.h"
#include "tools/error.h"
#include "tools/mujoco_support.h"
#include "tools/paths.h"
#include "tools/progress_bar.h"
#include "tools/rollout.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegree = M_PI / 180;
constexpr double kMoment = 7.5;       // [Nm]
constexpr double kLoad = 500;         // [N]
constexpr double kRampSeconds = 0.5;  // in which a load is put on
constexpr double kAtRest = 0.05;      // [deg/s], [mm/s] of any bone
constexpr double kLift = 0.2;         // [m]
constexpr double kDropSeconds = 4;    // simulated
constexpr double kLandingSeconds = 0.5;
constexpr double kStill = 1;  // [J] of kinetic energy

struct Options {
  std::vector<double> rates = {1800, 600, 200};
  double seconds = 20;
  int threads = 1;
  bool without_drop = false;
  bool json = false;
};

struct Quantity {
  std::string name, unit;
  double value;
};

struct Result {
  std::vector<Quantity> quantities;
  double residual_speed = 0;  // [deg/s], [mm/s] of the fastest bone at the end of a static load
};

// The models that come with torso. Each simulation copies the one it needs.
struct Models {
  ModelPtr held = loadModel(mjcfFolder() + "/torso_held.xml");
  ModelPtr human = loadModel(mjcfFolder() + "/human.xml");
};

ModelPtr copyAt(const mjModel* model, double rate) {
  ModelPtr m(mj_copyModel(nullptr, model));
  if (!m) throw Error("not enough memory for the model");
  m->opt.timestep = 1 / rate;
  return m;
}

// A simulation that gives some rows of the table.
struct Case {
  bool is_static;
  std::function<Result(double rate)> run;
};

int bodyOf(const mjModel* m, const char* name) {
  const int body = mj_name2id(m, mjOBJ_BODY, name);
  if (body < 0) throw Error(fmt::format("the model has no body {}", name));
  return body;
}

int discOf(const mjModel* m, const char* name) {
  const int disc = torso_discId(m, name);
  if (disc < 0) throw Error(fmt::format("the model has no disc {}", name));
  return disc;
}

void step(const mjModel* m, mjData* d) {
  mj_step(m, d);
  const std::string warning = firstWarning(d);
  if (warning.empty()) return;
  throw Error(fmt::format("at {:.0f} Hz, {:.3f} s: {}", 1 / m->opt.timestep, d->time, warning));
}

// The torso held by its pelvis.
struct Held {
  Held(const Models& models, double rate)
      : m(copyAt(models.held.get(), rate)), d(makeData(m.get())), L1(bodyOf(m.get(), "L1")) {}

  // Of the fastest bone [deg/s], [mm/s].
  double speed() const {
    double fastest = 0;
    for (int i = 1; i < m->nbody; i++) {
      mjtNum v[6];
      mj_objectVelocity(m.get(), d.get(), mjOBJ_BODY, i, v, 0);
      fastest = std::max({fastest, mju_norm3(v) / kDegree, mju_norm3(v + 3) * 1e3});
    }
    return fastest;
  }

  // Puts `load` on L1 (force at its origin [N], moment [Nm], world axes) and waits for rest, for
  // `seconds` at most. Returns the speed that is left.
  double settle(const mjtNum load[6], double seconds) {
    while (d->time < seconds) {
      // Not every step: what it costs.
      if (d->time > 2 * kRampSeconds && std::fmod(d->time, 0.1) < m->opt.timestep &&
          speed() < kAtRest) {
        break;
      }
      const double s = std::min(d->time / kRampSeconds, 1.0);
      mjtNum* applied = d->xfrc_applied + 6 * L1;
      mju_scl(applied, load, s * s * (3 - 2 * s), 6);
      // MuJoCo applies the force at the centre of mass.
      mjtNum arm[3], moment[3];
      mju_sub3(arm, d->xpos + 3 * L1, d->xipos + 3 * L1);
      mju_cross(moment, arm, applied);
      mju_addTo3(applied + 3, moment);
      step(m.get(), d.get());
    }
    const double left = speed();
    mj_forward(m.get(), d.get());
    return left;
  }

  // Rotation of one body relative to another since qpos0, along a world axis [deg].
  double turned(int lower, int upper, const mjtNum axis[3]) const {
    const auto relative = [&](const mjData* at, mjtNum q[4]) {
      mjtNum inverse[4];
      mju_negQuat(inverse, at->xquat + 4 * lower);
      mju_mulQuat(q, inverse, at->xquat + 4 * upper);
    };
    const DataPtr rest = makeData(m.get());
    mj_kinematics(m.get(), rest.get());
    mjtNum now[4], before[4], turn[4], vector[3];
    relative(d.get(), now);
    relative(rest.get(), before);
    mju_negQuat(before, before);
    mju_mulQuat(turn, now, before);  // in the lower body
    mju_quat2Vel(vector, turn, 1);
    mju_rotVecQuat(vector, vector, rest->xquat + 4 * lower);
    return mju_dot3(vector, axis) / kDegree;
  }

  ModelPtr m;
  DataPtr d;
  int L1;
};

// A pure moment on L1 without gravity and servos, as spine testers apply it. Static but for dampers
// on the rib cage, which shorten the swinging of what hangs above and do nothing at rest.
Result rangeOfMotion(const Models& models, double rate, const char* name, int axis, double sign,
                     double seconds) {
  constexpr double kDamping[2] = {60, 3};  // [Ns/m], [Nms/rad]
  Held held(models, rate);
  mjModel* m = held.m.get();
  mju_zero3(m->opt.gravity);
  m->opt.disableflags |= mjDSBL_ACTUATION;
  const int dof = m->body_dofadr[bodyOf(m, "ribcage")];
  for (int k = 0; k < 6; k++) m->dof_damping[dof + k] = kDamping[k >= 3];
  mjtNum load[6] = {0}, direction[3] = {0};
  direction[axis] = sign;
  load[3 + axis] = sign * kMoment;
  const double speed = held.settle(load, seconds);
  const int S1 = bodyOf(m, "pelvis"), L4 = bodyOf(m, "L4"), L5 = bodyOf(m, "L5");
  return {{{fmt::format("{} L1-S1", name), "deg", held.turned(S1, held.L1, direction)},
           {fmt::format("{} L4-L5", name), "deg", held.turned(L5, L4, direction)}},
          speed};
}

// The weight of trunk and head, held by the servos, and a load on L1.
Result pressure(const Models& models, double rate, const char* name, double load_newton,
                double seconds) {
  Held held(models, rate);
  const mjtNum load[6] = {0, 0, -load_newton, 0, 0, 0};
  const double speed = held.settle(load, seconds);
  const mjModel* m = held.m.get();
  const int disc = discOf(m, "L4/L5");
  return {{{fmt::format("L4/L5 pressure, {}", name), "MPa",
            1e-6 * torso_discPressure(m, held.d.get(), disc)},
           {fmt::format("L4/L5 nucleus, {}", name), "MPa",
            1e-6 * torso_discNucleusPressure(m, held.d.get(), disc)}},
          speed};
}

// The standing body falls from 0.2 m, its servos at zero.
Result drop(const Models& models, double rate) {
  const ModelPtr m = copyAt(models.human.get(), rate);
  const DataPtr d = makeData(m.get());
  RolloutOptions options;
  options.lift = kLift;
  startRun(m.get(), d.get(), options);
  const int disc = discOf(m.get(), "L4/L5");
  double force = 0, nucleus = 0, settled = 0, landing = 0;
  std::vector<mjtNum> momentum(m->nv);
  while (d->time < kDropSeconds) {
    step(m.get(), d.get());
    mjtNum f[3], moment[3];
    torso_discWrench(m.get(), d.get(), disc, f, moment, nullptr);
    force = std::max(force, mju_norm3(f));
    if (d->time < kLandingSeconds) landing = force;
    nucleus = std::max(nucleus, torso_discNucleusPressure(m.get(), d.get(), disc));
    mj_mulM(m.get(), d.get(), momentum.data(), d->qvel);
    if (mju_dot(momentum.data(), d->qvel, m->nv) / 2 > kStill) settled = d->time;
  }
  mj_forward(m.get(), d.get());
  return {{{"L4/L5 force, largest on landing", "N", landing},
           {"L4/L5 force, largest", "N", force},
           {"L4/L5 nucleus, largest", "MPa", 1e-6 * nucleus},
           {"kinetic energy last above 1 J", "s", settled},
           {"centre of mass at the end", "m", d->subtree_com[2]},
           {"L4/L5 pressure at the end", "MPa", 1e-6 * torso_discPressure(m.get(), d.get(), disc)}},
          0};
}

std::vector<Case> casesOf(const Options& options, const Models& models) {
  std::vector<Case> cases;
  const auto motion = [&](const char* name, int axis, double sign) {
    cases.push_back({true, [=, &models, &options](double rate) {
                       return rangeOfMotion(models, rate, name, axis, sign, options.seconds);
                     }});
  };
  const auto load = [&](const char* name, double newton) {
    cases.push_back({true, [=, &models, &options](double rate) {
                       return pressure(models, rate, name, newton, options.seconds);
                     }});
  };
  motion("flexion", 1, 1);
  motion("extension", 1, -1);
  motion("lateral bending", 0, 1);
  motion("axial rotation", 2, 1);
  load("weight", 0);
  load("weight + 500 N", kLoad);
  if (!options.without_drop) {
    cases.push_back({false, [&models](double rate) { return drop(models, rate); }});
  }
  return cases;
}

Json compare(const Options& options) {
  const Models models;
  const std::vector<Case> cases = casesOf(options, models);
  const std::size_t nrate = options.rates.size();
  std::vector<Result> results(cases.size() * nrate);
  std::atomic<std::size_t> next = 0, done = 0;
  const auto work = [&] {
    try {
      for (std::size_t i; (i = next++) < results.size(); done++) {
        results[i] = cases[i / nrate].run(options.rates[i % nrate]);
      }
    } catch (...) {
      next = results.size();  // the other workers need not go on
      throw;
    }
  };
  std::vector<std::future<void>> workers;
  for (int i = 0; i < options.threads; i++) workers.push_back(std::async(std::launch::async, work));
  {
    const ProgressBar bar;
    for (auto& worker : workers) {
      while (worker.wait_for(std::chrono::milliseconds(200)) != std::future_status::ready) {
        bar.show(static_cast<double>(done) / results.size());
      }
    }
  }
  for (auto& worker : workers) worker.get();

  Json quantities = Json::array();
  std::vector<double> largest_static(nrate, 0), largest_dynamic(nrate, 0);
  double speed = 0;
  for (const Result& result : results) speed = std::max(speed, result.residual_speed);
  for (std::size_t c = 0; c < cases.size(); c++) {
    const Result* at = &results[c * nrate];
    std::vector<double>& largest = cases[c].is_static ? largest_static : largest_dynamic;
    for (std::size_t i = 0; i < at->quantities.size(); i++) {
      std::vector<double> values, differences;
      for (std::size_t r = 0; r < nrate; r++) {
        values.push_back(at[r].quantities[i].value);
        differences.push_back(100 * (values[r] / values[0] - 1));
        largest[r] = std::max(largest[r], std::abs(differences[r]));
      }
      quantities.push_back({{"name", at->quantities[i].name},
                            {"unit", at->quantities[i].unit},
                            {"static", cases[c].is_static},
                            {"values", values},
                            {"difference_percent", differences}});
    }
  }
  if (speed > kAtRest) {
    std::cerr << "torso timestep: bones still move under the static loads; use more --seconds\n";
  }
  Json result = {{"rates_hz", options.rates},
                 {"quantities", quantities},
                 {"static_difference_percent", largest_static}};
  if (!options.without_drop) result["dynamic_difference_percent"] = largest_dynamic;
  result["residual_speed"] = speed;
  result["shipped_rate_hz"] = std::round(1 / models.human->opt.timestep);
  return result;
}

void print(const Json& j) {
  const auto rates = j["rates_hz"].get<std::vector<double>>();
  const auto header = [&](const char* title) {
    fmt::print("{:<36}{:<5}", title, "");
    for (std::size_t r = 0; r < rates.size(); r++) {
      fmt::print(r ? "{:>18}" : "{:>9}", fmt::format("{:g} Hz", rates[r]));
    }
    fmt::print("\n");
  };
  for (const bool is_static : {true, false}) {
    bool first = true;
    for (const Json& q : j["quantities"]) {
      if (q["static"] != is_static) continue;
      if (first) header(is_static ? "static" : "dynamic");
      first = false;
      fmt::print("{:<36}{:<5}", q["name"].get<std::string>(), q["unit"].get<std::string>());
      for (std::size_t r = 0; r < rates.size(); r++) {
        fmt::print("{:9.4g}", q["values"][r].get<double>());
        if (r) fmt::print(" {:+6.2f} %", q["difference_percent"][r].get<double>());
      }
      fmt::print("\n");
    }
  }
  fmt::print("fastest bone at the end of a static load: {:.2g} (deg/s, mm/s)\n",
             j["residual_speed"].get<double>());
  for (std::size_t r = 1; r < rates.size(); r++) {
    fmt::print("{:g} Hz against {:g} Hz: static quantities within {:.2g} %", rates[r], rates[0],
               j["static_difference_percent"][r].get<double>());
    if (j.contains("dynamic_difference_percent")) {
      fmt::print(", dynamic ones within {:.2g} %",
                 j["dynamic_difference_percent"][r].get<double>());
    }
    fmt::print("\n");
  }
  fmt::print("The models that come with torso run at {:g} Hz.\n",
             j["shipped_rate_hz"].get<double>());
}

}  // namespace

void addTimestep(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("timestep", "How far results depend on the time step.");
  command->footer(
      "Simulates the models that come with torso at several rates and compares each with the "
      "first.\n"
      "Static quantities: rotation of L1 against S1 and of L4 against L5 under a pure moment of\n"
      "7.5 Nm on L1, pelvis held, no gravity, no servos; pressure in L4/L5, as force over area "
      "and\n"
      "in the nucleus, under the weight of trunk and head, servos on, and with 500 N more on L1.\n"
      "They are read when no bone moves faster than 0.05 deg/s or mm/s. Dynamic quantities: the\n"
      "standing body falls from 0.2 m, servos at zero; largest values in L4/L5 in the first 0.5 s\n"
      "(landing) and in all 4 s, and when and where it comes to lie.\n\n"
      "Examples:\n"
      "  torso timestep\n"
      "  torso timestep --threads 2 --json\n"
      "  torso timestep --rates 1800,200 --without-drop");
  command->add_option("--rates", options->rates, "Steps per second; the first is the reference")
      ->delimiter(',')
      ->check(CLI::Range(150., 20000.))
      ->capture_default_str();
  command->add_option("--seconds", options->seconds, "Longest simulated time of a static load")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--threads", options->threads, "Number of threads")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->add_flag("--without-drop", options->without_drop, "Static quantities only");
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options] {
    const Json result = compare(*options);
    if (options->json) {
      std::cout << result.dump(2) << '\n';
    } else {
      print(result);
    }
  });
}

}  // namespace torso::tools
