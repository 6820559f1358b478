// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// MPPI against closed forms, and `torso optimize` as a user runs it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <thread>

#include "tests/tools/command_fixture.h"
#include "tools/motion_file.h"
#include "tools/mppi.h"
#include "tools/mujoco_support.h"
#include "tools/spine_motion.h"
#include "tools/task.h"

namespace torso::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;
using Vector = std::vector<double>;

// For a linear cost g x and noise N(0, sigma^2) the weighted mean is that of a normal distribution
// shifted by -sigma^2 g / lambda.
TEST(Mppi, UpdateIsTheShiftOfTheNormalDistribution) {
  const Vector g = {1, -2, 0}, sigma = {0.1, 0.2, 0.3};
  MppiOptions options;
  options.samples = 200000;
  options.temperature = 0.5;
  options.absolute_temperature = true;
  MppiState state;
  state.nominal = {0, 0, 0};
  mppiIterate(
      options, sigma, 10,
      [&](const std::vector<Vector>& x) {
        Vector costs;
        for (const Vector& v : x) costs.push_back(g[0] * v[0] + g[1] * v[1] + g[2] * v[2]);
        return costs;
      },
      &state);
  for (std::size_t i = 0; i < 3; i++) {
    const double expected = -sigma[i] * sigma[i] * g[i] / options.temperature;
    EXPECT_NEAR(state.nominal[i], expected, 5 * sigma[i] * std::sqrt(1.5 / options.samples)) << i;
  }
}

TEST(Mppi, FailedSamplesHaveNoWeight) {
  MppiOptions options;
  MppiState state;
  state.nominal = {0};
  const auto costs = [](const std::vector<Vector>& x) {
    Vector all;
    for (const Vector& v : x) all.push_back(v[0] > 0 ? NAN : v[0] < -1 ? INFINITY : -v[0]);
    return all;
  };
  const MppiReport report = mppiIterate(options, {0.5}, 2, costs, &state);
  EXPECT_GT(report.failed, 20);
  EXPECT_LE(state.nominal[0], 0);
  EXPECT_GE(state.nominal[0], -1);
  EXPECT_GE(state.best[0], -1);

  const Vector before = state.nominal;
  state.best.clear();
  const MppiReport none = mppiIterate(
      options, {0.5}, 2, [](const std::vector<Vector>& x) { return Vector(x.size(), INFINITY); },
      &state);
  EXPECT_EQ(none.failed, options.samples - 1) << "the nominal is known";
  EXPECT_EQ(state.nominal, before);
}

// A hollow at 1 between two ridges: the mean of samples in the hollow and beyond it may be on a
// ridge, and is then not taken.
TEST(Mppi, TheNominalNeverGetsWorse) {
  MppiOptions options;
  options.samples = 8;
  MppiState state;
  state.nominal = {0, 0};
  const auto costs = [](const std::vector<Vector>& x) {
    Vector all;
    for (const Vector& v : x) all.push_back(-std::cos(9 * v[0]) * std::cos(9 * v[1]) + v[0]);
    return all;
  };
  double before = INFINITY;
  int unchanged = 0;
  for (int i = 0; i < 30; i++) {
    const MppiReport report = mppiIterate(options, {0.5, 0.5}, 1, costs, &state);
    EXPECT_LE(report.nominal_cost, before) << i;
    EXPECT_EQ(state.nominal_cost, costs({state.nominal})[0]) << i;
    EXPECT_LE(state.best_cost, state.nominal_cost) << i;
    unchanged += report.nominal_cost == before;
    before = report.nominal_cost;
  }
  EXPECT_GT(unchanged, 0) << "no update was refused";
  EXPECT_LT(before, -1.5);
}

// 1 kg on a rail, pushed by up to 1 N.
const char kCart[] =
    "<mujoco><option gravity='0 0 0'/><worldbody><body name='cart'><joint name='rail' type='slide' "
    "axis='1 0 0'/><geom size='.1' mass='1'/></body></worldbody><actuator><motor name='push' "
    "joint='rail' ctrllimited='true' ctrlrange='-1 1'/></actuator><sensor><jointpos name='way' "
    "joint='rail'/>"
    "<jointvel name='speed' joint='rail'/></sensor></mujoco>";

