// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// The sections of `torso validate`. To add one: a line here, and a function in validation_rows.cc
// that turns the JSON of its command into rows, or plainRows.
#include <filesystem>

#include "tools/paths.h"
#include "tools/validation.h"
#include "tools/validation_rows.h"

namespace torso::tools {

std::vector<Section> validationSections(const ValidationInput& input) {
  const std::string human = mjcfFolder() + "/human.xml";
  using Words = std::vector<std::string>;
  const auto run = [&](const Words& more) {
    Words words = {"torso", "run", human, "--drop", "2", "--control", "random"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  // id, title, about, command, command of the short form, seconds, rows
  std::vector<Section> all = {
      {"info",
       "The model",
       "What the whole body consists of, beside the paper's counts.",
       {"torso", "info", human},
       {"torso", "info", human},
       1,
       infoRows},
      {"bones",
       "Bones",
       "Measures of the generated bones beside published ones, and whether bones, discs and joints "
       "fit each other. Inside: within one standard deviation, or 5 % where none is known.",
       {"torso", "bones", "--plot", "bones"},
       {"torso", "bones", "--only", "L4"},
       14,
       boneRows},
      {"discs",
       "Discs on the bench",
       "Each disc between its two bones, without ligaments and facets, under the loads of "
       "published "
       "in-vitro tests.",
       {"torso", "discs", "--plot", "discs"},
       {"torso", "discs", "--level", "L4/L5"},
       36,
       discRows},
      {"rom",
       "Range of motion, segment by segment",
       "Each segment cut out of the body, under pure moments, as laboratories do.",
       {"torso", "rom", "--plot", "rom"},
       {"torso", "rom", "--level", "L4/L5"},
       20,
       romRows},
      {"rom_whole",
       "Range of motion, whole spine",
       "The spine with rib cage and head, pelvis clamped, turned to the extremes of voluntary "
       "motions. Inside: within 10 %.",
       {"torso", "rom", "--whole", "--plot", "rom_whole"},
       {},
       60,
       wholeSpineRows},
      {"rom_preload",
       "Lumbar spine under a follower load",
       "Stiffness and range of motion of lumbar levels under compression, to those without.",
       {"torso", "rom", "--preload"},
       {},
       4,
       preloadRows},
      {"identify",
       "Ligaments",
       "The paper's test of the ligaments' lengths: random actions must reach each extreme pose, "
       "and must not if any one ligament were a step shorter.",
       {"torso", "identify", "--check"},
       {"torso", "identify", "--check", "--level", "L4/L5", "--actions", "4"},
       80,
       identifyRows},
      {"ablate",
       "Without ligaments, without discs",
       "What ligaments and discs do to the motion of the whole spine.",
       {"torso", "ablate", "--plot", "ablate"},
       {},
       210,
       ablateRows},
      {"shoulder",
       "Shoulder",
       "Scapulohumeral rhythm: the arm raised in the coronal plane, servos and gravity off.",
       {"torso", "shoulder", "--plot", "shoulder"},
       {"torso", "shoulder", "--seconds", "2"},
       7,
       shoulderRows},
      {"pressure",
       "Pressure in L4/L5",
       "The body, with the mass and the disc of the one man in whom the pressure in the nucleus "
       "was "
       "measured, in his postures, held by servos and by muscles. Inside: within 15 % in standing "
       "and holding, 30 % elsewhere.",
       {"torso", "pressure", "--plot", "pressure"},
       {"torso", "pressure", "--activity", "standing"},
       15,
       pressureRows},
      {"pressure_tables",
       "Pressure in L4/L5 of the models",
       "The same on the models' own body, whose disc is smaller; \"muscles\" and \"servos only\": "
       "if "
       "the same force were on a disc of the man's area.",
       {"torso", "pressure", "--body", "tables"},
       {},
       12,
       pressureRows},
      {"pressure_no_abdomen",
       "Without pressure in the abdomen",
       "What that pressure takes off the disc: 0.079 kPa/Nm of moment at L4/L5 less 1.1 kPa "
       "(Mairiaux 1984), over 243 cm2 of diaphragm, 38 mm before the disc (McGill and Norman "
       "1987).",
       {"torso", "pressure", "--without", "abdomen"},
       {},
       12,
       pressureRows},
      {"pressure_no_coactivation",
       "Without coactivation",
       "What muscles that work against each other put on the disc: 1.7 % of their strength "
       "upright, "
       "2.9 % with 32 kg (Cholewicki 1997).",
       {"torso", "pressure", "--without", "coactivation"},
       {},
       12,
       pressureRows},
      {"muscles",
       "Moment arms of muscles",
       "Standing, one side, weighted by cross-section.",
       {"torso", "pressure", "--arms"},
       {},
       2,
       armRows},
      {"run", "Falls of 2 m, random controls",
       "At 600 Hz: no number may go wrong and no table overflow.",
       run({"--seeds", "40", "--seconds", "5", "--threads", "2"}),
       run({"--seeds", "1", "--seconds", "1"}), 53, runRows},
      {"run_200hz",
       "Falls of 2 m, random controls, 200 Hz",
       "The same with three times the step.",
       run({"--seeds", "40", "--seconds", "5", "--threads", "2", "--timestep", "0.005"}),
       {},
       22,
       runRows},
      {"info_simple",
       "The model with three ball joints in the spine's place",
       "What users compare the torso with: the same bones and masses.",
       {"torso", "info", mjcfFolder() + "/human_simple.xml"},
       {},
       1,
       kindRows},
      {"info_fixed",
       "The model with a rigid torso",
       "",
       {"torso", "info", mjcfFolder() + "/human_fixed.xml"},
       {},
       1,
       kindRows},
      {"fall",
       "A fall, detailed, simple and fixed torso",
       "The standing body lands on its feet from 2 m with small random controls: mean (lowest - "
       "highest) of the seeds. Rows of the picture: detailed torso; simple one of three ball "
       "joints; fixed one. Columns: 0.1 s before the first touch, and 0.03, 0.08, 0.15, 0.3, 0.5, "
       "0.8 and 1.3 s after it.",
       {"torso", "fall", "--plot", "fall", "--pictures", "fall/strip.png"},
       {"torso", "fall", "--seeds", "1", "--seconds", "0.75", "--rate", "600"},
       35,
       fallRows},
      {"fall_4800hz",
       "The landing at twice the rate",
       "The same at 4800 Hz instead of 2400 Hz, up to the landing.",
       {"torso", "fall", "--rate", "4800", "--seconds", "1"},
       {},
       25,
       fallRows},
      {"timestep",
       "Time step",
       "What is measured at 600 and 200 Hz against 1800 Hz.",
       {"torso", "timestep", "--threads", "2"},
       {},
       40,
       timestepRows},
      {"bench",
       "Speed",
       "Processor time of a step on this machine. Other programs that run meanwhile make it "
       "longer.",
       {"torso", "bench"},
       {"torso", "bench", "--seconds", "0.05", "--repetitions", "1"},
       50,
       benchRows},
      {"truth",
       "Motion capture, known motions",
       "Motions of the body itself, of which every bone is known, put through the retrofit.",
       {"torso", "truth", human},
       {},
       24,
       truthRows}};
  const auto absolute = [](const std::string& path) {
    return std::filesystem::absolute(path).lexically_normal().string();
  };
  const auto name = [&](const std::string& path) {
    return std::filesystem::path(absolute(path)).stem().string();
  };
  int count = 0;
  for (const std::string& humanoid : input.humanoids) {
    const std::string id = "graft" + std::to_string(++count);
    const std::string grafted = id + "/humanoid.xml";
    all.push_back({id,
                   "Graft: " + name(humanoid),
                   "The torso in the place of a humanoid's own, without a map.",
                   {"torso", "graft", absolute(humanoid), "-o", grafted},
                   {},
                   2,
                   graftRows});
    all.push_back(
        {id + "_drop",
         "Graft, dropped: " + name(humanoid),
         "From 1 m with random controls.",
         {"torso", "run", grafted, "--drop", "1", "--control", "random", "--seconds", "5"},
         {},
         5,
         runRows});
  }
  if (!input.clips.empty()) {
    const Words print = {"cat", absolute(input.clips) + "/summary.csv"};
    all.push_back({"retrofit", "Motion capture, retrofitted clips",
                   "What torso retrofit has written there: how well spine and shoulders reach the "
                   "clip's pelvis, head and upper arms.",
                   print, print, 0, retrofitRows});
    all.push_back({"stats",
                   "Motion capture, statistics of clips",
                   "Retrofitted clips: how far levels move and how near vertebrae come.",
                   {"torso", "stats", absolute(input.clips), "--every", "15", "--plot", "stats"},
                   {"torso", "stats", absolute(input.clips), "--only-whole"},
                   600,
                   plainRows});
  }
  count = 0;
  for (const std::string& folder : input.optimized) {
    const Words print = {"cat", absolute(folder) + "/result.json"};
    all.push_back(
        {"optimize" + std::to_string(++count),
         "Optimal control: " + std::filesystem::path(absolute(folder)).filename().string(),
         "What torso optimize has written there.", print, print, 0, optimizeRows});
  }
  if (!input.build.empty()) {
    const std::string tests =
        "Posture|CarryTheWeight|Conservation|DiscBatch.*Motion|StiffnessConverges|CalculiX|"
        "[Pp]erson|Viscosity|TorsoKinds|TwoRigs";
    all.push_back({"tests",
                   "Tests that print figures",
                   "What the project's tests say of posture, conservation, convergence and "
                   "CalculiX.",
                   {"ctest", "--test-dir", absolute(input.build), "-V", "-R", tests},
                   {},
                   300,
                   testRows});
    all.push_back({"rollouts",
                   "Rollouts",
                   "torso_rollout: a trajectory of 0.1 s in threads, and its overhead over a plain "
                   "loop of mj_step.",
                   {absolute(input.build) + "/tests/benchmark/rollout_benchmark"},
                   {},
                   25,
                   benchmarkRows});
  }
  return all;
}

}  // namespace torso::tools
