// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// torso ablate as a user runs it.

#include <algorithm>
#include <string>

#include "model/anatomy.h"
#include "tests/tools/command_fixture.h"

namespace torso::tools {
namespace {

// Under a third of the hanging trunk's weight ligaments hold L5 in the published range, and without
// them it leaves that by far. Published: living men flex L1 - S1 by 51 deg (Pearcy 1985, Acta
// Orthop Scand Suppl 212). The tables hold what is printed.
TEST_F(Command, AblateShowsWhatLigamentsHold) {
  const Result result = run("ablate --only ligaments --json --plot plots");
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_FALSE(json.contains("gaps"));
  const RangeOfMotion range = Anatomy::load(TORSO_ANATOMY_DIR).range_of_motion.at("L5/S1");
  const double flexion = range[kFlexion].high * 180 / EIGEN_PI;
  const double extension = range[kExtension].high * 180 / EIGEN_PI;
  const auto level = [&](const char* spine, const char* bend, const char* disc) -> double {
    return json[spine][bend]["levels_deg"][disc];
  };
  EXPECT_LT(level("whole", "hanging_forward", "L5/S1"), flexion);
  EXPECT_GT(level("whole", "hanging_backward", "L5/S1"), -1.1 * extension);
  EXPECT_GT(level("without_ligaments", "hanging_forward", "L5/S1"), 2 * flexion);
  EXPECT_LT(level("without_ligaments", "hanging_backward", "L5/S1"), -2 * extension);
  const double whole = json["whole"]["hanging_forward"]["flexion_deg"];
  EXPECT_NEAR(whole - level("whole", "hanging_forward", "T12/L1"), 51, 10);
  EXPECT_NEAR(json["without_ligaments"]["forward_bend"]["flexion_deg"], 65, 1e-6);

  const std::string table = readFile(folder_ / "plots/hanging.csv");
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 1 + 2 * 21);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "plots/ablation.gp"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "plots/gaps.csv"));

  const Result wrong = run("ablate --only bones");
  EXPECT_NE(wrong.status, 0);
  EXPECT_NE(wrong.err.find("--only"), std::string::npos) << wrong.err;
}

}  // namespace
}  // namespace torso::tools