std::string cartTask(const std::string& cost) {
  return R"({"description": "a cart", "actions": [{"name": "push", "actuators": ["pu*"], "noise": 0.5}],
    "cost": [)" +
         cost + R"(], "horizon_s": 1, "timestep_s": 0.001, "knot_interval_s": 0.1})";
}

const char kFar[] = R"({"weight": -1, "when": "end", "factors": [{"of": "com", "axis": "x"}]})";

class Optimize : public Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    write("cart.xml", kCart);
    write("far.json", cartTask(kFar));
  }

  // One line on stderr, exit status 1, no folder left.
  std::string refused(const std::string& arguments) {
    const Result result = run("optimize " + arguments + " -o refused");
    EXPECT_EQ(result.status, 1) << arguments;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(fs::exists(folder_ / "refused")) << arguments;
    return result.err;
  }

  std::string refusedTask(const std::string& text) {
    return refused(write("bad.json", text) + " --model cart.xml");
  }

  void expectSameFiles(const std::string& one, const std::string& other) {
    for (const char* file : {"best.motion", "controls.csv", "cost.csv", "result.json"}) {
      const std::string text = readFile(folder_ / one / file);
      EXPECT_FALSE(text.empty()) << one << file;
      EXPECT_EQ(text, readFile(folder_ / other / file)) << other << "/" << file;
    }
  }
};

// The farthest is full force. As the spline's first three points are zero, the force then is the
// distribution function of h times the sum of three uniform numbers, of mean 1.5 h and variance
// h^2 / 4, so that the way is ((T - 1.5 h)^2 + h^2 / 4) / 2.
TEST_F(Optimize, ACartGoesAsFarAsItCan) {
  const json result = runJson("optimize far.json --model cart.xml -o far --json");
  const double best = result["best_cost"], optimum = -(0.85 * 0.85 + 0.01 / 4) / 2;
  EXPECT_EQ(result["start_cost"], 0);
  EXPECT_NEAR(best, optimum, 0.02 * -optimum);
  EXPECT_GE(best, optimum - 1e-3) << "the time step's error apart";
  double before = 0;
  for (const json& row : result["rows"]) {
    EXPECT_LE(row["best_cost"], before);
    before = row["best_cost"];
  }
  // The motion is what the controls do.
  const Motion motion = readMotion((folder_ / "far/best.motion").string());
  EXPECT_EQ(motion.frames(), 1001u);
  EXPECT_EQ(motion.qpos.back(), -best);
}

TEST_F(Optimize, ACartComesToRestWhereItShould) {
  write("rest.json", cartTask(R"({"weight": 1, "when": "end", "factors": [
                    {"of": "sensor", "sensor": "way", "from": 0.1, "power": 2}]},
                    {"weight": 1, "when": "end", "factors": [
                    {"of": "sensor", "sensor": "speed", "power": 2}]})"));
  const json result = runJson("optimize rest.json --model cart.xml -o rest --json");
  EXPECT_NEAR(result["start_cost"].get<double>(), 0.01, 1e-12);
  EXPECT_LT(result["best_cost"].get<double>(), 1e-4);
}

// A sum does not depend on the time step: 600 summands a second of 0.1^2.
TEST_F(Optimize, SumsAreOfSoManySummandsPerSecond) {
  write("sum.json", cartTask(R"({"weight": 1, "when": "sum", "factors": [
                    {"of": "com", "axis": "x", "from": 0.1, "power": 2}]})"));
  for (const std::string step : {"0.001", "0.004"}) {
    const json result =
        runJson("optimize sum.json --model cart.xml --iterations 1 --samples 2 -o s" + step +
                " --json --timestep " + step);
    const double summands = 600 * (1 + std::stod(step));  // the start and each step
    EXPECT_NEAR(result["start_cost"].get<double>(), 0.01 * summands, 1e-9);
  }
}

TEST_F(Optimize, IsTheSameForAnyNumberOfThreads) {
  const std::string arguments =
      "optimize swing --horizon 0.06 --knots 0.02 --samples 5 --iterations 2 --threads ";
  for (const std::string threads : {"1", "2", "3"}) {
    const Result result = run(arguments + threads + " -o threads" + threads);
    ASSERT_EQ(result.status, 0) << result.err;
  }
  expectSameFiles("threads1", "threads2");
  expectSameFiles("threads1", "threads3");
}

TEST_F(Optimize, IsTheSameForAnyNumberOfProcesses) {
  if (!*MPIRUN) GTEST_SKIP() << "mpirun or MPI's headers are not installed (libopenmpi-dev)";
  const std::string arguments = "optimize far.json --model cart.xml --samples 7 --iterations 4 -o ";
  ASSERT_EQ(run(arguments + "one").status, 0);
  const Result result =
      run(arguments + "three", MPIRUN " --oversubscribe --allow-run-as-root -n 3");
  ASSERT_EQ(result.status, 0) << result.err;
  expectSameFiles("one", "three");
}

TEST_F(Optimize, GoesOnAsIfItHadNotBeenStopped) {
  const std::string arguments = "optimize far.json --model cart.xml --samples 100 ";
  ASSERT_EQ(run(arguments + "--iterations 12 -o whole").status, 0);
  ASSERT_EQ(run(arguments + "--iterations 3 -o parts").status, 0);
  ASSERT_EQ(run(arguments + "--iterations 12 -o parts --resume --threads 2").status, 0);
  expectSameFiles("whole", "parts");

  for (const int signal : {SIGKILL, SIGINT}) {
    const pid_t child = fork();
    if (child == 0) {
      if (chdir(folder_.c_str()) != 0 || !freopen("/dev/null", "w", stdout) ||
          !freopen("/dev/null", "w", stderr)) {
        _exit(126);
      }
      execl(TORSO_COMMAND, "torso", "optimize", "far.json", "--model", "cart.xml", "--samples",
            "100", "--iterations", "12", "-o", "killed", nullptr);
      _exit(127);
    }
    for (int i = 0; i < 2000 && !fs::exists(folder_ / "killed/checkpoint.json"); i++) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    kill(child, signal);
    int status;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << "it ended by itself";
    ASSERT_FALSE(fs::exists(folder_ / "killed/result.json"));
    ASSERT_EQ(run(arguments + "--iterations 12 -o killed --resume").status, 0);
    expectSameFiles("whole", "killed");
    fs::remove_all(folder_ / "killed");
  }
}

// Each seed of each body is the run that it would be alone.
TEST_F(Optimize, SeveralSeedsAndBodies) {
  write("cart_fixed.xml", kCart);
  const std::string arguments = "optimize far.json --samples 5 --iterations 3 ";
  const json both =
      runJson(arguments + "--model cart.xml --seed 4 --seeds 2 --compare --json -o both");
  ASSERT_EQ(both["bodies"].size(), 2u);
  double sum = 0;
  for (const std::string seed : {"4", "5"}) {
    const json one =
        runJson(arguments + "--model cart.xml --json --seed " + seed + " -o one" + seed);
    expectSameFiles("one" + seed, "both/cart/seed" + seed);
    sum += one["best_cost"].get<double>();
  }
  for (const json& body : both["bodies"]) {
    EXPECT_NEAR(body["mean_cost"].get<double>(), sum / 2, 1e-12);
    const std::vector<double> costs = body["best_costs"];
    EXPECT_NEAR(body["sd"].get<double>(), std::abs(costs[0] - costs[1]) / std::sqrt(2), 1e-12);
  }
  EXPECT_EQ(both["bodies"][1]["model"], "cart_fixed");
  EXPECT_GT(both["core_s_ratio"], 0);
  EXPECT_EQ(json::parse(readFile(folder_ / "both/result.json")), both);
  EXPECT_THAT(run("optimize far.json --model cart_fixed.xml --compare -o none").err,
              HasSubstr("cart_fixed.xml: no body with a fixed torso is beside it"));
}

// A wave of 12 Hz in the neck is jitter, one of 2 Hz is not, and the parts add up to the turns.
TEST(SpineMotion, TellsJitterFromMotion) {
  for (const double hertz : {2., 12.}) {
    SpineMotion spine;
    spine.rate = 200;
    for (int i = 0; i <= 200; i++) {
      spine.neck.push_back({0, 0.1 * std::sin(2 * M_PI * hertz * i / spine.rate), 0});
    }
    spine.lumbar = spine.thoracic = spine.neck;
    EXPECT_NEAR(neckJitter(spine), hertz > 10 ? 1 : 0, 0.01) << hertz;
  }
}

TEST(SpineMotion, IsOfTheJointsThatBend) {
  const ModelPtr m = compileModel(
      "<mujoco><worldbody><body name='pelvis'><freejoint/><geom size='.1'/><body name='T12'>"
      "<joint name='a' axis='0 1 0'/><geom size='.1'/><body name='T1'><joint name='b' axis='0 1 "
      "0'/>"
      "<geom size='.1'/><body name='C3' euler='0 40 0'><joint name='c' axis='0 1 0'/>"
      "<geom size='.1'/></body></body></body></body></worldbody></mujoco>",
      "chain");
  Motion motion;
  motion.rate = 10;
  motion.columns = qposColumns(m.get());
  motion.qpos = {1, 2, 3, 0.6, 0, 0, 0.8, 0.1, -0.2, 0.3};
  const auto spine = spineMotion(m.get(), motion);
  ASSERT_TRUE(spine);
  EXPECT_NEAR(spine->lumbar[0].y(), 0.1, 1e-9);
  EXPECT_NEAR(spine->thoracic[0].y(), -0.2, 1e-9);
  EXPECT_NEAR(spine->neck[0].y(), 0.3, 1e-9);
  EXPECT_THAT(spineCsv(*spine), HasSubstr("\n0.000000,5.730,-11.459,17.189\n"));
}

TEST_F(Optimize, WrongCheckpointsAreRefused) {
  const std::string arguments = "optimize far.json --model cart.xml --samples 4 ";
  ASSERT_EQ(run(arguments + "--iterations 3 -o c").status, 0);
  const auto fails = [&](const std::string& line) {
    const Result result = run(line + " -o c");
    EXPECT_EQ(result.status, 1) << line;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    return result.err;
  };
  EXPECT_THAT(fails(arguments), HasSubstr("add --resume"));
  EXPECT_THAT(fails(arguments + "--resume --seed 4"), HasSubstr("seed is 0 there, but 4 now"));
  EXPECT_THAT(fails(arguments + "--resume --iterations 2"),
              HasSubstr("holds 3 iterations already"));
  write("far.json", cartTask(R"({"weight": -2, "when": "end", "factors": [
                    {"of": "com", "axis": "x"}]})"));
  EXPECT_THAT(fails(arguments + "--resume"), HasSubstr("checkpoint.json: task is \"far "));
  write("far.json", cartTask(kFar) + "\n");
  const std::string good = readFile(folder_ / "c/checkpoint.json");
  for (const std::string& damaged : {good.substr(0, good.size() / 2), std::string("{}"),
                                     std::string(), json{{"format", "torso optimize 1"}}.dump()}) {
    write("c/checkpoint.json", damaged);
    EXPECT_THAT(fails(arguments + "--resume --iterations 4"), HasSubstr("delete the folder"));
  }
  json shorter = json::parse(good);
  shorter["nominal"].erase(0);
  write("c/checkpoint.json", shorter.dump());
  EXPECT_THAT(fails(arguments + "--resume --iterations 4"), HasSubstr("checkpoint.json: damaged"));
}

TEST_F(Optimize, UnknownTasksAreToldThoseThereAre) {
  EXPECT_EQ(refused("dance"),
            "torso optimize: no task 'dance'; there are bow, jump, swing, or give a file, "
            "TASK.json\n");
  EXPECT_THAT(refused("missing.json"), HasSubstr("missing.json: cannot read"));
  EXPECT_THAT(run("optimize --list").out, HasSubstr("swing"));
  for (const std::string arguments : {"swing --horizon 0", "swing --samples 0", "swing --samples 1",
                                      "swing --iterations 0", "", "swing --absolute-temperature"}) {
    EXPECT_EQ(run("optimize " + arguments).status, 2) << arguments;
  }
}

TEST_F(Optimize, MalformedTasksAreToldByLineAndKey) {
  const std::string good = cartTask(kFar);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return refusedTask(text);
  };
  EXPECT_THAT(refusedTask("{\"description\": \"x\",\n  oops}"), HasSubstr("bad.json:2:"));
  EXPECT_THAT(refusedTask("[]"), HasSubstr("not a JSON object"));
  EXPECT_THAT(with("\"weight\": -1", "\"weight\": \"heavy\""),
              HasSubstr("bad.json:2:15: cost/0/weight: not a number"));
  EXPECT_THAT(with("\"weight\"", "\"wait\""), HasSubstr("bad.json:2:15: cost/0/wait: no such key"));
  EXPECT_THAT(with("\"weight\": -1, ", ""), HasSubstr("the key 'weight' is missing"));
  EXPECT_THAT(with("\"end\"", "\"later\""), HasSubstr("cost/0/when: neither"));
  EXPECT_THAT(with("\"com\"", "\"heart\""), HasSubstr("cost/0/factors/0/of: not com"));
  EXPECT_THAT(with("\"axis\": \"x\"", "\"axis\": \"w\""), HasSubstr("cost/0/factors/0/axis:"));
  EXPECT_THAT(with("\"horizon_s\": 1", "\"horizon_s\": 0"), HasSubstr("horizon_s: 0 is not in"));
  EXPECT_THAT(with("\"horizon_s\": 1", "\"horizon_s\": 1, \"samples\": 0"), HasSubstr("samples:"));
  EXPECT_THAT(with("\"horizon_s\": 1", "\"horizon_s\": 1, \"horizon_s\": 2"), HasSubstr("twice"));
  EXPECT_THAT(with("\"horizon_s\": 1", "\"horizon_s\": 1, \"scene\": \"no.xml\""),
              HasSubstr("no.xml: no such file"));
  EXPECT_THAT(with("\"pu*\"", "\"pull\""),
              HasSubstr("actions/0/actuators: cart.xml has no actuator 'pull'; it has push"));
  EXPECT_THAT(with("\"of\": \"com\"", "\"of\": \"position\", \"body\": \"horse\""),
              HasSubstr("body: cart.xml has no body 'horse'; it has world, cart"));
  EXPECT_THAT(with("\"of\": \"com\", \"axis\": \"x\"", "\"of\": \"sensor\", \"sensor\": \"smell\""),
              HasSubstr("has no sensor 'smell'; it has way, speed"));
  EXPECT_THAT(with("\"actions\"", "\"start\": {\"turns_deg\": {\"neck\": [1, 2, 3]}}, \"actions\""),
              HasSubstr("no ball joint 'neck'"));
}

// Every task that comes with torso, on the body without vertebrae.
TEST_F(Optimize, ShippedTasksImproveOnTheFixedTorso) {
  for (const std::string task : {"swing", "jump", "bow"}) {
    const json result = runJson(
        "optimize " + task +
        " --model " TORSO_MJCF "/human_fixed.xml --samples 12 --iterations 5 --json -o " + task);
    EXPECT_LT(result["best_cost"], result["start_cost"]) << task;
    EXPECT_EQ(fs::exists(folder_ / task / "scene.xml"), task == "swing");
  }
  const Result frame =
      run("render swing/scene.xml --motion swing/best.motion --time 0.5 -o swing.png");
  EXPECT_EQ(frame.status, 0) << frame.err;
}

TEST_F(Optimize, SwingImprovesOnTheDetailedTorso) {
  const json result =
      runJson("optimize swing --horizon 0.4 --samples 8 --iterations 3 --json -o swing");
  EXPECT_LT(result["best_cost"].get<double>(), result["start_cost"].get<double>() - 0.01);
  EXPECT_EQ(result["rows"][0]["failed"], 0);
}

}  // namespace
}  // namespace torso::tools
